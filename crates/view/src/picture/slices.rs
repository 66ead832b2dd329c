//! Cuts through the grid.

use std::ops::Range;

use image::{Rgb, RgbImage};

use crate::picture::birds_eye::cells;
use crate::picture::color::{FREE, UNLABELLED, UNOBSERVED};
use crate::picture::legend::Legend;
use crate::picture::painted::{Painted, hidden};
use crate::picture::plate::Plate;
use crate::picture::tiles::Tiles;

/// Across which axis cuts are made, and what lies up and to the left on them.
///
/// ```text
///   Z: x up, y left         Y: z up, x left         X: z up, y left
///      (a floor plan)          (seen from the left)    (seen from behind)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// Upright cuts, each at one x.
    X,
    /// Upright cuts, each at one y.
    Y,
    /// Level cuts, each at one height.
    Z,
}

/// More cuts than this are thinned out evenly.
const MOST_CUTS: usize = 64;
const MOST_UPRIGHT_CUTS: usize = 24;

impl Across {
    /// The axes across, up and left.
    fn axes(self) -> [usize; 3] {
        match self {
            Self::X => [0, 2, 1],
            Self::Y => [1, 2, 0],
            Self::Z => [2, 0, 1],
        }
    }

    fn name(self) -> &'static str {
        ["x", "y", "z"][self.axes()[0]]
    }

    /// Which cuts are shown of `n`.
    fn shown(self, n: usize) -> Vec<usize> {
        let most = if self == Self::Z { MOST_CUTS } else { MOST_UPRIGHT_CUTS };
        let count = n.min(most);
        (0..count).map(|i| (2 * i + 1) * n / (2 * count)).collect()
    }
}

impl Plate<'_> {
    /// Every level of the grid, or cuts from front to back or left to right, with the state of each
    /// voxel.
    ///
    /// # Panics
    /// If the grids are not of the spec's shape.
    pub fn slices(&self, labels: &Painted, across: Across) -> RgbImage {
        labels.check();
        let [through, up, left] = across.axes();
        let extent_m = labels.spec.max_m() - labels.spec.min_m();
        let aspect = extent_m[left] / extent_m[up];
        let cuts = across.shown(labels.spec.shape()[through]);
        let mut tiles = Tiles::new(&vec![aspect; cuts.len()], self.body_px());
        let size = tiles.size_px(aspect);
        for (place, &cut) in cuts.iter().enumerate() {
            let tile = slice(labels, across, cut, size);
            tiles.put(place as u32, &tile, &caption(labels, across, cut));
        }
        self.around(&tiles.into_picture(), &legend(labels))
    }
}

/// From where to where a cut reaches, metres.
fn caption(labels: &Painted, across: Across, cut: usize) -> String {
    let axis = across.axes()[0];
    let edge = |at: usize| {
        let edge_m = labels.spec.min_m()[axis] + at as f64 * labels.spec.size_m()[axis];
        (edge_m * 1000.0).round() / 1000.0 + 0.0
    };
    format!("{} {} to {} m", across.name(), edge(cut), edge(cut + 1))
}

fn legend(labels: &Painted) -> Legend {
    let mut legend = Legend::of(labels);
    let has = |state: Rgb<u8>| {
        let flats = 0..labels.spec.len();
        flats
            .filter(|&flat| labels.class(flat).is_none())
            .any(|at| empty_color(labels, at) == state)
    };
    for (color, name) in
        [(FREE, labels.free_name()), (UNOBSERVED, "unobserved"), (UNLABELLED, "no label")]
    {
        legend = if has(color) { legend.with(color, name) } else { legend };
    }
    if labels.has_cameras() { legend.with_hidden() } else { legend }
}

/// One cut.
fn slice(labels: &Painted, across: Across, cut: usize, (width, height): (u32, u32)) -> RgbImage {
    let [through, up, left] = across.axes();
    let (shape, strides) = (labels.spec.shape(), labels.spec.strides());
    let cameras = labels.has_cameras();
    RgbImage::from_fn(width, height, |x, y| {
        let rows = cells(y, shape[up], height);
        let columns = cells(x, shape[left], width);
        let place = |row: usize, column: usize| {
            cut * strides[through] + row * strides[up] + column * strides[left]
        };
        voxel_color(labels, showing(labels, rows, columns, place), cameras)
    })
}

/// Of the voxels under a pixel the one that shows: the first occupied one, or else the first.
fn showing(
    labels: &Painted,
    rows: Range<usize>,
    columns: Range<usize>,
    place: impl Fn(usize, usize) -> usize + Copy,
) -> usize {
    let first = place(rows.start, columns.start);
    let mut all = rows.flat_map(|row| columns.clone().map(move |column| place(row, column)));
    all.find(|&flat| labels.class(flat).is_some()).unwrap_or(first)
}

fn voxel_color(labels: &Painted, flat: usize, cameras: bool) -> Rgb<u8> {
    let color = match labels.class(flat) {
        Some(class) => labels.color(class),
        None => empty_color(labels, flat),
    };
    let known = labels.class(flat).is_some() || color == FREE;
    if known && cameras && labels.unseen(flat) { hidden(color) } else { color }
}

fn empty_color(labels: &Painted, flat: usize) -> Rgb<u8> {
    match () {
        () if labels.unlabelled(flat) => UNLABELLED,
        () if labels.observed(flat) => FREE,
        () => UNOBSERVED,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_are_thinned_out_evenly() {
        assert_eq!(Across::Z.shown(4), [0, 1, 2, 3]);
        assert_eq!(Across::X.shown(48)[..3], [1, 3, 5]);
        assert_eq!((Across::Y.shown(200).len(), Across::Z.shown(64).len()), (24, 64));
    }
}
