//! Labels from above, small and bare.

use image::RgbImage;

use crate::picture::birds_eye::color;
use crate::picture::column::columns;
use crate::picture::painted::Painted;

/// Its longer side, at most, pixels.
const LONGEST_PX: usize = 200;

/// The labels from above, x up and y to the left, a pixel a column or fewer, without legend and marks.
///
/// # Panics
/// If the grids are not of the spec's shape.
pub fn thumbnail(labels: &Painted) -> RgbImage {
    labels.check();
    let [nx, ny, nz] = labels.spec.shape();
    let step = nx.max(ny).div_ceil(LONGEST_PX);
    let columns = columns(labels);
    let place = |pixel: u32, n: usize| n - 1 - (pixel as usize * step).min(n - 1);
    RgbImage::from_fn(ny.div_ceil(step) as u32, nx.div_ceil(step) as u32, |across, down| {
        let (x, y) = (place(down, nx), place(across, ny));
        let ahead_left = (x + 1).min(nx - 1) * ny + (y + 1).min(ny - 1);
        color(labels, columns[x * ny + y], columns[ahead_left], nz)
    })
}
