//! Numbers and findings in words.

use super::run::Run;
use super::strays::{Share, Stray};

/// 0 to 1 as per cent, with as many digits as tell small shares apart.
pub(crate) fn percent(share: f64) -> String {
    match share * 100.0 {
        0.0 => "0\u{a0}%".to_owned(),
        p if p < 0.01 => "<\u{a0}0.01\u{a0}%".to_owned(),
        p if p < 10.0 => format!("{p:.2}\u{a0}%"),
        p => format!("{p:.1}\u{a0}%"),
    }
}

/// A part of a whole as per cent; a dash where there is no whole.
pub(crate) fn part(count: u64, all: u64) -> String {
    if all == 0 { "–".to_owned() } else { percent(count as f64 / all as f64) }
}

/// A count with its thousands apart.
pub(crate) fn count(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Seconds as people say them.
pub(crate) fn seconds(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.2} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.1} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// What strays, by how much, and from what.
pub(crate) fn stray(stray: &Stray, rest: &str, run: &Run) -> String {
    let Stray { share, value, usual, times } = *stray;
    let (what, of) = match share {
        Share::Occupied => ("Occupied".to_owned(), "of all voxels"),
        Share::Free => ("Free".to_owned(), "of all voxels"),
        Share::Unobserved => ("Unobserved".to_owned(), "of all voxels"),
        Share::SeenByCameras => ("Visible to cameras".to_owned(), "of all voxels"),
        Share::Class(class) => (class_name(run, class), "of the occupied voxels"),
    };
    let far = if times < 100.0 { format!("{times:.0}") } else { "over 100".to_owned() };
    let (value, usual) = (percent(value), percent(usual));
    format!("{what}: {value} {of}; usual {rest}: {usual} ({far} times the usual spread away).")
}

/// A class by its index.
pub(crate) fn class_name(run: &Run, class: usize) -> String {
    run.classes.get(class).map_or_else(|| format!("class {class}"), |class| class.name.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        let told = [0.0, 1e-6, 0.0123, 0.5].map(|share| percent(share).replace('\u{a0}', " "));
        assert_eq!(told, ["0 %", "< 0.01 %", "1.23 %", "50.0 %"]);
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!((count(0), count(999)), ("0".into(), "999".into()));
        let told = [0.25, 75.0, 600.0, 36_000.0].map(seconds);
        assert_eq!(told, ["0.25 s", "75 s", "10.0 min", "10.0 h"]);
    }
}
