//! Worlds whose poses know no heights, on roads that have some.

use nalgebra::Vector3;
use occlabel_core::{Fault, SweepHeader};

use super::neighbours::{moved_m, neighbours};

/// Heights up to this are 0, metres.
const ZERO_M: f64 = 1e-9;
/// Climbs up to this are the springs' and the road's, metres.
const SMALL_CLIMB_M: f64 = 0.5;
/// So are climbs up to this share of the way: a vehicle stands up to a degree off its road.
const SMALL_CLIMB_SHARE: f64 = 0.02;
/// A ground up to this thick is flat, metres: half a voxel.
const THIN_M: f64 = 0.2;

/// Whether the poses' heights are identically 0 although the road is not flat: by the vehicle's own
/// pitch, and by how thick the ground comes out of the sweeps, if that is known, metres.
pub(super) fn level_world(sweeps: &[SweepHeader], thickness_m: Option<f64>) -> Option<Fault> {
    let pairs = neighbours(sweeps);
    let is_level = |sweep: &SweepHeader| sweep.world_from_ego.translation.z.abs() <= ZERO_M;
    let way_m: f64 = pairs.iter().map(|pair| moved_m(*pair)).sum();
    let climb_m = climb_m(&pairs);
    let is_climb = climb_m > SMALL_CLIMB_M.max(SMALL_CLIMB_SHARE * way_m);
    let is_thick = thickness_m.is_some_and(|thickness| thickness > THIN_M);
    if !(sweeps.iter().all(is_level) && (is_climb || is_thick)) {
        return None;
    }
    let first = sweeps.first()?;
    let thick = thickness_m.map(|thickness| format!(", and a ground {thickness:.2} m thick"));
    let count = sweeps.len();
    let found = format!(
        "0 at all {count} sweeps, with a climb of {climb_m:.2} m over {way_m:.0} m by the vehicle's \
         pitch{}",
        thick.unwrap_or_default()
    );
    let fault = Fault::new("level-world", &first.file, "heights in the ego poses", found);
    Some(fault.hint(
        "sweeps from different places on a slope do not fit; a shorter `aggregate.window_s` helps",
    ))
}

/// From the lowest to the highest place, if the vehicle drove where it pointed, metres.
fn climb_m(pairs: &[[&SweepHeader; 2]]) -> f64 {
    let (mut height, mut lowest, mut highest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for pair in pairs {
        let [before, after] = pair.map(|sweep| sweep.world_from_ego);
        let ahead = before.rotation * Vector3::x();
        let way = after.translation.vector - before.translation.vector;
        // Backwards it goes down where the nose points up.
        height += moved_m(*pair) * ahead.z * way.dot(&ahead).signum();
        (lowest, highest) = (lowest.min(height), highest.max(height));
    }
    highest - lowest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::test_drive::{pose, straight};

    /// A drive of 99 m whose poses have height `z_m` and a pitch up the slope, degrees.
    fn drive(z_m: f64, up_deg: f64) -> Vec<SweepHeader> {
        let mut sweeps = straight(100, 10.0);
        for sweep in &mut sweeps {
            let x_m = sweep.world_from_ego.translation.x;
            sweep.world_from_ego = pose([x_m, 0.0, z_m], [0.0, -up_deg.to_radians(), 0.0]);
        }
        sweeps
    }

    #[test]
    fn fault_20_zero_heights_on_a_slope_are_told_by_the_pitch() {
        let fault = level_world(&drive(0.0, 3.0), None).expect("a slope");
        assert_eq!(fault.rule, "level-world");
        assert!(fault.found.contains("0 at all 100 sweeps, with a climb of 5.18 m over 99 m"));
        assert!(level_world(&drive(0.0, -3.0), None).is_some(), "down is a slope too");
        assert!(level_world(&drive(7.0, 3.0), None).is_none(), "heights that are not 0");
    }

    #[test]
    fn fault_20_a_flat_road_at_height_zero_is_fine() {
        assert!(level_world(&drive(0.0, 0.0), None).is_none());
        assert!(level_world(&drive(0.0, 0.9), None).is_none(), "the vehicle's own stand");
        assert!(level_world(&drive(0.0, 0.0), Some(0.03)).is_none());
        assert!(level_world(&[], Some(9.0)).is_none());
    }

    #[test]
    fn fault_20_zero_heights_are_told_by_a_thick_ground_and_its_thickness() {
        let fault = level_world(&drive(0.0, 0.0), Some(0.87)).expect("a thick ground");
        assert!(fault.found.ends_with("and a ground 0.87 m thick"), "{fault}");
        assert!(level_world(&drive(2.0, 0.0), Some(0.87)).is_none());
    }
}
