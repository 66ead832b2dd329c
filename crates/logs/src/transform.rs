//! Poses from matrices, from quaternions, and from roll, pitch and yaw.

use nalgebra::{Matrix3, Matrix4, Quaternion, Rotation3, Translation3, UnitQuaternion};
use occlabel_core::Pose;

/// How far from a rotation a matrix may be, largest element of R R^T - 1: beyond it, it tells none.
const LARGEST_ERROR: f64 = 1e-4;

/// How far a quaternion's norm may be off 1.
const LARGEST_NORM_ERROR: f64 = 1e-2;

/// Nothing stands farther than this from its frame's origin along any axis, metres: no place on Earth
/// does, and steps of f64 are a tenth of a micrometre there.
const LARGEST_PLACE_M: f64 = 1e9;

/// What every place has to be.
pub(crate) const A_PLACE: &str = "finite numbers of at most 1e9 m";

/// Whether these are metres of a place: finite, and at most 1e9.
pub(crate) fn is_place<'a>(metres: impl IntoIterator<Item = &'a f64>) -> bool {
    metres.into_iter().all(|metres| metres.abs() <= LARGEST_PLACE_M)
}

/// The pose of a rigid transform's 4 x 4 matrix, rows first, its rotation made exactly one.
///
/// # Errors
/// What was found, if that is not 16 finite numbers, or no rigid transform: mirrored, skewed or
/// scaled by more than 1e-4, or by more than 1e9 m from the origin.
pub(crate) fn pose_from_matrix(numbers: &[f64]) -> Result<Pose, String> {
    let Ok(numbers) = <&[f64; 16]>::try_from(numbers) else {
        return Err(format!("{} numbers", numbers.len()));
    };
    if !numbers.iter().all(|number| number.is_finite()) {
        return Err("a number that is not finite".into());
    }
    let place = [numbers[3], numbers[7], numbers[11]];
    if !is_place(&place) {
        return Err(format!("a place {place:?} m, beyond 1e9 m"));
    }
    let matrix = Matrix4::from_row_slice(numbers);
    if numbers[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(format!("a last row of {:?}", &numbers[12..]));
    }
    let rotation: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into();
    if rotation.determinant() <= 0.0 {
        return Err(format!("a determinant of {}", rotation.determinant()));
    }
    let error = (rotation * rotation.transpose() - Matrix3::identity()).amax();
    if error > LARGEST_ERROR {
        return Err(format!("a matrix that is off a rotation by {error}"));
    }
    Ok(Pose::from_parts(place.into(), nearest_rotation(rotation)))
}

/// The pose of the first three rows of a rigid transform's matrix, its rotation made exactly one.
///
/// # Errors
/// What was found, if a number is not finite, the matrix is mirrored, skewed or scaled by more
/// than 1e-4, or the place more than 1e9 m off.
pub(crate) fn pose_from_rows(numbers: &[f64; 12]) -> Result<Pose, String> {
    let mut whole = [0.0; 16];
    whole[..12].copy_from_slice(numbers);
    whole[15] = 1.0;
    pose_from_matrix(&whole)
}

/// What every 4 x 4 transform has to be.
pub(crate) const A_POSE: &str = "16 numbers of a rigid transform";

/// By square roots alone, which are the same on every machine.
fn nearest_rotation(matrix: Matrix3<f64>) -> UnitQuaternion<f64> {
    let near = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
    UnitQuaternion::new_normalize(near.into_inner())
}

/// The pose of a quaternion, its real part first, made one of norm 1, and a place in metres.
///
/// # Errors
/// What was found, if a number is not finite, the norm off by more than 1e-2, or the place more than 1e9 m
/// off.
pub(crate) fn pose_from_quaternion(
    [w, x, y, z]: [f64; 4],
    place: [f64; 3],
) -> Result<Pose, String> {
    let rotation = Quaternion::new(w, x, y, z);
    let norm = rotation.norm();
    if !norm.is_finite() || !place.iter().all(|number| number.is_finite()) {
        return Err("a number that is not finite".into());
    }
    if !is_place(&place) {
        return Err(format!("a place {place:?} m, beyond 1e9 m"));
    }
    if (norm - 1.0).abs() > LARGEST_NORM_ERROR {
        return Err(format!("a quaternion of norm {norm}"));
    }
    Ok(Pose::from_parts(Translation3::from(place), UnitQuaternion::new_normalize(rotation)))
}

/// The pose of a vehicle by roll, pitch and yaw about x, y and z, and its place: it is turned by roll
/// first, by yaw last.
pub(crate) fn pose_from_angles([roll, pitch, yaw, x, y, z]: [f64; 6]) -> Pose {
    let about_z = Quaternion::new(libm::cos(yaw / 2.0), 0.0, 0.0, libm::sin(yaw / 2.0));
    let about_y = Quaternion::new(libm::cos(pitch / 2.0), 0.0, libm::sin(pitch / 2.0), 0.0);
    let about_x = Quaternion::new(libm::cos(roll / 2.0), libm::sin(roll / 2.0), 0.0, 0.0);
    let rotation = UnitQuaternion::new_normalize(about_z * about_y * about_x);
    Pose::from_parts(Translation3::new(x, y, z), rotation)
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;

    /// A quarter turn to the left, then 1 2 3 on.
    const LEFT: [f64; 16] =
        [0.0, -1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0, 0.0, 1.0];

    fn with(place: usize, number: f64) -> Result<Pose, String> {
        let mut numbers = LEFT;
        numbers[place] = number;
        pose_from_matrix(&numbers)
    }

    #[test]
    fn a_matrix_moves_points_by_its_rows() {
        let moved = pose_from_matrix(&LEFT).unwrap() * Point3::new(1.0, 0.0, 0.5);
        assert!((moved - Point3::new(1.0, 3.0, 3.5)).norm() < 1e-12);
    }

    #[test]
    fn fault_14_mirrored_skewed_and_broken_matrices_are_refused() {
        assert_eq!(with(10, -1.0).unwrap_err(), "a determinant of -1");
        assert!(
            with(1, -1.001).unwrap_err().starts_with("a matrix that is off a rotation by 0.002")
        );
        assert_eq!(with(3, f64::NAN).unwrap_err(), "a number that is not finite");
        assert_eq!(with(15, 2.0).unwrap_err(), "a last row of [0.0, 0.0, 0.0, 2.0]");
        assert_eq!(pose_from_matrix(&LEFT[..12]).unwrap_err(), "12 numbers");
        assert!(with(1, -1.00001).is_ok());
    }

    #[test]
    fn fault_19_a_place_beyond_a_thousand_million_metres_is_refused() {
        assert!(with(3, 1e9).is_ok() && with(11, -1e9).is_ok());
        assert!(with(3, 1.1e9).unwrap_err().ends_with("beyond 1e9 m"));
        assert!(with(11, -1e300).unwrap_err().ends_with("beyond 1e9 m"));
        assert!(!is_place(&[0.0, f64::NAN, 0.0]) && !is_place(&[f64::INFINITY]));
    }

    #[test]
    fn roll_comes_first_and_yaw_last() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let pose = pose_from_angles([quarter, 0.0, quarter, 5.0, 0.0, 0.0]);
        // The vehicle's left rolls up; yaw leaves up where it is.
        assert!((pose * Point3::new(0.0, 1.0, 0.0) - Point3::new(5.0, 0.0, 1.0)).norm() < 1e-12);
        // Its front yaws to the left.
        assert!((pose * Point3::new(1.0, 0.0, 0.0) - Point3::new(5.0, 1.0, 0.0)).norm() < 1e-12);
    }
}
