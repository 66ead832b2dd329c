//! Which colour means what.

use image::{Rgb, RgbImage};
use occlabel_core::Palette;

use crate::picture::canvas::{At, polygon};
use crate::picture::color::{FAINT_INK, INK, mix};
use crate::picture::font::{CAPITAL_ROWS, fitting as fitting_text, width_px, write};
use crate::picture::painted::{Painted, hidden};

const STEP_PX: f64 = 1.75;
const ROW_PX: f64 = 27.0;
const SWATCH_PX: f64 = 15.0;
const GAP_PX: f64 = 11.0;

/// Swatches with their texts, from top to bottom.
#[derive(Default)]
pub(crate) struct Legend {
    entries: Vec<(Rgb<u8>, String)>,
}

impl Legend {
    /// The classes that occur in the labels.
    pub(crate) fn of(labels: &Painted) -> Self {
        Self::default().with_classes(labels.palette, &labels.present())
    }

    /// The legend with these classes.
    pub(crate) fn with_classes(self, palette: &Palette, classes: &[u8]) -> Self {
        let with = |legend: Self, &id: &u8| legend.with(Rgb(palette.color(id)), &palette.label(id));
        classes.iter().fold(self, with)
    }

    /// The legend with one entry more.
    pub(crate) fn with(mut self, color: Rgb<u8>, text: &str) -> Self {
        self.entries.push((color, text.to_owned()));
        self
    }

    /// The legend with what dull colours mean.
    pub(crate) fn with_hidden(self) -> Self {
        self.with(hidden(INK), "dull: no camera sees it")
    }

    /// How wide it is, pixels.
    pub(crate) fn width_px(&self) -> f64 {
        let texts = self.entries.iter().map(|(_, text)| width_px(text, STEP_PX));
        SWATCH_PX + GAP_PX + texts.fold(0.0, f64::max)
    }

    /// How high it is, pixels.
    pub(crate) fn height_px(&self) -> f64 {
        self.entries.len() as f64 * ROW_PX
    }

    /// Draws it with its upper left corner at a place.
    pub(crate) fn draw(&self, picture: &mut RgbImage, at: At) {
        self.draw_within(picture, at, f64::INFINITY);
    }

    /// Draws it in no more than a height: with less between the rows if it needs be, and then with how
    /// many there are more in place of the last of them.
    pub(crate) fn draw_within(&self, picture: &mut RgbImage, at: At, height_px: f64) {
        let row_px = (height_px / self.entries.len().max(1) as f64).clamp(SWATCH_PX + 2.0, ROW_PX);
        let fitting = (height_px / row_px) as usize;
        let all = self.entries.len();
        let told = if fitting < all { fitting.saturating_sub(1) } else { all };
        let write_row = |picture: &mut RgbImage, row: usize, text: &str| {
            let middle = at.y + (row as f64 + 0.5) * row_px;
            let left = At::new(at.x + SWATCH_PX + GAP_PX, middle - CAPITAL_ROWS / 2.0 * STEP_PX);
            let room_px = f64::from(picture.width()) - left.x - 2.0;
            write(picture, left, STEP_PX, INK, &fitting_text(text, STEP_PX, room_px));
            At::new(at.x, middle)
        };
        for (row, (color, text)) in self.entries.iter().enumerate().take(told) {
            let left = write_row(picture, row, text);
            swatch(picture, left, *color);
        }
        if told < fitting && told < all {
            write_row(picture, told, &format!("and {} more", all - told));
        }
    }
}

/// A square with round corners and a rim that tells it from the ground, its left side's middle at a place.
fn swatch(picture: &mut RgbImage, left: At, color: Rgb<u8>) {
    const ROUND_PX: f64 = 3.0;
    let (near, far, half) = (left.x + ROUND_PX, left.x + SWATCH_PX - ROUND_PX, SWATCH_PX / 2.0);
    let (top, bottom) = (left.y - half + ROUND_PX, left.y + half - ROUND_PX);
    let corners = [(near, top), (far, top), (far, bottom), (near, bottom)];
    let corners = corners.map(|(x, y)| At::new(x, y));
    polygon(picture, &corners, ROUND_PX, mix(color, FAINT_INK, 0.5));
    polygon(picture, &corners, ROUND_PX - 1.0, color);
}
