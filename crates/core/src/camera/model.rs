//! The closed set of camera models, and the door that every point and pixel passes.

use nalgebra::{Point2, Point3, Unit, Vector3};

use super::{BrownConrady, Intrinsics, KannalaBrandt, Mei, Ocam, Pinhole};

/// How a camera maps its frame (x right, y down, z forward) to continuous pixels.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraModel {
    /// No distortion.
    Pinhole(Pinhole),
    /// Radial and tangential distortion of a pinhole.
    BrownConrady(BrownConrady),
    /// Fisheye: image radius as a polynomial of the angle.
    KannalaBrandt(KannalaBrandt),
    /// Omnidirectional: a unit sphere seen from a shifted pinhole.
    Mei(Mei),
    /// Omnidirectional: viewing rays as a polynomial of the image radius.
    Ocam(Ocam),
}

impl CameraModel {
    /// The model's name, as logs write it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Pinhole(_) => "pinhole",
            Self::BrownConrady(_) => "brown-conrady",
            Self::KannalaBrandt(_) => "kannala-brandt",
            Self::Mei(_) => "mei",
            Self::Ocam(_) => "ocam",
        }
    }

    /// The pinhole part, if the model ends with one.
    pub fn intrinsics(&self) -> Option<&Intrinsics> {
        match self {
            Self::Pinhole(model) => Some(model.intrinsics()),
            Self::BrownConrady(model) => Some(model.intrinsics()),
            Self::KannalaBrandt(model) => Some(model.intrinsics()),
            Self::Mei(model) => Some(model.intrinsics()),
            Self::Ocam(_) => None,
        }
    }

    /// The distortion's coefficients in the order that the model is made from; none for a pinhole
    /// and for OCam, which has a polynomial of its own.
    pub fn coefficients(&self) -> Vec<f64> {
        match self {
            Self::Pinhole(_) | Self::Ocam(_) => Vec::new(),
            Self::BrownConrady(model) => model.coefficients(),
            Self::KannalaBrandt(model) => model.coefficients().to_vec(),
            Self::Mei(model) => model.coefficients().to_vec(),
        }
    }

    /// The continuous pixel of a point in the camera frame; pixel (i, j) covers [i, i+1) x [j,
    /// j+1).
    ///
    /// `None` where the point is out of view for the model, or has no finite direction or pixel.
    pub fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        if !point.coords.iter().all(|c| c.is_finite()) || point.coords == Vector3::zeros() {
            return None;
        }
        let pixel = match self {
            Self::Pinhole(model) => model.project(point),
            Self::BrownConrady(model) => model.project(point),
            Self::KannalaBrandt(model) => model.project(point),
            Self::Mei(model) => model.project(point),
            Self::Ocam(model) => model.project(point),
        }?;
        (pixel.x.is_finite() && pixel.y.is_finite()).then_some(pixel)
    }

    /// The unit direction in the camera frame that a continuous pixel looks along.
    ///
    /// `None` where no direction of the model's range projects to the pixel.
    pub fn unproject(&self, pixel: &Point2<f64>) -> Option<Unit<Vector3<f64>>> {
        if !pixel.x.is_finite() || !pixel.y.is_finite() {
            return None;
        }
        let ray = match self {
            Self::Pinhole(model) => Some(model.unproject(pixel)),
            Self::BrownConrady(model) => model.unproject(pixel),
            Self::KannalaBrandt(model) => model.unproject(pixel),
            Self::Mei(model) => model.unproject(pixel),
            Self::Ocam(model) => model.unproject(pixel),
        }?;
        let norm = ray.norm();
        (norm > 0.0 && norm.is_finite()).then(|| Unit::new_unchecked(ray / norm))
    }
}

#[cfg(test)]
mod tests {
    use super::super::checks::refuses_strange_input;
    use super::*;

    #[test]
    fn a_model_is_made_again_from_its_own_numbers() {
        let k = [[400.0, 2.0, 320.0], [0.0, 500.0, 240.0], [0.0, 0.0, 1.0]];
        let lens = Intrinsics::from_matrix(&k).unwrap();
        let d = [0.1, -0.02, 0.003, -0.004, 0.005, 0.06, 0.007, -0.008];
        for numbers in [&d[..4], &d[..5], &d] {
            let model = CameraModel::BrownConrady(BrownConrady::new(lens, numbers).unwrap());
            let again = BrownConrady::new(*model.intrinsics().unwrap(), &model.coefficients());
            assert_eq!(CameraModel::BrownConrady(again.unwrap()), model);
        }
        let fisheye = KannalaBrandt::new(lens, &d[..4]).unwrap();
        assert_eq!(KannalaBrandt::new(lens, &fisheye.coefficients()).unwrap(), fisheye);
        let mei = Mei::new(lens, &d[..5]).unwrap();
        assert_eq!(Mei::new(lens, &mei.coefficients()).unwrap(), mei);
        let ocam =
            Ocam::new(&[-200.0, 0.0, 1e-3], [320.0, 240.0], [1.0, 1e-4, -1e-4], 1.9).unwrap();
        let (poly, centre, affine) = (ocam.polynomial(), ocam.centre(), ocam.affine());
        assert_eq!(Ocam::new(poly, centre, affine, ocam.max_angle_rad()).unwrap(), ocam);
        assert_eq!(lens.matrix(), k);
    }

    #[test]
    fn absurd_calibrations_never_panic() {
        let k = |f: f64, c: f64| [[f, c, c], [0.0, f, -c], [0.0, 0.0, 1.0]];
        let mut exercised = 0;
        for absurd in
            [0.0, 5e-324, 1e-30, -1e-30, 1.0, -0.9, 1e30, -1e30, 1e300, f64::MAX, f64::MIN]
        {
            let (size, mut d) = (f64::abs(absurd).max(1e-300), [absurd; 8]);
            d[1] = -absurd / 3.0;
            let intrinsics = Intrinsics::from_matrix(&k(size, absurd)).unwrap();
            let models = [
                Some(CameraModel::Pinhole(Pinhole::new(intrinsics))),
                BrownConrady::new(intrinsics, &d).ok().map(CameraModel::BrownConrady),
                KannalaBrandt::new(intrinsics, &d[..4]).ok().map(CameraModel::KannalaBrandt),
                Mei::new(intrinsics, &d[..5]).ok().map(CameraModel::Mei),
                Ocam::new(&d, [absurd; 2], [size, 0.0, 0.0], 2.0).ok().map(CameraModel::Ocam),
            ];
            exercised +=
                models.iter().flatten().inspect(|model| refuses_strange_input(model)).count();
        }
        assert!(exercised > 45, "{exercised} models");
    }
}
