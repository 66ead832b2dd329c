//! Rigid transforms, named `dst_from_src`.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

/// A rigid transform; `a_from_b * b_from_c` chains, `a_from_b * point_in_b` applies.
pub(crate) type Pose = Isometry3<f64>;

/// A pose turned by `yaw_rad` about z, counter-clockwise seen from above.
pub(crate) fn yaw_pose(translation_m: [f64; 3], yaw_rad: f64) -> Pose {
    let half = yaw_rad / 2.0;
    pose(translation_m, [libm::cos(half), 0.0, 0.0, libm::sin(half)])
}

/// A pose from a unit quaternion, w first. (nalgebra's own makers of rotations call the
/// platform's sine, which differs from one machine to the next.)
pub(crate) fn pose(translation_m: [f64; 3], [w, x, y, z]: [f64; 4]) -> Pose {
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Pose::from_parts(Translation3::from(translation_m), rotation)
}

/// The translation as nuScenes writes it.
pub(crate) fn translation_of(pose: &Pose) -> [f64; 3] {
    pose.translation.vector.into()
}

/// The quaternion as nuScenes writes it, w first.
pub(crate) fn rotation_of(pose: &Pose) -> [f64; 4] {
    let q = pose.rotation.quaternion();
    [q.w, q.i, q.j, q.k]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_left_turn_brings_x_to_y() {
        let turned = yaw_pose([1.0, 0.0, 0.0], FRAC_PI_2) * Point3::new(2.0, 0.0, 3.0);
        let error_m = (turned - Point3::new(1.0, 2.0, 3.0)).norm();
        assert!(error_m < 1e-12, "off by {error_m} m");
    }
}
