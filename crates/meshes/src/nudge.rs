//! One step of least squares over rigid motions.

use nalgebra::{Matrix6, Point3, Translation3, UnitQuaternion, Vector3, Vector6};
use occlabel_core::Pose;

/// What is known of a small motion: sums over all that was measured (Gauss & Newton).
///
/// A motion is its turn about the origin and its shift, `[turn, shift]`: `p + turn x p + shift`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Nudge {
    information: Matrix6<f64>,
    pull: Vector6<f64>,
}

impl Nudge {
    /// A place that has to move by so much along a unit vector, with a weight.
    pub(crate) fn add(&mut self, at: &Point3<f64>, along: &Vector3<f64>, by_m: f64, weight: f64) {
        let turned = at.coords.cross(along);
        let row = Vector6::new(turned.x, turned.y, turned.z, along.x, along.y, along.z);
        self.information += row * row.transpose() * weight;
        self.pull += row * (by_m * weight);
    }

    /// What has been moved already wants back: to where it came from, by deviations of a turn in radians
    /// and a shift in metres.
    pub(crate) fn hold_back(&mut self, moved: &Pose, deviation: [f64; 2]) {
        let [turn, shift] = deviation.map(|deviation| 1.0 / (deviation * deviation));
        let back = [moved.rotation.scaled_axis() * -turn, moved.translation.vector * -shift];
        for axis in 0..3 {
            self.information[(axis, axis)] += turn;
            self.information[(axis + 3, axis + 3)] += shift;
            self.pull[axis] += back[0][axis];
            self.pull[axis + 3] += back[1][axis];
        }
    }

    /// The likeliest motion; none if nothing was measured.
    pub(crate) fn solve(&self) -> Option<Pose> {
        let solved = self.information.cholesky()?.solve(&self.pull);
        let turn = Vector3::new(solved[0], solved[1], solved[2]);
        let shift = Vector3::new(solved[3], solved[4], solved[5]);
        Some(Pose::from_parts(Translation3::from(shift), UnitQuaternion::from_scaled_axis(turn)))
    }
}
