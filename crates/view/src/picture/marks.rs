//! The marks that tell where and how large: rings, the ego, a scale bar, the axes.

use image::RgbImage;
use nalgebra::Vector2;
use occlabel_core::GridSpec;

use crate::picture::canvas::{At, Stroke, line, paint, polygon};
use crate::picture::color::{FAINT_INK, INK, PAPER};
use crate::picture::font::{CAPITAL_ROWS, width_px, write};

const STEP_PX: f64 = 1.5;
const LINE_PX: f64 = 1.8;

/// The largest of 1, 2, 5, 10, 20, 50 ... (and 0.5, 0.2, 0.1 ...) metres that is not above a length.
pub(crate) fn round_length_m(limit_m: f64) -> f64 {
    let powers = (-3..7).map(|power| libm::exp10(f64::from(power)));
    let lengths = powers.flat_map(|ten| [1.0, 2.0, 5.0].map(|digit| digit * ten));
    lengths.take_while(|length| *length <= limit_m).last().unwrap_or(1e-3)
}

/// From one ring around the ego to the next.
pub(crate) fn ring_step_m(spec: &GridSpec) -> f64 {
    let extent_m = spec.max_m() - spec.min_m();
    round_length_m(extent_m.x.max(extent_m.y) / 8.0)
}

/// A length as a text, to the millimetre.
fn metres(length_m: f64) -> String {
    format!("{} m", (length_m * 1000.0).round() / 1000.0)
}

/// A ring around a place, with its radius written where it is highest.
pub(crate) fn ring(picture: &mut RgbImage, middle: At, radius_px: f64, radius_m: f64) {
    let reach = Vector2::repeat(radius_px + 1.0);
    paint(picture, (middle - reach, middle + reach), INK, 0.3, |p| {
        ((p - middle).norm() - radius_px).abs() - 0.6
    });
    let text = metres(radius_m);
    let at = At::new(middle.x + 6.0, middle.y - radius_px + 6.0);
    for (dx, dy) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        write(picture, at + Vector2::new(dx, dy), STEP_PX, PAPER, &text);
    }
    write(picture, at, STEP_PX, INK, &text);
}

/// The ego as a dart of two halves: its nose, left tip, notch, right tip.
pub(crate) fn ego(picture: &mut RgbImage, [nose, left, notch, right]: [At; 4]) {
    for (grow_px, color) in [(2.5, PAPER), (0.6, INK)] {
        polygon(picture, &clockwise([nose, left, notch]), grow_px, color);
        polygon(picture, &clockwise([nose, notch, right]), grow_px, color);
    }
}

/// The corners of a triangle in clockwise order.
fn clockwise([a, b, c]: [At; 3]) -> [At; 3] {
    if (b - a).perp(&(c - a)) > 0.0 { [a, b, c] } else { [a, c, b] }
}

/// A bar of a length with its text, its left end at a place.
pub(crate) fn scale_bar(picture: &mut RgbImage, at: At, length_px: f64, length_m: f64) {
    let end = at + Vector2::new(length_px, 0.0);
    line(picture, Stroke { from: at, to: end }, LINE_PX, INK);
    for side in [at, end] {
        let tick = Vector2::new(0.0, 4.0);
        line(picture, Stroke { from: side - tick, to: side + tick }, LINE_PX, INK);
    }
    let top = at.y - CAPITAL_ROWS / 2.0 * STEP_PX;
    write(picture, At::new(end.x + 10.0, top), STEP_PX, INK, &metres(length_m));
}

/// Where the ego's forward is so near to x, x is called forward.
const AHEAD_RAD: f64 = 0.1;

/// The ways in which x and y grow: up and to the left; the texts' right end at a place.
pub(crate) fn axes(picture: &mut RgbImage, right: At, heading_rad: Option<f64>) {
    let is_ahead = heading_rad.is_some_and(|heading_rad| heading_rad.abs() < AHEAD_RAD);
    let [x_text, y_text] = if is_ahead { ["x forward", "y left"] } else { ["x", "y"] };
    let mut x = right.x;
    for (way, text) in [(Vector2::new(-1.0, 0.0), y_text), (Vector2::new(0.0, -1.0), x_text)] {
        x -= width_px(text, STEP_PX);
        let top = right.y - CAPITAL_ROWS / 2.0 * STEP_PX;
        write(picture, At::new(x, top), STEP_PX, FAINT_INK, text);
        arrow(picture, At::new(x - 16.0, right.y), way);
        x -= 46.0;
    }
}

/// A small arrow through a place, along a unit vector.
fn arrow(picture: &mut RgbImage, middle: At, way: Vector2<f64>) {
    let (tip, side) = (middle + way * 7.0, Vector2::new(-way.y, way.x));
    line(picture, Stroke { from: middle - way * 7.0, to: tip }, LINE_PX, FAINT_INK);
    for side in [side, -side] {
        let barb = tip - way * 4.5 + side * 4.0;
        line(picture, Stroke { from: tip, to: barb }, LINE_PX, FAINT_INK);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_reads_as_one_would_write_it() {
        assert_eq!([metres(3.0 * 0.1), metres(40.0), metres(0.002)], ["0.3 m", "40 m", "0.002 m"]);
    }

    #[test]
    fn a_round_length_is_the_largest_that_fits() {
        let lengths =
            [(0.03, 0.02), (0.99, 0.5), (1.0, 1.0), (9.9, 5.0), (10.0, 10.0), (64.0, 50.0)];
        for (limit, length) in lengths {
            assert!((round_length_m(limit) - length).abs() < 1e-12, "{limit}: {length}");
        }
    }
}
