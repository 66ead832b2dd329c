//! Letters of our own, so that no picture depends on what fonts a machine has.
//!
//! They are drawn as dots on a lattice of 5 x 9. Dots that touch are joined by round strokes, so a
//! letter is as smooth as the picture allows, at any size.
//!
//! ```text
//!   #..#         Dots side by side or above each other are joined, those at a slant only
//!   .##    ->    where no dot beside them makes the joint already.
//!   #..#
//! ```

use image::{Rgb, RgbImage};

use crate::picture::canvas::{At, Stroke, paint};

/// Rows from a capital's top to the line that letters stand on.
pub(crate) const CAPITAL_ROWS: f64 = 6.0;

const ROWS: usize = 9;
const COLUMNS: usize = 5;
/// Letters a line of the sheet.
const PER_LINE: usize = 13;
/// From one letter's last dots to the next one's first.
const GAP: f64 = 2.0;
/// How wide a space is.
const SPACE: f64 = 1.5;
/// Half a stroke's width.
const RADIUS: f64 = 0.42;

/// Writes a line of text, its first letter's upper left dot at `at`, dots `step_px` apart.
pub(crate) fn write(picture: &mut RgbImage, at: At, step_px: f64, color: Rgb<u8>, text: &str) {
    let mut left = at.x;
    for letter in text.chars() {
        let glyph = Glyph::of(letter);
        glyph.paint(picture, At::new(left, at.y), step_px, color);
        left += (glyph.width + GAP) * step_px;
    }
}

/// How wide a line of text is, first dot to last, pixels.
pub(crate) fn width_px(text: &str, step_px: f64) -> f64 {
    let steps: f64 = text.chars().map(|letter| Glyph::of(letter).width + GAP).sum();
    (steps - GAP).max(0.0) * step_px
}

/// A text as far as it fits, with dots where it was cut.
pub(crate) fn fitting(text: &str, step_px: f64, room_px: f64) -> String {
    let cut = |letters: usize| text.chars().take(letters).collect::<String>() + "..";
    let fits = |text: &String| width_px(text, step_px) <= room_px;
    let shorter = (0..text.chars().count()).rev().map(cut);
    std::iter::once(text.to_owned()).chain(shorter).find(fits).unwrap_or_default()
}

/// A letter's strokes in steps of the lattice, from its own upper left.
struct Glyph {
    strokes: Vec<Stroke>,
    width: f64,
}

impl Glyph {
    /// A letter as strokes; one that the sheet does not have is a question mark.
    fn of(letter: char) -> Self {
        let place = |letter| LETTERS.chars().position(|known| known == letter);
        let dots = dots(place(letter).or_else(|| place('?')).unwrap_or(0));
        let left = dots.iter().map(|&(x, _)| x).min().unwrap_or(0);
        let right = dots.iter().map(|&(x, _)| x).max();
        let at = |(x, y): (i32, i32)| At::new(f64::from(x - left), f64::from(y));
        let joints = joints(&dots);
        let strokes = joints.into_iter().map(|(a, b)| Stroke { from: at(a), to: at(b) }).collect();
        Self { strokes, width: right.map_or(SPACE, |right| f64::from(right - left)) }
    }

    fn paint(&self, picture: &mut RgbImage, at: At, step_px: f64, color: Rgb<u8>) {
        let reach = nalgebra::Vector2::repeat(RADIUS * step_px);
        let size = nalgebra::Vector2::new(self.width, ROWS as f64) * step_px;
        paint(picture, (at - reach, at + size + reach), color, 1.0, |p| {
            let p = At::from((p - at) / step_px);
            let nearest = self.strokes.iter().map(|stroke| stroke.distance(p));
            (nearest.fold(f64::INFINITY, f64::min) - RADIUS) * step_px
        });
    }
}

