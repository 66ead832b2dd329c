//! Times without a sweep.

use occlabel_core::{Fault, SweepHeader};

use super::neighbours::{fault_between, neighbours, step_s};

/// Sweeps follow each other within this time, seconds (docs/reliability.md 18): over a longer one nobody
/// knows where things went.
pub(super) const LONGEST_STEP_S: f64 = 1.5;

/// Gaps between consecutive sweeps of a lidar.
pub(super) fn sweep_gaps(sweeps: &[SweepHeader]) -> Vec<Fault> {
    let pairs = neighbours(sweeps).into_iter();
    pairs.filter(|pair| step_s(*pair) >= LONGEST_STEP_S).map(fault).collect()
}

fn fault(pair: [&SweepHeader; 2]) -> Fault {
    let expected = format!("the lidar's next sweep within {LONGEST_STEP_S} s");
    fault_between(pair, "sweep-gap", expected, format!("a gap of {:.3} s", step_s(pair)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::test_drive::straight;

    #[test]
    fn fault_18_gaps_are_told_with_both_sweeps() {
        let mut sweeps = straight(10, 10.0);
        assert!(sweep_gaps(&sweeps).is_empty());
        sweeps.drain(3..7);
        assert!(sweep_gaps(&sweeps).is_empty(), "0.5 s is no gap");
        sweeps[3..].iter_mut().for_each(|sweep| sweep.time.0 += 1_000_000_000);
        let gaps = sweep_gaps(&sweeps);
        assert_eq!((gaps.len(), gaps[0].rule), (1, "sweep-gap"));
        assert_eq!(gaps[0].record.as_deref(), Some("sweeps s2 and s7"));
        assert_eq!(gaps[0].found, "a gap of 1.500 s");
    }
}
