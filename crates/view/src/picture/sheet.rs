//! The picture that tells a stranger most: from above, and from behind.

use image::{RgbImage, imageops};

use crate::picture::birds_eye::{legend, map, map_with_foot, mark_map};
use crate::picture::column::columns;
use crate::picture::orbit::Aim;
use crate::picture::painted::Painted;
use crate::picture::perspective::cubes;
use crate::picture::plate::{Plate, blank};

impl Plate<'_> {
    /// The labels from above, and beside or under it as lit cubes.
    ///
    /// # Panics
    /// If the grids are not of the spec's shape.
    pub fn sheet(&self, labels: &Painted, aim: &Aim) -> RgbImage {
        labels.check();
        let columns = columns(labels);
        let above = |room| {
            map_with_foot(labels, room, |size| {
                let mut map = map(labels, &columns, size);
                mark_map(&mut map, labels);
                map
            })
        };
        let behind = |room| cubes(labels, &aim.at(labels, room));
        let body = two(self.body_px(), above, behind);
        self.around(&body, &legend(labels, &columns))
    }
}

/// Two pictures, each drawn by its size, side by side; one above the other where that is high.
pub(crate) fn two(
    (width, height): (u32, u32),
    first: impl FnOnce((u32, u32)) -> RgbImage,
    second: impl FnOnce((u32, u32)) -> RgbImage,
) -> RgbImage {
    let mut body = blank(width, height);
    let (half, at) = match width >= height {
        true => ((width / 2, height), (width / 2, 0)),
        false => ((width, height / 2), (0, height / 2)),
    };
    imageops::replace(&mut body, &first(half), 0, 0);
    let rest = (width - at.0, height - at.1);
    imageops::replace(&mut body, &second(rest), at.0.into(), at.1.into());
    body
}