/// The dots of the letter at a place of the sheet: column, row.
fn dots(place: usize) -> Vec<(i32, i32)> {
    let (line, left) = (place / PER_LINE, place % PER_LINE * (COLUMNS + 1));
    let inked = |x: usize, y: usize| SHEET[line * ROWS + y].as_bytes()[left + x] == b'#';
    let all = (0..ROWS).flat_map(|y| (0..COLUMNS).map(move |x| (x, y)));
    all.filter(|&(x, y)| inked(x, y)).map(|(x, y)| (x as i32, y as i32)).collect()
}

/// Pairs of dots to be joined; a dot alone is joined with itself.
fn joints(dots: &[(i32, i32)]) -> Vec<((i32, i32), (i32, i32))> {
    let has = |x, y| dots.contains(&(x, y));
    let ways = [(0, 0), (1, 0), (0, 1), (1, 1), (-1, 1)];
    let all = dots.iter().flat_map(|&dot| ways.map(|way| (dot, way)));
    all.filter(|&((x, y), (dx, dy))| {
        let bridged = dx != 0 && dy != 0 && (has(x + dx, y) || has(x, y + dy));
        has(x + dx, y + dy) && !bridged
    })
    .map(|((x, y), (dx, dy))| ((x, y), (x + dx, y + dy)))
    .collect()
}

