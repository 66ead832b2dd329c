//! Labels as text.

use occlabel_core::OccupancyLabels;
use occlabel_testkit::draw;

use super::{FREE, OCCUPIED};

/// What the characters of [`class_at`] mean.
pub(crate) const LEGEND: &str = "\
? unobserved   . free   = road   - terrain   # manmade   % vegetation   c car   p pedestrian   o other
from above: x up, y left; from the left: z up, x to the right; a character is a voxel of 0.5 m
";

const CLASSES: &[u8; 17] = b"o***c**p***=**-#%";

/// State and class of a voxel.
pub(crate) fn class_at(labels: &OccupancyLabels, voxel: [usize; 3]) -> char {
    match *labels.evidence().state.at(voxel) {
        OCCUPIED => char::from(CLASSES[usize::from(*labels.semantics.at(voxel))]),
        FREE => '.',
        _ => '?',
    }
}

/// Layer z.
pub(crate) fn from_above(shape: [usize; 3], z: usize, get: impl Fn([usize; 3]) -> char) -> String {
    format!("\nfrom above, layer z = {z}\n{}", draw(shape, get, z))
}

/// The slice at y, as seen from the side where y is high.
pub(crate) fn from_the_left(
    shape: [usize; 3],
    y: usize,
    get: impl Fn([usize; 3]) -> char,
) -> String {
    let [nx, _, nz] = shape;
    let upright = draw([nz, nx, 1], |[z, left, _]| get([nx - 1 - left, y, z]), 0);
    format!("\nfrom the left, slice y = {y}\n{upright}")
}
