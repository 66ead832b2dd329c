//! Poses that no vehicle can have driven between.

use occlabel_core::{Fault, SweepHeader};

use super::neighbours::{fault_between, moved_m, neighbours, step_s};

/// No road vehicle is faster, metres per second (docs/reliability.md 19).
const FASTEST_MPS: f64 = 60.0;
/// A shorter way is no jump but rounding between two times that are nearly the same, metres.
const SHORTEST_JUMP_M: f64 = 0.5;

/// Jumps between consecutive sweeps of a lidar, as relocalisation makes them.
pub(super) fn pose_jumps(sweeps: &[SweepHeader]) -> Vec<Fault> {
    let is_jump = |pair: &[&SweepHeader; 2]| {
        let way_m = moved_m(*pair);
        way_m > FASTEST_MPS * step_s(*pair) && way_m > SHORTEST_JUMP_M
    };
    neighbours(sweeps).into_iter().filter(is_jump).map(fault).collect()
}

fn fault(pair: [&SweepHeader; 2]) -> Fault {
    let (way_m, step_s) = (moved_m(pair), step_s(pair));
    let speed = if step_s > 0.0 { way_m / step_s } else { f64::INFINITY };
    let expected = format!("a speed of at most {FASTEST_MPS} m/s");
    let found = format!("{way_m:.3} m in {step_s:.3} s, {speed:.1} m/s");
    fault_between(pair, "pose-jump", expected, found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::test_drive::straight;

    #[test]
    fn fault_19_jumps_are_told_with_both_sweeps_and_their_speed() {
        assert!(pose_jumps(&straight(10, 59.0)).is_empty());
        assert_eq!(pose_jumps(&straight(10, 61.0)).len(), 9);
        let mut sweeps = straight(10, 10.0);
        sweeps[6..].iter_mut().for_each(|sweep| sweep.world_from_ego.translation.y += 8.0);
        let jumps = pose_jumps(&sweeps);
        assert_eq!((jumps.len(), jumps[0].rule), (1, "pose-jump"));
        assert_eq!(jumps[0].record.as_deref(), Some("sweeps s5 and s6"));
        assert_eq!(jumps[0].found, "8.062 m in 0.100 s, 80.6 m/s");
    }

    #[test]
    fn fault_19_two_sweeps_of_one_time_may_differ_by_rounding_only() {
        let mut sweeps = straight(2, 10.0);
        sweeps[1].time = sweeps[0].time;
        assert_eq!(pose_jumps(&sweeps)[0].found, "1.000 m in 0.000 s, inf m/s");
        sweeps[1].world_from_ego.translation.x = 0.4;
        assert!(pose_jumps(&sweeps).is_empty());
    }
}