const LETTERS: &str = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.,:/()+%? ";
const SHEET: [&str; 54] = [
    // a     b     c     d     e     f     g     h     i     j     k     l     m
    "      #              #          ##        #      #      #   #      #         ",
    "      #              #         #          #                 #      #         ",
    " ##   ###    ###   ###   ##   ###    ###  ###    #      #   #  #   #    #### ",
    "   #  #  #  #     #  #  #  #   #    #  #  #  #   #      #   # #    #    # # #",
    " ###  #  #  #     #  #  ####   #    #  #  #  #   #      #   ##     #    # # #",
    "#  #  #  #  #     #  #  #      #    #  #  #  #   #      #   # #    #    # # #",
    " ###  ###    ###   ###   ###   #     ###  #  #   #      #   #  #   ##   # # #",
    "                                       #                #                    ",
    "                                     ##               ##                     ",
    // n     o     p     q     r     s     t     u     v     w     x     y     z
    "                                     #                                       ",
    "                                     #                                       ",
    "###    ##   ###    ###  # ##   ###  ###   #  #  #   # #   # #  #  #  #  #### ",
    "#  #  #  #  #  #  #  #  ##    #      #    #  #  #   # # # # #  #  #  #    #  ",
    "#  #  #  #  #  #  #  #  #      ##    #    #  #  #   # # # #  ##   #  #   #   ",
    "#  #  #  #  #  #  #  #  #        #   #    #  #   # #  # # # #  #  #  #  #    ",
    "#  #   ##   ###    ###  #     ###     ##   ###    #    # #  #  #   ###  #### ",
    "            #        #                                               #       ",
    "            #        #                                             ##        ",
    // A     B     C     D     E     F     G     H     I     J     K     L     M
    " ##   ###    ###  ###   ####  ####   ###  #  #  #        #  #  #  #     #   #",
    "#  #  #  #  #     #  #  #     #     #     #  #  #        #  #  #  #     ## ##",
    "#  #  #  #  #     #  #  #     #     #     #  #  #        #  # #   #     # # #",
    "####  ###   #     #  #  ###   ###   # ##  ####  #        #  ##    #     # # #",
    "#  #  #  #  #     #  #  #     #     #  #  #  #  #        #  # #   #     #   #",
    "#  #  #  #  #     #  #  #     #     #  #  #  #  #     #  #  #  #  #     #   #",
    "#  #  ###    ###  ###   ####  #      ###  #  #  #      ##   #  #  ####  #   #",
    "                                                                             ",
    "                                                                             ",
    // N     O     P     Q     R     S     T     U     V     W     X     Y     Z
    "#  #   ##   ###    ##   ###    ###  ##### #  #  #   # #   # #  #  #   # #### ",
    "## #  #  #  #  #  #  #  #  #  #       #   #  #  #   # #   # #  #  #   #    # ",
    "# ##  #  #  #  #  #  #  #  #  #       #   #  #  #   # #   # #  #   # #    #  ",
    "#  #  #  #  ###   #  #  ###    ##     #   #  #  #   # # # #  ##     #     #  ",
    "#  #  #  #  #     #  #  # #      #    #   #  #  #   # # # # #  #    #    #   ",
    "#  #  #  #  #      ##   #  #     #    #   #  #   # #  # # # #  #    #   #    ",
    "#  #   ##   #        #  #  #  ###     #    ##     #    # #  #  #    #   #### ",
    "                                                                             ",
    "                                                                             ",
    // 0     1     2     3     4     5     6     7     8     9     _     -     .
    " ##    #     ##    ##   #  #  ####   ##   ####   ##    ##                    ",
    "#  #  ##    #  #  #  #  #  #  #     #        #  #  #  #  #                   ",
    "#  #   #       #     #  #  #  ###   #       #   #  #  #  #                   ",
    "#  #   #      #    ##   ####     #  ###     #    ##    ###        ###        ",
    "#  #   #     #       #     #     #  #  #   #    #  #     #                   ",
    "#  #   #    #     #  #     #  #  #  #  #   #    #  #     #                   ",
    " ##    #    ####   ##      #   ##    ##    #     ##    ##               #    ",
    "                                                            ####             ",
    "                                                                             ",
    // ,     :     /     (     )     +     %     ?
    "               #   #    #           #   #  ##                                ",
    "               #  #      #          #  #  #  #                               ",
    "      #       #   #      #      #      #     #                               ",
    "              #   #      #      #     #     #                                ",
    "             #    #      #    #####  #     #                                 ",
    "            #     #      #      #    #  #                                    ",
    " #    #     #      #    #       #   #   #  #                                 ",
    "#                                                                            ",
    "                                                                             ",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sheet_has_room_for_every_letter_and_no_letter_is_empty_but_the_space() {
        assert!(SHEET.iter().all(|row| row.len() == PER_LINE * (COLUMNS + 1) - 1));
        let empty: Vec<_> = LETTERS.chars().filter(|c| Glyph::of(*c).strokes.is_empty()).collect();
        assert_eq!(empty, [' ']);
        assert_eq!(LETTERS.chars().count().div_ceil(PER_LINE) * ROWS, SHEET.len());
    }

    #[test]
    fn no_two_letters_look_alike() {
        let all: Vec<_> = LETTERS.chars().collect();
        let mut pairs = 0;
        for a in 0..all.len() {
            for b in 0..a {
                // The zero is the letter, as in many a fine font.
                assert!(
                    dots(a) != dots(b) || [all[a], all[b]] == ['0', 'O'],
                    "{} {}",
                    all[a],
                    all[b]
                );
                pairs += 1;
            }
        }
        assert_eq!(pairs, all.len() * (all.len() - 1) / 2);
    }

    #[test]
    fn a_letter_is_joined_from_its_dots() {
        let dash = Glyph::of('-').strokes;
        assert_eq!(dash.len(), 3 + 2, "three dots, two joints");
        assert_eq!(Glyph::of('\u{e9}').strokes, Glyph::of('?').strokes);
        assert_eq!(width_px("--", 2.0), 2.0 * (2.0 + GAP + 2.0));
    }

    #[test]
    fn a_text_stays_within_its_width() {
        let mut picture = RgbImage::new(60, 24);
        write(&mut picture, At::new(4.0, 4.0), 2.0, Rgb([255; 3]), "fig");
        let inked = picture.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[0] > 64);
        let columns: Vec<u32> = inked.map(|(x, _, _)| x).collect();
        let (first, last) = (columns.iter().min().unwrap(), columns.iter().max().unwrap());
        assert!(*first >= 3 && f64::from(*last) <= 4.0 + width_px("fig", 2.0) + 1.0);
    }
}
