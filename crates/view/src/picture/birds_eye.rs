//! Labels from above.
//!
//! ```text
//!            x forward                  left of the ego is left in the picture
//!               ^
//!   y left <----+      row 0 = greatest x, column 0 = greatest y
//! ```

use image::{Rgb, RgbImage, imageops};
use nalgebra::Vector2;
use rayon::prelude::*;

use crate::picture::canvas::At;
use crate::picture::color::{FREE, PAPER, UNOBSERVED, lit};
use crate::picture::column::{Column, columns};
use crate::picture::legend::Legend;
use crate::picture::marks;
use crate::picture::painted::{Painted, hidden};

const MARGIN_PX: u32 = 28;
const FOOT_PX: u32 = 46;
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
    let mut map = map(labels, view);
    mark_map(&mut map, labels);
    let legend = legend(labels);
    let legend_left = f64::from(2 * MARGIN_PX + map.width());
    let foot = map.height() + 2 * MARGIN_PX + FOOT_PX;
    let height = foot.max(legend.height_px() as u32 + 2 * MARGIN_PX);
    let width = legend_left + legend.width_px() + f64::from(MARGIN_PX);
    let mut picture = RgbImage::from_pixel(width as u32, height, PAPER);
    imageops::replace(&mut picture, &map, MARGIN_PX.into(), MARGIN_PX.into());
    legend.draw(&mut picture, At::new(legend_left, f64::from(MARGIN_PX)));
    mark_foot(&mut picture, labels, &map);
    picture
}

fn legend(labels: &Painted) -> Legend {
    let legend = Legend::of(labels).with(FREE, "free").with(UNOBSERVED, "unobserved");
    if labels.has_cameras() { legend.with_hidden() } else { legend }
}

/// The map alone.
fn map(labels: &Painted, view: &BirdsEye) -> RgbImage {
    let [nx, ny, nz] = labels.spec.shape();
    let (width, height) = map_size(labels, view.map_px);
    let columns = columns(labels);
    let place = |pixel: u32, n: usize, pixels: u32| {
        n - 1 - (u64::from(pixel) * n as u64 / u64::from(pixels)) as usize
    };
    let row = |row: u32| -> Vec<u8> {
        let x = place(row, nx, height);
        let pixel = |at: u32| {
            let y = place(at, ny, width);
            let ahead_left = (x + 1).min(nx - 1) * ny + (y + 1).min(ny - 1);
            color(labels, columns[x * ny + y], columns[ahead_left], nz).0
        };
        (0..width).flat_map(pixel).collect()
    };
    let rows: Vec<_> = (0..height).into_par_iter().map(row).collect();
    RgbImage::from_vec(width, height, rows.concat()).expect("three bytes a pixel")
}

/// Width and height of the map, pixels.
fn map_size(labels: &Painted, map_px: u32) -> (u32, u32) {
    let extent_m = labels.spec.max_m() - labels.spec.min_m();
    let longest_m = extent_m.x.max(extent_m.y);
    let pixels = |side_m: f64| ((side_m / longest_m * f64::from(map_px)).round() as u32).max(1);
    (pixels(extent_m.y), pixels(extent_m.x))
}

/// The colour of a column, beside that from where the light comes.
pub(super) fn color(labels: &Painted, column: Column, ahead_left: Column, nz: usize) -> Rgb<u8> {
    match column {
        Column::Unobserved => UNOBSERVED,
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

/// Pixels a metre of a map.
fn scale_px_per_m(map: &RgbImage, labels: &Painted) -> f64 {
    f64::from(map.width()) / (labels.spec.max_m().y - labels.spec.min_m().y)
}

/// Rings around the ego, and the ego.
fn mark_map(map: &mut RgbImage, labels: &Painted) {
    let (scale, max_m) = (scale_px_per_m(map, labels), labels.spec.max_m());
    let ego = At::new(max_m.y, max_m.x) * scale;
    let longest_m = f64::from(map.width().max(map.height())) / scale;
    let step_m = marks::ring_step_m(labels.spec);
    let radii_m = (1..=MOST_RINGS).map(|ring| f64::from(ring) * step_m);
    for radius_m in radii_m.take_while(|radius_m| *radius_m < longest_m / 2.0) {
        marks::ring(map, ego, radius_m * scale, radius_m);
    }
    let corner = |x: f64, y: f64| ego + Vector2::new(x, y);
    marks::ego(map, [corner(0.0, -13.0), corner(-8.5, 9.0), corner(0.0, 4.5), corner(8.5, 9.0)]);
}

/// The scale bar and the axes under the map.
fn mark_foot(picture: &mut RgbImage, labels: &Painted, map: &RgbImage) {
    let scale = scale_px_per_m(map, labels);
    let length_m = marks::round_length_m(f64::from(map.width()) / scale / 6.0);
    let (left, right) = (f64::from(MARGIN_PX), f64::from(MARGIN_PX + map.width()));
    let middle = f64::from(map.height() + MARGIN_PX) + f64::from(FOOT_PX) * 0.6;
    marks::scale_bar(picture, At::new(left, middle), length_m * scale, length_m);
    marks::axes(picture, At::new(right, middle));
}
