//! Vehicles that drive where they do not point: as they come of poses in other axes, or of quaternions
//! in another order on a straight road.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use occlabel_core::{Fault, SweepHeader};

/// A way so long says where the vehicle goes, metres: a shorter one is the poses' noise.
const WAY_M: f64 = 1.0;
/// Slower it may turn on the spot, metres per second.
const SLOWEST_MPS: f64 = 1.0;
/// Fewer ways tell nothing.
const MIN_WAYS: usize = 3;
/// Half of the ways lead within this of the vehicle's own x axis, degrees. A whole drive in reverse
/// is odd enough to be told.
const LARGEST_ANGLE_DEG: f64 = 30.0;

const AXES_HINT: &str = "the ego frame has x ahead, y left, z up: look at the axes of the poses \
                         (of the left camera in poses.txt of SemanticKITTI), or at the order of \
                         quaternions (`--quat-order`, nuScenes)";

/// Whether the vehicle drives where its x axis points, as a rule; told once, at the first sweep.
pub(super) fn heading(sweeps: &[SweepHeader]) -> Option<Fault> {
    let mut angles_deg: Vec<f64> = ways(sweeps).into_iter().map(angle_deg).collect();
    angles_deg.sort_by(f64::total_cmp);
    // The lower of two middles: one wrong pose spoils two ways.
    let median_deg = *angles_deg.get(angles_deg.len().checked_sub(1)? / 2)?;
    if angles_deg.len() < MIN_WAYS || median_deg <= LARGEST_ANGLE_DEG {
        return None;
    }
    let expected =
        format!("a vehicle that drives within {LARGEST_ANGLE_DEG} degrees of its x axis");
    let found = format!("{median_deg:.1} degrees (median of {} ways)", angles_deg.len());
    Some(Fault::new("heading", &sweeps.first()?.file, expected, found).hint(AXES_HINT))
}

/// Pairs of sweeps of a lidar, each pair a way apart and driven fast enough. Of several lidars' pairs
/// at the same two times there is one.
fn ways(sweeps: &[SweepHeader]) -> Vec<[&SweepHeader; 2]> {
    let (mut anchors, mut pairs) = (BTreeMap::new(), BTreeMap::new());
    for sweep in sweeps {
        let anchor: &mut &SweepHeader = anchors.entry(sweep.lidar.as_str()).or_insert(sweep);
        let way_m = way(anchor, sweep).norm();
        if way_m < WAY_M {
            continue;
        }
        if way_m > SLOWEST_MPS * sweep.time.seconds_since(anchor.time) {
            pairs.entry((anchor.time, sweep.time)).or_insert([*anchor, sweep]);
        }
        *anchor = sweep;
    }
    pairs.into_values().collect()
}

fn way(from: &SweepHeader, to: &SweepHeader) -> Vector3<f64> {
    to.world_from_ego.translation.vector - from.world_from_ego.translation.vector
}

/// Between the way and where the vehicle points at its two ends, degrees.
fn angle_deg([from, to]: [&SweepHeader; 2]) -> f64 {
    let ahead = [from, to].map(|sweep| sweep.world_from_ego.rotation * Vector3::x());
    let angle = |ahead: &Vector3<f64>| {
        let cosine = way(from, to).normalize().dot(ahead);
        libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees()
    };
    // A turn is shared out to both ends.
    (angle(&ahead[0]) + angle(&ahead[1])) / 2.0
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::check::test_drive::{pose, straight};

    /// A drive along x of a vehicle that points at `yaw`, radians.
    fn drive(sweeps: usize, speed_mps: f64, yaw: f64) -> Vec<SweepHeader> {
        let mut sweeps = straight(sweeps, speed_mps);
        let rotation = pose([0.0; 3], [0.0, 0.0, yaw]).rotation;
        sweeps.iter_mut().for_each(|sweep| sweep.world_from_ego.rotation = rotation);
        sweeps
    }

    #[test]
    fn fault_13_a_vehicle_that_drives_sideways_or_backwards_is_told() {
        assert_eq!(heading(&drive(20, 5.0, 0.0)), None);
        assert_eq!(heading(&drive(20, 5.0, 0.5)), None, "29 degrees");
        for (yaw, degrees) in [(FRAC_PI_2, "90.0"), (-FRAC_PI_2, "90.0"), (PI, "180.0")] {
            let fault = heading(&drive(20, 5.0, yaw)).expect("another axis");
            assert_eq!(fault.rule, "heading");
            assert_eq!(fault.found, format!("{degrees} degrees (median of 9 ways)"));
        }
    }

    #[test]
    fn fault_13_numbers_in_another_order_turn_a_vehicle_that_drives_straight() {
        let mut sweeps = drive(20, 5.0, 0.01);
        for sweep in &mut sweeps {
            let q = sweep.world_from_ego.rotation.into_inner();
            let mixed = nalgebra::Quaternion::new(q.i, q.j, q.k, q.w);
            sweep.world_from_ego.rotation = nalgebra::UnitQuaternion::new_normalize(mixed);
        }
        let fault = heading(&sweeps).expect("a half turn about z");
        assert!(fault.found.starts_with("180.0 degrees"), "{fault}");
        assert!(fault.hint.is_some_and(|hint| hint.contains("--quat-order")));
    }

    #[test]
    fn short_drives_slow_ones_and_those_on_the_spot_say_nothing() {
        assert_eq!(heading(&drive(6, 5.0, PI)), None, "two ways");
        assert_eq!(heading(&drive(100, 0.9, PI)), None);
        assert_eq!(heading(&drive(100, 0.0, PI)), None);
        assert_eq!(heading(&[]), None);
    }

    #[test]
    fn a_turn_of_90_degrees_within_a_few_metres_is_fine() {
        let mut sweeps = straight(40, 5.0);
        for (place, sweep) in sweeps.iter_mut().enumerate() {
            let yaw = place as f64 / 39.0 * FRAC_PI_2;
            let (x, y) = (6.0 * libm::sin(yaw), 6.0 * (1.0 - libm::cos(yaw)));
            sweep.world_from_ego = pose([x, y, 0.0], [0.0, 0.0, yaw]);
        }
        assert!(heading(&sweeps).is_none());
        sweeps.iter_mut().for_each(|sweep| sweep.time.0 /= 2);
        assert!(ways(&sweeps).len() > 5);
    }
}
