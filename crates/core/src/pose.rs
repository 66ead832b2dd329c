//! Rigid transforms, always bound to a `dst_from_src` name.

use nalgebra::{Isometry3, Matrix3, Point3, Quaternion, UnitQuaternion, Vector3};

/// A rigid transform. `let p_dst = dst_from_src * p_src;`
pub type Pose = Isometry3<f64>;

/// Rotation on the straight great arc from `a` to `b` at share `w` of the way, the short way round.
///
/// Sine and cosine come from `libm`, so that every machine turns the same way (labels.md section 12).
/// Source: Shoemake, "Animating rotation with quaternion curves", 1985.
pub fn slerp(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>, w: f64) -> UnitQuaternion<f64> {
    let dot = a.coords.dot(&b.coords);
    let near = if dot < 0.0 { -b.coords } else { b.coords };
    let angle = libm::acos(dot.abs().min(1.0));
    let sine = libm::sin(angle);
    let (share_a, share_b) = if sine < 1e-9 {
        (1.0 - w, w)
    } else {
        (libm::sin((1.0 - w) * angle) / sine, libm::sin(w * angle) / sine)
    };
    UnitQuaternion::new_normalize(Quaternion::from(a.coords * share_a + near * share_b))
}

/// A pose unrolled to a matrix and an offset, for moving many points.
#[derive(Clone, Copy, Debug)]
pub struct RigidMap {
    rotation: Matrix3<f64>,
    offset: Vector3<f64>,
}

impl From<&Pose> for RigidMap {
    fn from(pose: &Pose) -> Self {
        Self {
            rotation: pose.rotation.to_rotation_matrix().into_inner(),
            offset: pose.translation.vector,
        }
    }
}

impl RigidMap {
    /// Moves a point from the source frame to the destination frame.
    ///
    /// Written out, so that it is rounded the same way wherever it is compiled: column by column,
    /// the offset last.
    #[inline(always)]
    pub fn apply(&self, p: &Point3<f64>) -> Point3<f64> {
        let row = |r: usize| {
            let m = &self.rotation;
            ((m[(r, 0)] * p.x + m[(r, 1)] * p.y) + m[(r, 2)] * p.z) + self.offset[r]
        };
        Point3::new(row(0), row(1), row(2))
    }

    /// Half the sides, along the destination's axes, of a box around a box of such half sides.
    #[inline]
    pub fn spread(&self, half: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.abs() * half
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn yaw(angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
    }

    #[test]
    fn section_3_slerp_ends_are_the_ends_and_the_middle_is_half_way() {
        let (a, b) = (yaw(0.2), yaw(1.4));
        assert!(slerp(&a, &b, 0.0).angle_to(&a) < 1e-12);
        assert!(slerp(&a, &b, 1.0).angle_to(&b) < 1e-12);
        assert!(slerp(&a, &b, 0.5).angle_to(&yaw(0.8)) < 1e-12);
    }

    #[test]
    fn section_3_slerp_goes_the_short_way() {
        let negated = UnitQuaternion::new_unchecked(-yaw(0.4).into_inner());
        assert!(slerp(&yaw(0.0), &negated, 0.5).angle_to(&yaw(0.2)) < 1e-12);
    }

    #[test]
    fn a_rigid_map_moves_points_as_its_pose_does() {
        let pose = Pose::from_parts(Vector3::new(1.0, -2.0, 3.0).into(), yaw(0.7));
        let p = Point3::new(4.0, 5.0, 6.0);
        assert!((RigidMap::from(&pose).apply(&p) - pose * p).norm() < 1e-12);
    }

    #[test]
    fn a_rigid_map_rounds_as_matrix_and_vector_do() {
        let pose = Pose::from_parts(Vector3::new(1.0, -2.0, 3.0).into(), yaw(0.7));
        let map = RigidMap::from(&pose);
        for i in 0..1000 {
            let p = Vector3::new(0.37, -1.13, 0.019) * f64::from(i);
            assert_eq!(map.apply(&p.into()).coords, map.rotation * p + map.offset);
        }
    }
}
