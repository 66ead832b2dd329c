//! Cameras of every model, with any numbers.

use nalgebra::{Point2, Point3};
use occlabel_core::Camera;
use occlabel_core::camera::{
    BodyMask, BrownConrady, CameraError, CameraModel, Intrinsics, KannalaBrandt, Mei, Ocam, Pinhole,
};

use super::bytes::Bytes;

/// Projects and unprojects. What is in view has a pixel of the image, and what a pixel sees a
/// direction of length one.
pub(super) fn camera(bytes: &[u8]) -> bool {
    let mut bytes = Bytes(bytes);
    let Ok(model) = any_model(&mut bytes) else { return false };
    let Some(camera) = with_image(model, &mut bytes) else { return false };
    for _ in 0..4 {
        let point = Point3::from(bytes.numbers::<3>());
        let seen = camera.pixel_of(&point);
        assert!(seen.is_none_or(|(u, v)| u < camera.width && v < camera.height), "{camera:?}");
        let pixel = camera.model.project(&point);
        assert!(pixel.is_none_or(|pixel| pixel.coords.iter().all(|c| c.is_finite())));
        assert_direction(&camera, camera.model.unproject(&Point2::from(bytes.numbers::<2>())));
        let [column, row] = [bytes.byte(), bytes.byte()].map(u32::from);
        assert_direction(&camera, camera.ray_of(column, row));
    }
    true
}

fn assert_direction(camera: &Camera, ray: Option<nalgebra::Unit<nalgebra::Vector3<f64>>>) {
    assert!(ray.is_none_or(|ray| (ray.norm() - 1.0).abs() < 1e-9), "{camera:?} {ray:?}");
}

/// A small image, part of which may be the vehicle's own body.
pub(super) fn with_image(model: CameraModel, bytes: &mut Bytes) -> Option<Camera> {
    let [width, height] = [1 + bytes.below(40), 1 + bytes.below(30)].map(|side| side as u32);
    let body_mask = match bytes.flag() {
        true => {
            let covered = (0..width * height).map(|pixel| pixel % 7 == 3).collect();
            Some(BodyMask::new(width, height, covered).ok()?)
        }
        false => None,
    };
    Some(Camera { model, width, height, body_mask, rolling_shutter: None })
}

/// With numbers as they are found, or such as an image of this size could have.
pub(super) fn any_model(bytes: &mut Bytes) -> Result<CameraModel, CameraError> {
    let kind = bytes.byte() % 5;
    if kind == 4 {
        let polynomial: [f64; 4] = bytes.numbers();
        let (centre, affine) = (bytes.numbers(), bytes.numbers());
        return Ok(CameraModel::Ocam(Ocam::new(&polynomial, centre, affine, bytes.number())?));
    }
    let [fx, fy, cx, cy, skew] = match bytes.flag() {
        true => bytes.numbers(),
        false => [(); 5].map(|()| bytes.between(0.01, 40.0)),
    };
    let k = Intrinsics::from_matrix(&[[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])?;
    Ok(match kind {
        0 => CameraModel::Pinhole(Pinhole::new(k)),
        1 => {
            let count = [4, 5, 8][bytes.below(3)];
            let coefficients: [f64; 8] = bytes.numbers();
            CameraModel::BrownConrady(BrownConrady::new(k, &coefficients[..count])?)
        }
        2 => CameraModel::KannalaBrandt(KannalaBrandt::new(k, &bytes.numbers::<4>())?),
        _ => CameraModel::Mei(Mei::new(k, &bytes.numbers::<5>())?),
    })
}

/// One of every model.
pub(super) fn cameras() -> Vec<Vec<u8>> {
    let plain = |kind: u8| [&[kind, 0][..], &[3, 20, 0, 5, 1, 90, 40].repeat(16)].concat();
    let (one, nought) = ([3, 0, 1], [0, 0]);
    let polynomial = [&[3, 0, 3][..], &nought.repeat(3)].concat();
    let affine = [&one[..], &nought, &nought].concat();
    let ocam = [&[4][..], &polynomial, &one.repeat(2), &affine, &one.repeat(40)].concat();
    (0..4).map(plain).chain([ocam]).collect()
}
