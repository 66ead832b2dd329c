//! Rotations that no vehicle has: as they come of quaternions in another order, or of mixed-up rows.

use nalgebra::Vector3;
use occlabel_core::{Fault, SweepHeader};

use super::gaps::LONGEST_STEP_S;
use super::neighbours::{fault_between, neighbours, step_s};

/// From one sweep to the next a vehicle turns by less, degrees (docs/reliability.md 13).
const LARGEST_STEP_DEG: f64 = 30.0;
/// No road is so steep, degrees: the steepest have 19.
const LARGEST_TILT_DEG: f64 = 30.0;

/// What could be done about rotations that cannot be.
pub(super) const ORDER_HINT: &str =
    "if quaternions stand in another order, `--quat-order` tells it (xyzw or wxyz)";

/// Turns between consecutive sweeps of a lidar that are too large; over gaps a vehicle may turn.
pub(super) fn rotation_steps(sweeps: &[SweepHeader]) -> Vec<Fault> {
    let pairs = neighbours(sweeps).into_iter().filter(|pair| step_s(*pair) < LONGEST_STEP_S);
    let steps = pairs.map(|pair| (pair, turned_deg(pair)));
    steps.filter(|(_, step)| *step >= LARGEST_STEP_DEG).map(step_fault).collect()
}

fn turned_deg([before, after]: [&SweepHeader; 2]) -> f64 {
    let [from, to] = [before, after].map(|sweep| sweep.world_from_ego.rotation.coords);
    2.0 * libm::acos(from.dot(&to).abs().min(1.0)).to_degrees()
}

fn step_fault((pair, step): ([&SweepHeader; 2], f64)) -> Fault {
    let expected = format!("a turn of less than {LARGEST_STEP_DEG} degrees from sweep to sweep");
    let found = format!("{step:.1} degrees in {:.3} s", step_s(pair));
    fault_between(pair, "rotation-step", expected, found).hint(ORDER_HINT)
}

/// Whether the vehicle stands steeper than any road at some sweep; told once, at the first.
pub(super) fn tilted(sweeps: &[SweepHeader]) -> Option<Fault> {
    let tilts = sweeps.iter().map(|sweep| (sweep, tilt_deg(sweep)));
    let tilted: Vec<_> = tilts.filter(|(_, tilt)| *tilt > LARGEST_TILT_DEG).collect();
    let (first, tilt) = tilted.first()?;
    let expected = format!("the vehicle's up within {LARGEST_TILT_DEG} degrees of the world's");
    let found = format!("{tilt:.1} degrees, and so at {} of {} sweeps", tilted.len(), sweeps.len());
    let fault = Fault::new("ego-tilt", &first.file, expected, found);
    Some(fault.record(&first.source_id).hint(ORDER_HINT))
}

fn tilt_deg(sweep: &SweepHeader) -> f64 {
    let up = sweep.world_from_ego.rotation * Vector3::z();
    libm::acos(up.z.clamp(-1.0, 1.0)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::test_drive::{pose, straight};

    #[test]
    fn fault_13_turns_of_30_degrees_and_more_are_told() {
        let mut sweeps = straight(4, 10.0);
        let yaw = |degrees: f64| pose([0.0; 3], [0.0, 0.0, degrees.to_radians()]).rotation;
        sweeps[2].world_from_ego.rotation = yaw(29.0);
        assert!(rotation_steps(&sweeps).is_empty());
        sweeps[2].world_from_ego.rotation = yaw(31.0);
        let steps = rotation_steps(&sweeps);
        assert_eq!((steps.len(), steps[0].rule), (2, "rotation-step"));
        assert_eq!(steps[0].found, "31.0 degrees in 0.100 s");
        sweeps[3].time.0 += 2_000_000_000;
        assert_eq!(rotation_steps(&sweeps).len(), 1, "over a gap a vehicle may turn");
    }

    #[test]
    fn fault_13_a_quaternion_and_its_negative_are_one_rotation() {
        let mut sweeps = straight(2, 10.0);
        let rotation = &mut sweeps[1].world_from_ego.rotation;
        *rotation = nalgebra::UnitQuaternion::new_unchecked(-rotation.into_inner());
        assert!(rotation_steps(&sweeps).is_empty());
    }

    #[test]
    fn fault_13_numbers_in_another_order_tilt_the_vehicle() {
        let mut sweeps = straight(5, 10.0);
        assert!(tilted(&sweeps).is_none());
        for sweep in &mut sweeps {
            let yaw = pose([0.0; 3], [0.0, 0.0, 1.0]).rotation.into_inner();
            let mixed = nalgebra::Quaternion::new(yaw.i, yaw.j, yaw.k, yaw.w);
            sweep.world_from_ego.rotation = nalgebra::UnitQuaternion::new_normalize(mixed);
        }
        let fault = tilted(&sweeps).expect("a tilt");
        assert_eq!(fault.found, "57.3 degrees, and so at 5 of 5 sweeps", "as much as the yaw");
        assert!(fault.hint.is_some_and(|hint| hint.contains("--quat-order")));
    }
}
