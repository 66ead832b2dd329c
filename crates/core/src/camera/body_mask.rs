//! The pixels that show the vehicle itself.

use super::CameraError;

/// Which pixels of an image show the vehicle's own body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyMask {
    width: u32,
    height: u32,
    /// Row-major, `width * height` of them.
    covered: Vec<bool>,
}

impl BodyMask {
    /// A mask from row-major flags, `true` where the body is.
    ///
    /// # Errors
    /// If there are not exactly `width * height` flags.
    pub fn new(width: u32, height: u32, covered: Vec<bool>) -> Result<Self, CameraError> {
        if covered.len() as u64 != u64::from(width) * u64::from(height) {
            let found = covered.len();
            return Err(CameraError::BodyMaskSize { width, height, found });
        }
        Ok(Self { width, height, covered })
    }

    /// Columns of the mask.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows of the mask.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Whether the body covers a pixel; `false` outside the mask.
    pub fn covers(&self, column: u32, row: u32) -> bool {
        let inside = column < self.width && row < self.height;
        inside && self.covered[row as usize * self.width as usize + column as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_row_major() {
        let mask = BodyMask::new(3, 2, vec![false, false, true, true, false, false]).unwrap();
        let drawn: Vec<String> = (0..mask.height())
            .map(|row| {
                (0..mask.width())
                    .map(|column| if mask.covers(column, row) { '#' } else { '.' })
                    .collect()
            })
            .collect();
        assert_eq!(drawn, ["..#", "#.."]);
        assert!(!mask.covers(3, 0) && !mask.covers(0, 2) && !mask.covers(u32::MAX, u32::MAX));
    }

    #[test]
    fn wrong_size_tells_both_numbers() {
        let error = BodyMask::new(3, 2, vec![true; 5]).unwrap_err();
        assert_eq!(error.to_string(), "body mask: 5 pixels, expected 3 x 2");
    }
}
