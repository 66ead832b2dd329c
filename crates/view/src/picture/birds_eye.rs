//! Labels from above.
//!
//! ```text
//!            x forward                  left of the ego is left in the picture
//!               ^
//!   y left <----+      row 0 = greatest x, column 0 = greatest y
//! ```

use std::ops::Range;

use image::{Rgb, RgbImage, imageops};
use nalgebra::Vector2;
use occlabel_core::GridSpec;
use rayon::prelude::*;

use crate::picture::canvas::At;
use crate::picture::color::{FREE, PAPER, UNLABELLED, UNOBSERVED, lit};
use crate::picture::column::{Column, columns};
use crate::picture::legend::Legend;
use crate::picture::marks;
use crate::picture::painted::{Painted, hidden};
use crate::picture::plate::{Plate, blank};

pub(crate) const MARGIN_PX: u32 = 28;
pub(crate) const FOOT_PX: u32 = 46;
/// Their step is at least a twentieth of the longest side, and they reach to half of it.
const MOST_RINGS: u32 = 10;

/// How the picture from above is drawn.
#[derive(Clone, Copy, Debug)]
pub struct BirdsEye {
    /// The longer side of the map, pixels; the picture is larger by its margins and legend. A whole
    /// number of pixels a voxel looks best.
    pub map_px: u32,
}

/// The labels from above, x up and y to the left: the class of each column's topmost occupied voxel,
/// the brighter the higher; free and unobserved columns, and what no camera sees, shown apart.
///
/// # Panics
/// If the grids are not of the spec's shape.
pub fn birds_eye(labels: &Painted, view: &BirdsEye) -> RgbImage {
    labels.check();
    let columns = columns(labels);
    let side = view.map_px.max(1);
    let map = marked_map(labels, &columns, map_size(labels.spec, (side, side)));
    let legend = legend(labels, &columns);
    let legend_left = f64::from(2 * MARGIN_PX + map.width());
    let foot = map.height() + 2 * MARGIN_PX + FOOT_PX;
    let height = foot.max(legend.height_px() as u32 + 2 * MARGIN_PX);
    let width = legend_left + legend.width_px() + f64::from(MARGIN_PX);
    let mut picture = RgbImage::from_pixel(width as u32, height, PAPER);
    imageops::replace(&mut picture, &map, MARGIN_PX.into(), MARGIN_PX.into());
    legend.draw(&mut picture, At::new(legend_left, f64::from(MARGIN_PX)));
    mark_foot(&mut picture, labels, (MARGIN_PX, MARGIN_PX), map.dimensions());
    picture
}

impl Plate<'_> {
    /// The same as large as the plate allows.
    ///
    /// # Panics
    /// If the grids are not of the spec's shape.
    pub fn birds_eye(&self, labels: &Painted) -> RgbImage {
        labels.check();
        let columns = columns(labels);
        let draw = |size| marked_map(labels, &columns, size);
        let body = map_with_foot(labels, self.body_px(), draw);
        self.around(&body, &legend(labels, &columns))
    }
}

/// A map, drawn by its size, in the middle of a room, with the scale bar and the axes under it.
pub(crate) fn map_with_foot(
    labels: &Painted,
    (width, height): (u32, u32),
    draw: impl FnOnce((u32, u32)) -> RgbImage,
) -> RgbImage {
    let room = (width.saturating_sub(2 * MARGIN_PX), height.saturating_sub(FOOT_PX + 6));
    let map = draw(map_size(labels.spec, room));
    let mut body = blank(width, height);
    let left = (width - map.width().min(width)) / 2;
    let top = height.saturating_sub(map.height() + FOOT_PX) / 2;
    imageops::replace(&mut body, &map, left.into(), top.into());
    mark_foot(&mut body, labels, (left, top), map.dimensions());
    body
}

/// What the classes and the states of columns look like.
pub(crate) fn legend(labels: &Painted, columns: &[Column]) -> Legend {
    let legend = with_states(Legend::of(labels), labels.free_name(), columns);
    if labels.has_cameras() { legend.with_hidden() } else { legend }
}

/// The legend with the states that occur in columns.
pub(crate) fn with_states(mut legend: Legend, free: &str, columns: &[Column]) -> Legend {
    let has = |is: fn(&Column) -> bool| columns.iter().any(is);
    if has(|column| matches!(column, Column::Free { .. })) {
        legend = legend.with(FREE, free);
    }
    if has(|column| *column == Column::Unobserved) {
        legend = legend.with(UNOBSERVED, "unobserved");
    }
    if has(|column| *column == Column::Unlabelled) {
        legend = legend.with(UNLABELLED, "no label");
    }
    legend
}

/// The map with rings and the ego on it.
fn marked_map(labels: &Painted, columns: &[Column], size: (u32, u32)) -> RgbImage {
    let mut map = map(labels, columns, size);
    mark_map(&mut map, labels);
    map
}

/// The map alone.
pub(crate) fn map(labels: &Painted, columns: &[Column], (width, height): (u32, u32)) -> RgbImage {
    let [nx, ny, nz] = labels.spec.shape();
    let row = |row: u32| -> Vec<u8> {
        let pixel = |at: u32| {
            let (x, y) = showing(columns, ny, cells(row, nx, height), cells(at, ny, width));
            let ahead_left = (x + 1).min(nx - 1) * ny + (y + 1).min(ny - 1);
            color(labels, columns[x * ny + y], columns[ahead_left], nz).0
        };
        (0..width).flat_map(pixel).collect()
    };
    let rows: Vec<_> = (0..height).into_par_iter().map(row).collect();
    RgbImage::from_vec(width, height, rows.concat()).expect("three bytes a pixel")
}

