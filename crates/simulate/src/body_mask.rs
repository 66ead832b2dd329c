//! The ego's own body in an image, drawn from simple shapes.

use occlabel_core::Fault;
use occlabel_core::camera::BodyMask;
use serde::Deserialize;

use crate::check::{each, need};

/// One shape of a camera's `body_mask`; it covers the pixels whose centres lie in it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum MaskPart {
    /// This row and all below it.
    FromRow(u32),
    /// Columns and rows, each from the first number up to but without the second.
    Rectangle { columns: [u32; 2], rows: [u32; 2] },
    /// An upright ellipse: centre and half axes as column and row, pixels.
    Ellipse { centre_px: [f64; 2], radii_px: [f64; 2] },
}

impl MaskPart {
    fn check(&self) -> Result<(), Fault> {
        match self {
            Self::FromRow(_) => Ok(()),
            Self::Rectangle { columns, rows } => {
                need("rectangle.columns", columns[0] < columns[1], "first, end", show(columns))?;
                need("rectangle.rows", rows[0] < rows[1], "first, end", show(rows))
            }
            Self::Ellipse { centre_px, radii_px } => {
                let finite = centre_px.iter().all(|value| value.is_finite());
                need("ellipse.centre_px", finite, "finite pixels", show(centre_px))?;
                let sized = radii_px.iter().all(|&radius| radius > 0.0 && radius.is_finite());
                need("ellipse.radii_px", sized, "pixels above 0", show(radii_px))
            }
        }
    }

    fn covers(&self, column: u32, row: u32) -> bool {
        match *self {
            Self::FromRow(first) => row >= first,
            Self::Rectangle { columns, rows } => {
                (columns[0]..columns[1]).contains(&column) && (rows[0]..rows[1]).contains(&row)
            }
            Self::Ellipse { centre_px, radii_px } => {
                let across = (f64::from(column) + 0.5 - centre_px[0]) / radii_px[0];
                let down = (f64::from(row) + 0.5 - centre_px[1]) / radii_px[1];
                across * across + down * down <= 1.0
            }
        }
    }
}

/// The mask of all shapes together; none if there is no shape.
pub(crate) fn body_mask(
    parts: &[MaskPart],
    width: u32,
    height: u32,
) -> Result<Option<BodyMask>, Fault> {
    each("body_mask", parts, MaskPart::check)?;
    if parts.is_empty() {
        return Ok(None);
    }
    let is_body = |column, row| parts.iter().any(|part| part.covers(column, row));
    let row_of = |row| (0..width).map(move |column| is_body(column, row));
    let covered = (0..height).flat_map(row_of).collect();
    let mask = BodyMask::new(width, height, covered);
    mask.map(Some).map_err(|error| Fault::new("world", "body_mask", "a mask", error.to_string()))
}

fn show<T: std::fmt::Debug>(numbers: &[T; 2]) -> String {
    format!("{numbers:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_cover_the_pixels_whose_centres_they_hold() {
        let parts = [
            MaskPart::FromRow(4),
            MaskPart::Rectangle { columns: [0, 2], rows: [0, 1] },
            MaskPart::Ellipse { centre_px: [6.5, 2.5], radii_px: [2.2, 1.1] },
        ];
        let mask = body_mask(&parts, 9, 5).unwrap().unwrap();
        let draw = |row| {
            (0..9)
                .map(|column| if mask.covers(column, row) { '#' } else { '.' })
                .collect::<String>()
        };
        let drawn = [0, 1, 2, 3, 4].map(draw);
        assert_eq!(drawn, ["##.......", "......#..", "....#####", "......#..", "#########"]);
        assert!(body_mask(&[], 9, 5).unwrap().is_none());
    }

    #[test]
    fn empty_and_endless_shapes_are_refused() {
        for (part, key) in [
            (MaskPart::Rectangle { columns: [2, 2], rows: [0, 1] }, "rectangle.columns"),
            (MaskPart::Rectangle { columns: [0, 2], rows: [3, 1] }, "rectangle.rows"),
            (MaskPart::Ellipse { centre_px: [f64::NAN, 0.0], radii_px: [1.0; 2] }, "centre_px"),
            (MaskPart::Ellipse { centre_px: [0.0; 2], radii_px: [1.0, 0.0] }, "radii_px"),
        ] {
            let fault = body_mask(&[part], 4, 4).unwrap_err();
            assert!(
                fault.place.starts_with("body_mask[0].") && fault.place.contains(key),
                "{fault}"
            );
        }
    }
}
