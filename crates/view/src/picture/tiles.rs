//! Several small pictures on one.

use image::{RgbImage, imageops};

use crate::picture::canvas::At;
use crate::picture::color::FAINT_INK;
use crate::picture::font::{fitting, write};
use crate::picture::plate::blank;

const CAPTION_PX: u32 = 24;
const CAPTION_STEP_PX: f64 = 1.5;
const GAP_PX: u32 = 10;
/// Long rows are preferred to pictures that are larger by no more than this.
const GOOD_SHARE: f64 = 0.85;

/// Room for pictures of known proportions, row by row, with a caption above each.
pub(crate) struct Tiles {
    columns: u32,
    /// A tile with its caption and the gap after it.
    cell: (u32, u32),
    picture: RgbImage,
}

impl Tiles {
    /// The division of a room that leaves the pictures large; `aspects` are their widths by their
    /// heights.
    pub(crate) fn new(aspects: &[f64], room: (u32, u32)) -> Self {
        let count = (aspects.len() as u32).max(1);
        let area = |columns: &u32| -> u64 {
            let cell = cell(*columns, count, room);
            let area = |aspect: &f64| {
                let (width, height) = fit(*aspect, inner(cell));
                u64::from(width) * u64::from(height)
            };
            aspects.iter().map(area).sum()
        };
        let largest = (1..=count).map(|columns| area(&columns)).max().unwrap_or(0);
        let is_good = |columns: &u32| area(columns) as f64 >= GOOD_SHARE * largest as f64;
        let columns = (1..=count).rev().find(is_good).unwrap_or(1);
        let picture = blank(room.0, room.1);
        Self { columns, cell: cell(columns, count, room), picture }
    }

    /// How large a tile of these proportions is drawn: at least a pixel.
    pub(crate) fn size_px(&self, aspect: f64) -> (u32, u32) {
        fit(aspect, inner(self.cell))
    }

    /// Draws a tile in its place.
    pub(crate) fn put(&mut self, place: u32, tile: &RgbImage, caption: &str) {
        let (left, top) = self.corner(place, tile.dimensions());
        imageops::replace(&mut self.picture, tile, left.into(), top.into());
        let text = fitting(caption, CAPTION_STEP_PX, f64::from(tile.width()));
        let at = At::new(f64::from(left), f64::from(top) - 16.0);
        write(&mut self.picture, at, CAPTION_STEP_PX, FAINT_INK, &text);
    }

    /// Upper left corner of a tile.
    fn corner(&self, place: u32, (width, height): (u32, u32)) -> (u32, u32) {
        let (column, row) = (place % self.columns, place / self.columns);
        let (room_w, room_h) = inner(self.cell);
        let [right, down] = [room_w.saturating_sub(width), room_h.saturating_sub(height)];
        (GAP_PX + column * self.cell.0 + right / 2, CAPTION_PX + row * self.cell.1 + down / 2)
    }

    /// All that was drawn.
    pub(crate) fn into_picture(self) -> RgbImage {
        self.picture
    }
}

fn cell(columns: u32, count: u32, (width, height): (u32, u32)) -> (u32, u32) {
    (width.saturating_sub(GAP_PX) / columns, height / count.div_ceil(columns))
}

/// What a cell has for its picture.
fn inner((width, height): (u32, u32)) -> (u32, u32) {
    (width.saturating_sub(GAP_PX), height.saturating_sub(CAPTION_PX + GAP_PX))
}

/// The largest size of these proportions in a room, at least a pixel.
pub(crate) fn fit(aspect: f64, (width, height): (u32, u32)) -> (u32, u32) {
    let (room_w, room_h) = (f64::from(width), f64::from(height));
    let wide = room_w.min(room_h * aspect);
    ((wide as u32).max(1), ((wide / aspect + 1e-6) as u32).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_images_stand_in_two_rows_and_do_not_overlap() {
        let tiles = Tiles::new(&[16.0 / 9.0; 6], (1330, 856));
        assert_eq!(tiles.columns, 3);
        let (width, height) = tiles.size_px(16.0 / 9.0);
        assert!((430..440).contains(&width) && height == width * 9 / 16);
        let corners: Vec<_> = (0..6).map(|place| tiles.corner(place, (width, height))).collect();
        assert!(corners[1].0 >= corners[0].0 + width && corners[3].1 > corners[0].1 + height);
        assert!(corners.iter().all(|(x, y)| x + width <= 1330 && y + height <= 856));
    }

    #[test]
    fn no_room_is_no_fault() {
        let mut tiles = Tiles::new(&[1.0; 9], (5, 3));
        tiles.put(8, &RgbImage::new(1, 1), "a caption");
        assert_eq!(tiles.into_picture().dimensions(), (5, 3));
        assert_eq!(Tiles::new(&[], (0, 0)).into_picture().dimensions(), (0, 0));
    }
}
