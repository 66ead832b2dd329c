//! The lidar turns while the vehicle moves: points of a scan were seen from many places.
//!
//! ```text
//!            x ahead: seen at the scan's pose
//!   y left  ----+----
//!           -y  |  +y      at the azimuth a the share s = a / 2 pi of a turn away from it,
//!              behind      by which the motion of a turn moves points back to the pose
//! ```
//!
//! Source: the data set's own tools. Azimuths are taken in steps; points of a step share an origin.

use std::f64::consts::TAU;

use nalgebra::Point3;
use occlabel_core::{LIDAR_ORIGIN, PointCloud, PointLabel, Pose, RigidMap};

use super::poses::part_way;

/// Steps of a turn: at 30 m/s and 10 turns a second, one is 3 mm.
const STEPS: usize = 1024;

/// Moves points to where the lidar stood at the scan's pose; `now_from_before` is the lidar's motion
/// of one turn.
pub(super) fn deskew(
    positions: Vec<Point3<f64>>,
    labels: Vec<PointLabel>,
    now_from_before: &Pose,
) -> PointCloud<PointLabel> {
    let at_step = |step: usize| {
        let share = (step as f64 + 0.5) / STEPS as f64 - 0.5;
        RigidMap::from(&part_way(&Pose::identity(), now_from_before, share))
    };
    let moves: Vec<RigidMap> = (0..STEPS).map(at_step).collect();
    let origins = moves.iter().map(|then| then.apply(&LIDAR_ORIGIN)).collect();
    let mut cloud = PointCloud::with_origins(origins);
    for (position, label) in positions.into_iter().zip(labels) {
        let step = step_of(&position);
        cloud.push(moves[step].apply(&position), label, step as u32);
    }
    cloud
}

fn step_of(position: &Point3<f64>) -> usize {
    let turn = libm::atan2(position.y, position.x) / TAU + 0.5;
    // A point that is not finite falls into the first step, and is dropped later.
    ((turn * STEPS as f64) as usize).min(STEPS - 1)
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};

    use super::*;

    /// The vehicle drives 2 m ahead and turns left by 0.1 rad in a turn of the lidar.
    fn motion() -> Pose {
        let before_from_now = Pose::from_parts(
            Vector3::new(2.0, 0.0, 0.0).into(),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.1),
        );
        before_from_now.inverse()
    }

    fn deskewed(x: f64, y: f64) -> (Point3<f64>, Point3<f64>) {
        let labels = vec![PointLabel::Unlabelled];
        let cloud = deskew(vec![Point3::new(x, y, -1.0)], labels, &motion());
        (cloud.positions[0], cloud.origin(0))
    }

    #[test]
    fn what_is_ahead_stays_and_what_is_behind_moves_by_half_a_turn() {
        let step = 2.0 / STEPS as f64;
        let (ahead, origin) = deskewed(10.0, 0.0);
        assert!(
            (ahead - Point3::new(10.0, 0.0, -1.0)).norm() < step && origin.coords.norm() < step
        );
        // To the left behind: seen half a turn before the pose, when the vehicle was 1 m farther back.
        let (_, left) = deskewed(-10.0, 1e-3);
        let (_, right) = deskewed(-10.0, -1e-3);
        assert!((left.x + 1.0).abs() < 0.02 && (right.x - 1.0).abs() < 0.02, "{left} {right}");
    }

    #[test]
    fn a_quarter_of_the_motion_is_taken_at_a_quarter_of_a_turn() {
        let (moved, _) = deskewed(0.0, 8.0);
        let expected = part_way(&Pose::identity(), &motion(), 0.25) * Point3::new(0.0, 8.0, -1.0);
        assert!((moved - expected).norm() < 0.01, "{moved} {expected}");
    }

    #[test]
    fn points_that_are_not_finite_do_no_harm() {
        for x in [f64::NAN, f64::INFINITY] {
            let (_, origin) = deskewed(x, f64::NAN);
            assert!(origin.coords.norm() < 1.1);
        }
    }
}
