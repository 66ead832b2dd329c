//! Sweeps that follow each other.

use std::collections::BTreeMap;

use occlabel_core::{Fault, SweepHeader};

/// Consecutive sweeps of one lidar, in order of time. Of several lidars' pairs at the same two times
/// there is one.
pub(super) fn neighbours(sweeps: &[SweepHeader]) -> Vec<[&SweepHeader; 2]> {
    let (mut last, mut pairs) = (BTreeMap::new(), BTreeMap::new());
    for sweep in sweeps {
        if let Some(before) = last.insert(sweep.lidar.as_str(), sweep) {
            let before: &SweepHeader = before;
            pairs.entry((before.time, sweep.time)).or_insert([before, sweep]);
        }
    }
    pairs.into_values().collect()
}

/// Seconds from the first to the second.
pub(super) fn step_s([before, after]: [&SweepHeader; 2]) -> f64 {
    after.time.seconds_since(before.time)
}

/// Metres from the first to the second.
pub(super) fn moved_m([before, after]: [&SweepHeader; 2]) -> f64 {
    let [from, to] = [before, after].map(|sweep| sweep.world_from_ego.translation.vector);
    (to - from).norm()
}

/// A fault of two sweeps, told at the second.
pub(super) fn fault_between(
    [before, after]: [&SweepHeader; 2],
    rule: &'static str,
    expected: String,
    found: String,
) -> Fault {
    let record = format!("sweeps {} and {}", before.source_id, after.source_id);
    Fault::new(rule, &after.file, expected, found).record(record)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::test_drive::straight;

    #[test]
    fn each_lidar_has_its_own_neighbours_and_shared_moments_count_once() {
        let mut sweeps = straight(3, 10.0);
        let beside =
            sweeps.iter().map(|sweep| SweepHeader { lidar: "SIDE".into(), ..sweep.clone() });
        sweeps.extend(beside.collect::<Vec<_>>());
        sweeps.sort_by_key(|sweep| sweep.time);
        let pairs = neighbours(&sweeps);
        assert_eq!(pairs.len(), 2);
        assert!(pairs.iter().all(|pair| (step_s(*pair), moved_m(*pair)) == (0.1, 1.0)));
    }
}
