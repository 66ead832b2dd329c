//! Smooth shapes on a picture.
//!
//! Every shape is its signed distance: how many pixels a point lies outside (above 0) or inside
//! (below 0) of it. A pixel is covered by half a pixel less that distance.
//!
//! ```text
//!   (0, 0) +------> x     pixel (i, j) covers [i, i + 1) x [j, j + 1)
//!          |
//!          v y
//! ```

use image::{Rgb, RgbImage};
use nalgebra::Point2;

use crate::picture::color::mix;

/// A point of the picture, pixels.
pub(crate) type At = Point2<f64>;

/// A straight stroke with round ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) from: At,
    pub(crate) to: At,
}

impl Stroke {
    /// How far a point lies from the stroke's middle line.
    pub(crate) fn distance(&self, p: At) -> f64 {
        let (way, off) = (self.to - self.from, p - self.from);
        let length_2 = way.norm_squared();
        let share = if length_2 > 0.0 { (off.dot(&way) / length_2).clamp(0.0, 1.0) } else { 0.0 };
        (off - way * share).norm()
    }
}

/// Paints a shape, of which nothing reaches out of the box from `low` to `high`.
pub(crate) fn paint(
    picture: &mut RgbImage,
    (low, high): (At, At),
    color: Rgb<u8>,
    opacity: f64,
    distance_px: impl Fn(At) -> f64,
) {
    let (width, height) = picture.dimensions();
    let start = |low: f64| (low - 1.0).max(0.0) as u32;
    let end = |high: f64, limit: u32| ((high + 2.0).max(0.0) as u32).min(limit);
    for y in start(low.y)..end(high.y, height) {
        for x in start(low.x)..end(high.x, width) {
            let middle = At::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let coverage = (0.5 - distance_px(middle)).clamp(0.0, 1.0);
            if coverage > 0.0 {
                let pixel = picture.get_pixel_mut(x, y);
                *pixel = mix(*pixel, color, coverage * opacity);
            }
        }
    }
}

/// Paints a stroke of a width.
pub(crate) fn line(picture: &mut RgbImage, stroke: Stroke, width_px: f64, color: Rgb<u8>) {
    let reach = nalgebra::Vector2::repeat(width_px / 2.0);
    let low = stroke.from.inf(&stroke.to) - reach;
    let high = stroke.from.sup(&stroke.to) + reach;
    paint(picture, (low, high), color, 1.0, |p| stroke.distance(p) - width_px / 2.0);
}

/// Paints a convex polygon whose corners go clockwise on the picture, grown by `grow_px`.
pub(crate) fn polygon(picture: &mut RgbImage, corners: &[At], grow_px: f64, color: Rgb<u8>) {
    let Some(&first) = corners.first() else { return };
    let reach = nalgebra::Vector2::repeat(grow_px);
    let low = corners.iter().fold(first, |low, p| low.inf(p)) - reach;
    let high = corners.iter().fold(first, |high, p| high.sup(p)) + reach;
    paint(picture, (low, high), color, 1.0, |p| outside(corners, p) - grow_px);
}

/// How far a point lies outside of the nearest edge's line of a convex polygon.
fn outside(corners: &[At], p: At) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let edges = corners.iter().zip(next).map(|(a, b)| {
        let edge = b - a;
        edge.perp(&(a - p)) / edge.norm()
    });
    edges.fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb<u8> = Rgb([255, 0, 0]);

    #[test]
    fn a_square_covers_its_pixels_wholly_and_a_half_pixel_by_half() {
        let mut picture = RgbImage::new(8, 8);
        let corners = [(2.0, 2.0), (5.5, 2.0), (5.5, 6.0), (2.0, 6.0)].map(|(x, y)| At::new(x, y));
        polygon(&mut picture, &corners, 0.0, RED);
        let row: Vec<u8> = (0..8).map(|x| picture.get_pixel(x, 4).0[0]).collect();
        assert_eq!(row, [0, 0, 255, 255, 255, 128, 0, 0]);
        let column: Vec<u8> = (0..8).map(|y| picture.get_pixel(3, y).0[0]).collect();
        assert_eq!(column, [0, 0, 255, 255, 255, 255, 0, 0]);
    }

    #[test]
    fn a_shape_may_reach_out_of_the_picture() {
        let mut picture = RgbImage::new(4, 4);
        let stroke = Stroke { from: At::new(-50.0, 2.0), to: At::new(50.0, 2.0) };
        line(&mut picture, stroke, 2.0, RED);
        let column: Vec<u8> = (0..4).map(|y| picture.get_pixel(1, y).0[0]).collect();
        assert_eq!(column, [0, 255, 255, 0]);
    }
}
