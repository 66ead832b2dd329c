//! The pinhole part that most models end with.

use nalgebra::Point2;

use super::CameraError;
use super::error::{check, check_finite};

/// Focal lengths, principal point and skew, in pixels.
///
/// ```text
/// u = fx x + skew y + cx
/// v =          fy y + cy        x, y on the normalised image plane (z = 1), unitless
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    skew: f64,
}

impl Intrinsics {
    /// From a calibration matrix K, rows first: `[[fx, skew, cx], [0, fy, cy], [0, 0, 1]]`.
    ///
    /// # Errors
    /// If a number is not finite, a focal length not positive, or the lower triangle not that of K.
    pub fn from_matrix(k: &[[f64; 3]; 3]) -> Result<Self, CameraError> {
        let &[[fx, skew, cx], [k10, fy, cy], [k20, k21, k22]] = k;
        check_finite("camera matrix", k.as_flattened())?;
        check("camera matrix fx", fx, "more than 0", |f| f > 0.0)?;
        check("camera matrix fy", fy, "more than 0", |f| f > 0.0)?;
        for below_diagonal in [k10, k20, k21] {
            check("camera matrix below its diagonal", below_diagonal, "0", |k| k == 0.0)?;
        }
        check("camera matrix, last element", k22, "1", |k| k == 1.0)?;
        Ok(Self { fx, fy, cx, cy, skew })
    }

    /// The calibration matrix K, rows first: the inverse of [`Self::from_matrix`].
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        [[self.fx, self.skew, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]]
    }

    /// Pixel of a point on the normalised image plane.
    pub(super) fn pixel(&self, plane: &Point2<f64>) -> Point2<f64> {
        Point2::new(self.fx * plane.x + self.skew * plane.y + self.cx, self.fy * plane.y + self.cy)
    }

    /// Point on the normalised image plane of a pixel: the inverse of [`Self::pixel`].
    pub(super) fn plane(&self, pixel: &Point2<f64>) -> Point2<f64> {
        let y = (pixel.y - self.cy) / self.fy;
        Point2::new((pixel.x - self.cx - self.skew * y) / self.fx, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const K: [[f64; 3]; 3] = [[400.0, 2.0, 320.0], [0.0, 500.0, 240.0], [0.0, 0.0, 1.0]];

    #[test]
    fn skew_moves_columns_with_rows() {
        let intrinsics = Intrinsics::from_matrix(&K).unwrap();
        let pixel = intrinsics.pixel(&Point2::new(0.25, 0.5));
        assert_eq!(pixel, Point2::new(100.0 + 1.0 + 320.0, 250.0 + 240.0));
        assert_eq!(intrinsics.plane(&pixel), Point2::new(0.25, 0.5));
    }

    #[test]
    fn impossible_matrices_are_refused() {
        let with = |row: usize, column: usize, value: f64| {
            let mut k = K;
            k[row][column] = value;
            Intrinsics::from_matrix(&k).unwrap_err().to_string()
        };
        assert_eq!(with(0, 0, 0.0), "camera matrix fx: 0, expected more than 0");
        assert_eq!(with(1, 1, -3.0), "camera matrix fy: -3, expected more than 0");
        assert_eq!(with(0, 2, f64::NAN), "camera matrix: NaN, expected a finite number");
        assert_eq!(with(1, 0, 5.0), "camera matrix below its diagonal: 5, expected 0");
        assert_eq!(with(2, 2, 2.0), "camera matrix, last element: 2, expected 1");
    }
}
