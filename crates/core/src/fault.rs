//! What is wrong with an input: where, expected, found.

use std::fmt;

/// One fault of a log, a configuration or a label tree.
///
/// Prints as one line, `place (record, at byte n): expected …, found …`, then a hint if there is
/// one. Control characters of foreign names are escaped, so that a name cannot write to a terminal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// A short fixed name of the rule that was broken, such as `sweep-length`.
    pub rule: &'static str,
    /// The file, table or key.
    pub place: String,
    /// The record or token within it.
    pub record: Option<String>,
    /// The byte at which it stands.
    pub offset: Option<u64>,
    /// What was expected.
    pub expected: String,
    /// What was found.
    pub found: String,
    /// What could be done about it.
    pub hint: Option<String>,
}

impl Fault {
    /// A fault of a place.
    pub fn new(
        rule: &'static str,
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        Self {
            rule,
            place: place.into(),
            record: None,
            offset: None,
            expected: expected.into(),
            found: found.into(),
            hint: None,
        }
    }

    /// The same fault of a record within the place.
    pub fn record(mut self, record: impl Into<String>) -> Self {
        self.record = Some(record.into());
        self
    }

    /// The same fault at a byte of the place.
    pub fn offset(mut self, offset: u64) -> Self {
        self.offset = Some(offset);
        self
    }

    /// The same fault with a hint.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&printable(&self.place))?;
        match (&self.record, self.offset) {
            (Some(record), Some(offset)) => {
                write!(f, " ({}, at byte {offset})", printable(record))?
            }
            (Some(record), None) => write!(f, " ({})", printable(record))?,
            (None, Some(offset)) => write!(f, " (at byte {offset})")?,
            (None, None) => {}
        }
        write!(f, ": expected {}, found {}", printable(&self.expected), printable(&self.found))?;
        match &self.hint {
            Some(hint) => write!(f, "; hint: {}", printable(hint)),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Fault {}

/// The text with its control characters escaped.
pub fn printable(text: &str) -> String {
    let mut clean = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() {
            clean.extend(c.escape_default());
        } else {
            clean.push(c);
        }
    }
    clean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_is_one_line_of_where_expected_found() {
        let fault = Fault::new("sweep-length", "a.pcd.bin", "a multiple of 20 bytes", "41 bytes")
            .record("sweep 12")
            .offset(40)
            .hint("copy the file again");
        assert_eq!(
            fault.to_string(),
            "a.pcd.bin (sweep 12, at byte 40): expected a multiple of 20 bytes, found 41 bytes; \
             hint: copy the file again"
        );
    }

    #[test]
    fn fault_36_names_cannot_write_to_the_terminal() {
        assert_eq!(printable("a\u{1b}[31m\0b\n"), "a\\u{1b}[31m\\u{0}b\\n");
    }
}