/// Of the columns under a pixel the one that shows: that of the greatest rank, the first of these.
fn showing(columns: &[Column], ny: usize, x: Range<usize>, y: Range<usize>) -> (usize, usize) {
    let mut best = (x.start, y.start);
    for (x, y) in x.flat_map(|x| y.clone().map(move |y| (x, y))) {
        if columns[x * ny + y].rank() > columns[best.0 * ny + best.1].rank() {
            best = (x, y);
        }
    }
    best
}

/// The voxels, of `n` along an axis, under a pixel of `pixels`; the first pixel is over the last voxel.
pub(crate) fn cells(pixel: u32, n: usize, pixels: u32) -> Range<usize> {
    let before = |pixel: u32| (u64::from(pixel) * n as u64 / u64::from(pixels)) as usize;
    let (first, end) = (before(pixel), before(pixel + 1));
    n - end.max(first + 1)..n - first
}

/// Width and height of the largest map in a room, pixels: a whole number of pixels for a voxel where
/// that costs little.
pub(crate) fn map_size(spec: &GridSpec, (width, height): (u32, u32)) -> (u32, u32) {
    let extent_m = spec.max_m() - spec.min_m();
    let limit = (f64::from(width) / extent_m.y).min(f64::from(height) / extent_m.x);
    let voxel_m = spec.size_m().x.min(spec.size_m().y);
    let whole = (limit * voxel_m + 1e-9).floor() / voxel_m;
    let scale = if whole >= 0.85 * limit { whole } else { limit };
    let pixels = |side_m: f64| ((side_m * scale).round() as u32).max(1);
    (pixels(extent_m.y), pixels(extent_m.x))
}

/// The colour of a column, beside that from where the light comes.
pub(super) fn color(labels: &Painted, column: Column, ahead_left: Column, nz: usize) -> Rgb<u8> {
    match column {
        Column::Unobserved => UNOBSERVED,
        Column::Unlabelled => UNLABELLED,
        Column::Free { hidden: false } => FREE,
        Column::Free { hidden: true } => hidden(FREE),
        Column::Occupied { class, z, hidden: dull } => {
            let top = (z + 1) as f64;
            let other = ahead_left.top().map_or(top, |other| other as f64);
            let light = 0.78 + 0.22 * top / nz as f64 + 0.07 * (top - other).clamp(-2.0, 2.0);
            let color = lit(labels.color(class), light);
            if dull { hidden(color) } else { color }
        }
    }
}

/// Pixels a metre of a map of a width.
fn scale_px_per_m(width: u32, spec: &GridSpec) -> f64 {
    f64::from(width) / (spec.max_m().y - spec.min_m().y)
}

/// Rings around the ego, and the ego.
pub(crate) fn mark_map(map: &mut RgbImage, labels: &Painted) {
    let spec = labels.spec;
    let (scale, max_m) = (scale_px_per_m(map.width(), spec), spec.max_m());
    let ego = At::new(max_m.y, max_m.x) * scale;
    let longest_m = f64::from(map.width().max(map.height())) / scale;
    let step_m = marks::ring_step_m(spec);
    let radii_m = (1..=MOST_RINGS).map(|ring| f64::from(ring) * step_m);
    for radius_m in radii_m.take_while(|radius_m| *radius_m < longest_m / 2.0) {
        marks::ring(map, ego, radius_m * scale, radius_m);
    }
    mark_ego(map, labels, 1.0);
}

/// The ego on a map, at a share of its usual size; nothing if nobody tells where it points.
pub(crate) fn mark_ego(map: &mut RgbImage, labels: &Painted, share: f64) {
    let (Some(heading_rad), spec) = (labels.heading_rad, labels.spec) else { return };
    let ego = At::new(spec.max_m().y, spec.max_m().x) * scale_px_per_m(map.width(), spec);
    let (sin, cos) = libm::sincos(heading_rad);
    // A turn to the left, in a picture whose y grows downwards.
    let turned = |x: f64, y: f64| Vector2::new(x * cos + y * sin, y * cos - x * sin);
    let corner = |x: f64, y: f64| ego + turned(x, y) * share;
    marks::ego(map, [corner(0.0, -13.0), corner(-8.5, 9.0), corner(0.0, 4.5), corner(8.5, 9.0)]);
}

/// The scale bar and the axes under a map.
fn mark_foot(
    picture: &mut RgbImage,
    labels: &Painted,
    (left, top): (u32, u32),
    (width, height): (u32, u32),
) {
    let scale = scale_px_per_m(width, labels.spec);
    let length_m = marks::round_length_m(f64::from(width) / scale / 6.0);
    let middle = f64::from(height + top) + f64::from(FOOT_PX) * 0.6;
    marks::scale_bar(picture, At::new(f64::from(left), middle), length_m * scale, length_m);
    if width > 300 {
        let right = At::new(f64::from(left + width), middle);
        marks::axes(picture, right, labels.heading_rad);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_voxel_is_under_a_pixel_and_every_pixel_over_a_voxel() {
        let mut tried = 0;
        for (n, pixels) in [(10, 10), (10, 25), (25, 10), (1, 7), (7, 1), (512, 160)] {
            let mut met = vec![false; n];
            for pixel in 0..pixels {
                let cells = cells(pixel, n, pixels);
                assert!(!cells.is_empty());
                cells.for_each(|at| met[at] = true);
                tried += 1;
            }
            assert!(met.iter().all(|met| *met), "{n} voxels, {pixels} pixels");
        }
        assert_eq!((tried, cells(0, 10, 10)), (213, 9..10));
    }
}
