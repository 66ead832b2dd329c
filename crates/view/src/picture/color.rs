//! Colours, and the few that belong to no class.

use image::Rgb;

/// Behind everything.
pub(crate) const PAPER: Rgb<u8> = Rgb([27, 31, 38]);
/// The sky's upper end in a perspective picture.
pub(crate) const SKY: Rgb<u8> = Rgb([52, 60, 74]);
/// The floor under the grid, where nothing is known to stand.
pub(crate) const FLOOR: Rgb<u8> = Rgb([50, 56, 67]);
/// Columns that no ray reached.
pub(crate) const UNOBSERVED: Rgb<u8> = Rgb([14, 16, 20]);
/// Columns that rays crossed and nothing stopped.
pub(crate) const FREE: Rgb<u8> = Rgb([88, 97, 112]);
/// Where the file itself says that it has no label.
pub(crate) const UNLABELLED: Rgb<u8> = Rgb([74, 62, 44]);
/// What no camera sees is mixed with this.
pub(crate) const HIDDEN: Rgb<u8> = Rgb([54, 60, 71]);
/// Letters, bars, the ego's mark.
pub(crate) const INK: Rgb<u8> = Rgb([232, 236, 242]);
/// Lesser letters and lines.
pub(crate) const FAINT_INK: Rgb<u8> = Rgb([150, 160, 175]);

/// `a` with a share (0 to 1) of `b` in it.
pub(crate) fn mix(a: Rgb<u8>, b: Rgb<u8>, share: f64) -> Rgb<u8> {
    let channel = |i: usize| f64::from(a.0[i]) * (1.0 - share) + f64::from(b.0[i]) * share;
    Rgb([channel(0), channel(1), channel(2)].map(byte))
}

/// A colour under a light: 0 is black, 1 leaves it, above 1 is nearer to white.
pub(crate) fn lit(color: Rgb<u8>, light: f64) -> Rgb<u8> {
    if light > 1.0 {
        mix(color, Rgb([255; 3]), light - 1.0)
    } else {
        Rgb(color.0.map(|channel| byte(f64::from(channel) * light)))
    }
}

/// The nearest byte.
pub(crate) fn byte(channel: f64) -> u8 {
    (channel + 0.5) as u8
}
