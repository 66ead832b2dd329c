//! Matrices of three dimensions: rows, columns, values of a pixel.

/// More pixels than these are refused: the largest images of the format have 170 000.
pub(super) const MAX_PIXELS: usize = 1 << 22;

/// A matrix whose number of values is that of its shape.
#[derive(Debug)]
pub(crate) struct Matrix<T> {
    rows: usize,
    columns: usize,
    /// Rows first, the values of a pixel side by side.
    pub(super) data: Vec<T>,
}

impl<T> Matrix<T> {
    /// A matrix of `values` values a pixel.
    ///
    /// # Errors
    /// What was found, if the shape has other dimensions, holds no or too many pixels, or another
    /// number of values.
    pub(super) fn new(shape: &[i32], values: usize, data: Vec<T>) -> Result<Self, String> {
        let sides: Vec<usize> =
            shape.iter().filter_map(|side| usize::try_from(*side).ok()).collect();
        let [rows, columns, depth] = sides[..] else { return Err(format!("the shape {shape:?}")) };
        let pixels = rows.checked_mul(columns).filter(|pixels| (1..=MAX_PIXELS).contains(pixels));
        match pixels {
            Some(pixels) if depth == values && data.len() == pixels * values => {
                Ok(Self { rows, columns, data })
            }
            _ => Err(format!("the shape {shape:?} with {} values", data.len())),
        }
    }

    /// Rows and columns.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.rows, self.columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_is_believed_only_if_the_values_are_there() {
        assert_eq!(Matrix::new(&[2, 3, 4], 4, vec![0.0; 24]).unwrap().size(), (2, 3));
        for (shape, count) in [
            (&[2, 3, 4][..], 23),
            (&[2, 3, 2], 12),
            (&[2, 3], 24),
            (&[2, 3, 4, 1], 24),
            (&[-2, -3, 4], 24),
            (&[0, 3, 4], 0),
            (&[i32::MAX, i32::MAX, 4], 24),
        ] {
            assert!(Matrix::new(shape, 4, vec![0.0; count]).is_err(), "{shape:?}");
        }
    }
}
