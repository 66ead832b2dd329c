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
    /// By row.
    rotation: [[f64; 3]; 3],
    offset: [f64; 3],
}

impl From<&Pose> for RigidMap {
    fn from(pose: &Pose) -> Self {
        let matrix: Matrix3<f64> = pose.rotation.to_rotation_matrix().into_inner();
        Self { rotation: matrix.transpose().into(), offset: pose.translation.vector.into() }
    }
}

impl RigidMap {
    /// Moves a point from the source frame to the destination frame.
    ///
    /// Written out, so that it is rounded the same way wherever it is compiled: column by column,
    /// the offset last.
    #[inline(always)]
    pub fn apply(&self, p: &Point3<f64>) -> Point3<f64> {
        let [x, y, z] = &self.rotation;
        let row = |r: &[f64; 3], offset: f64| r[0] * p.x + r[1] * p.y + r[2] * p.z + offset;
        Point3::new(row(x, self.offset[0]), row(y, self.offset[1]), row(z, self.offset[2]))
    }

    /// Half the sides, along the destination's axes, of a box around a box of such half sides.
    #[inline]
    pub fn spread(&self, half: &Vector3<f64>) -> Vector3<f64> {
        let row = |r: &[f64; 3]| r[0].abs() * half.x + r[1].abs() * half.y + r[2].abs() * half.z;
        Vector3::new(row(&self.rotation[0]), row(&self.rotation[1]), row(&self.rotation[2]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn yaw(angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
    }

    #[test]
    fn section_12_the_turns_of_nalgebra_are_those_of_libm() {
        for step in 0..10_000 {
            let angle = f64::from(step) * 1e-3;
            let turn = yaw(angle);
            assert_eq!((turn.k, turn.w), libm::sincos(angle / 2.0));
            assert_eq!(turn.angle(), 2.0 * libm::atan2(turn.imag().norm(), turn.w.abs()));
        }
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
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.2, 0.7);
        let pose = Pose::from_parts(Vector3::new(1.0, -2.0, 3.0).into(), turn);
        let p = Point3::new(4.0, 5.0, 6.0);
        let (map, rotation) = (RigidMap::from(&pose), pose.rotation.to_rotation_matrix());
        assert!((map.apply(&p) - pose * p).norm() < 1e-12);
        let mut to_the_bit = 0;
        for i in 0..1000 {
            let p =
                Point3::from([1.0, 1e3, 1e7].map(|scale| libm::sin(f64::from(i) * scale) * scale));
            let product = Point3::from(rotation.matrix() * p.coords + pose.translation.vector);
            to_the_bit += usize::from(map.apply(&p) == product);
        }
        assert_eq!(to_the_bit, 1000);
    }
}
