//! A picture's frame: a title above, a legend at the right, and between them what it shows.

use image::{Rgb, RgbImage, imageops};

use crate::picture::canvas::At;
use crate::picture::color::{INK, PAPER, SKY, mix};
use crate::picture::font::{fitting, write};
use crate::picture::legend::Legend;

const TITLE_PX: u32 = 44;
const TITLE_STEP_PX: f64 = 1.9;
/// The strip that the legend takes at the right of a picture.
const LEGEND_PX: u32 = 270;
const LEFT_PX: u32 = 28;

/// A picture's size and title. Each kind of picture is one of its methods, and fills it.
///
/// Plates too low for a title have none, those too narrow for a legend neither.
#[derive(Clone, Copy, Debug)]
pub struct Plate<'a> {
    /// Columns of the picture, pixels.
    pub width: u32,
    /// Rows of the picture, pixels.
    pub height: u32,
    /// What is shown: the line above.
    pub title: &'a str,
}

impl Plate<'_> {
    /// Width and height of what is shown, without title and legend.
    pub fn body_px(&self) -> (u32, u32) {
        (body_width_px(self.width), self.height - self.title_px())
    }

    fn title_px(&self) -> u32 {
        if self.title.is_empty() || self.height < 5 * TITLE_PX { 0 } else { TITLE_PX }
    }

    /// The picture of a body, which has the size that [`Self::body_px`] says.
    pub(crate) fn around(&self, body: &RgbImage, legend: &Legend) -> RgbImage {
        let top = self.title_px();
        let behind = |y: u32| backdrop(y.saturating_sub(top), body.height());
        let mut picture = RgbImage::from_fn(self.width, self.height, |_, y| behind(y));
        imageops::replace(&mut picture, body, 0, top.into());
        if top > 0 {
            let room_px = f64::from(self.width - (2 * LEFT_PX).min(self.width));
            let title = fitting(self.title, TITLE_STEP_PX, room_px);
            let at = At::new(f64::from(LEFT_PX), f64::from(top) * 0.4);
            write(&mut picture, at, TITLE_STEP_PX, INK, &title);
        }
        if body.width() < self.width {
            let at = At::new(f64::from(body.width()) + 10.0, f64::from(top.max(14)));
            legend.draw_within(&mut picture, at, f64::from(self.height) - at.y - 8.0);
        }
        picture
    }
}

/// A picture with nothing on it.
pub(crate) fn blank(width: u32, height: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |_, y| backdrop(y, height))
}

/// What is behind everything, by the row.
fn backdrop(y: u32, height: u32) -> Rgb<u8> {
    mix(SKY, PAPER, f64::from(y) / f64::from(height))
}

/// How much of a picture's width is left beside the legend.
pub(crate) fn body_width_px(width: u32) -> u32 {
    if width > 2 * LEGEND_PX { width - LEGEND_PX } else { width }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_pages_give_all_their_room_to_the_body() {
        let plate = |width, height| Plate { width, height, title: "a" };
        assert_eq!(plate(1600, 900).body_px(), (1330, 856));
        assert_eq!(plate(540, 900).body_px(), (540, 856));
        assert_eq!(plate(1600, 100).body_px(), (1330, 100));
        assert_eq!(Plate { width: 0, height: 0, title: "" }.body_px(), (0, 0));
    }
}
