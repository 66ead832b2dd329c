//! Text files of numbers, one record a line.

use std::path::Path;

use occlabel_core::Fault;

use crate::files::read_file;

/// The lines of a text file of the log, without empty ones at its end.
///
/// # Errors
/// If the file is absent or cannot be read.
pub(crate) fn read_lines(root: &Path, file: &str) -> Result<Vec<String>, Fault> {
    let bytes = read_file(root, file)?;
    // What is no UTF-8 is no number either, and is told as one.
    let text = String::from_utf8_lossy(&bytes);
    Ok(text.trim_end().lines().map(str::to_owned).collect())
}

/// The numbers of a line, separated by white space.
///
/// # Errors
/// What was found, if that is not N numbers, all finite.
pub(crate) fn numbers<const N: usize>(line: &str) -> Result<[f64; N], String> {
    list(line)?.try_into().map_err(|read: Vec<f64>| format!("{} numbers", read.len()))
}

/// All numbers of a line.
///
/// # Errors
/// What was found, if one is none, or not finite.
pub(crate) fn list(line: &str) -> Result<Vec<f64>, String> {
    line.split_whitespace().map(number).collect()
}

fn number(word: &str) -> Result<f64, String> {
    let finite = word.parse().ok().filter(|number: &f64| number.is_finite());
    finite.ok_or_else(|| format!("`{}`", word.chars().take(40).collect::<String>()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_holds_as_many_finite_numbers_as_asked() {
        assert_eq!(numbers::<3>(" 1 -2.5e1\t3 "), Ok([1.0, -25.0, 3.0]));
        assert_eq!(numbers::<3>("1 2"), Err("2 numbers".into()));
        assert_eq!(numbers::<2>("1 inf"), Err("`inf`".into()));
        assert_eq!(numbers::<2>("1 x"), Err("`x`".into()));
        assert_eq!(numbers::<1>(""), Err("0 numbers".into()));
    }
}
