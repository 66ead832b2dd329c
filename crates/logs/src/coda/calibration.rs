//! Calibrations: of YAML, the little that ROS and OpenCV write into them.
//!
//! ```text
//! image_width: 1224                a number or a word of a name
//! camera_matrix:                   or a matrix: what is further in, up to the next name
//!   rows: 3
//!   cols: 3
//!   data: [ 730.3, 0, 610.9,       all its numbers, in brackets or behind dashes
//!           0, 729.7, 537.5, 0, 0, 1 ]
//! ```

use std::path::Path;

use occlabel_core::{Fault, Pose};

use crate::number_rows::{list, numbers, read_lines};
use crate::transform::pose_from_matrix;

/// The names and values of a calibration.
#[derive(Debug)]
pub(super) struct Calibration {
    file: String,
    lines: Vec<String>,
}

impl Calibration {
    /// Reads a calibration.
    ///
    /// # Errors
    /// If the file is absent or cannot be read.
    pub(super) fn read(root: &Path, file: String) -> Result<Self, Fault> {
        let lines = read_lines(root, &file)?.into_iter().map(uncommented).collect();
        Ok(Self { file, lines })
    }

    /// The word of a name, if there is one.
    pub(super) fn word(&self, name: &str) -> Option<&str> {
        self.lines.iter().find_map(|line| value(line, name))
    }

    /// The number of a name.
    ///
    /// # Errors
    /// If there is none.
    pub(super) fn number(&self, name: &str) -> Result<f64, Fault> {
        let number = numbers(self.word(name).unwrap_or_default());
        number.map(|[number]: [f64; 1]| number).map_err(|found| self.fault(name, "a number", found))
    }

    /// All numbers of a matrix, rows first.
    ///
    /// # Errors
    /// If there is no such matrix, or one of its numbers is none.
    pub(super) fn matrix(&self, name: &str) -> Result<Vec<f64>, Fault> {
        list(&self.data(name)).map_err(|found| self.fault(name, "a matrix of numbers", found))
    }

    /// A matrix of so many numbers.
    ///
    /// # Errors
    /// If it is none.
    pub(super) fn matrix_of<const N: usize>(&self, name: &str) -> Result<[f64; N], Fault> {
        let count = |numbers: Vec<f64>| format!("{} numbers", numbers.len());
        let of = |numbers: Vec<f64>| numbers.try_into().map_err(count);
        let expected = format!("a matrix of {N} numbers");
        of(self.matrix(name)?).map_err(|found| self.fault(name, &expected, found))
    }

    /// The pose of a rigid transform's matrix.
    ///
    /// # Errors
    /// If it is none.
    pub(super) fn pose(&self, name: &str) -> Result<Pose, Fault> {
        let expected = "16 numbers of a rigid transform";
        pose_from_matrix(&self.matrix(name)?).map_err(|found| self.fault(name, expected, found))
    }

    /// A fault of what stands under a name.
    pub(super) fn fault(&self, name: &str, expected: &str, found: impl Into<String>) -> Fault {
        Fault::new("calibration", &self.file, expected, found).record(name)
    }

    /// The text of a matrix's `data`, brackets, commas and dashes left out.
    fn data(&self, name: &str) -> String {
        let below = self.lines.iter().skip_while(|line| value(line, name).is_none()).skip(1);
        let block = below.take_while(|line| !line.starts_with(|c: char| c.is_alphabetic()));
        let mut data = block.skip_while(|line| value(line.trim_start(), "data").is_none());
        let first = data.next().and_then(|line| value(line.trim_start(), "data"));
        let rest = data.map(String::as_str).take_while(|line| !line.contains(':'));
        let text: Vec<&str> = first.into_iter().chain(rest).collect();
        let words = text.join(" ").replace(['[', ']', ','], " ");
        words.split_whitespace().filter(|word| *word != "-").collect::<Vec<_>>().join(" ")
    }
}

/// What stands behind a name and its colon.
fn value<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    Some(line.strip_prefix(name)?.strip_prefix(':')?.trim())
}

fn uncommented(line: String) -> String {
    line.split('#').next().unwrap_or_default().trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Calibration {
        Calibration {
            file: "c.yaml".into(),
            lines: text.lines().map(|l| uncommented(l.into())).collect(),
        }
    }

    #[test]
    fn matrices_are_lists_in_brackets_or_behind_dashes() {
        let text = "image_width: 12  # px\nmodel: plumb_bob\na:\n rows: 1\n data: [ 1, 2.5,\n  -3e1 ]\n cols: 3\n\
            b:\n  data:\n  - 4\n  - -5.0\nc:\n- 1\n";
        let read = read(text);
        assert_eq!(read.number("image_width"), Ok(12.0));
        assert_eq!(read.word("model"), Some("plumb_bob"));
        assert_eq!(read.matrix_of("a"), Ok([1.0, 2.5, -30.0]));
        assert_eq!(read.matrix_of("b"), Ok([4.0, -5.0]));
        assert_eq!(read.matrix("c"), Ok(vec![]));
    }

    #[test]
    fn what_is_no_such_value_is_told_by_its_name() {
        let read = read("width: x\na:\n  data: [1, y]\nb:\n  data: [1, 2]\n");
        let told = |fault: Fault| (fault.record.unwrap_or_default(), fault.found);
        assert_eq!(told(read.number("width").unwrap_err()), ("width".into(), "`x`".into()));
        assert_eq!(told(read.number("height").unwrap_err()).1, "0 numbers");
        assert_eq!(told(read.matrix("a").unwrap_err()), ("a".into(), "`y`".into()));
        assert_eq!(told(read.matrix_of::<3>("b").unwrap_err()).1, "2 numbers");
        assert_eq!(told(read.pose("b").unwrap_err()).1, "2 numbers");
    }
}
