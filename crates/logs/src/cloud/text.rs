//! Lines of text in files that may be anything.

use std::io::{BufRead, Read};

/// No line of a header or a point is longer.
const LONGEST_LINE_BYTES: u64 = 1 << 16;

/// The next line, without its end.
///
/// # Errors
/// What was found, if there is none, it is too long, or cannot be read.
pub(super) fn read_line(reader: &mut impl BufRead) -> Result<String, String> {
    let mut line = Vec::new();
    let mut limited = Read::take(reader, LONGEST_LINE_BYTES);
    let read = limited.read_until(b'\n', &mut line).map_err(|error| error.to_string())?;
    match line.last() {
        None => Err("the end of the file".into()),
        Some(b'\n') => Ok(trimmed(&line)),
        Some(_) if read as u64 == LONGEST_LINE_BYTES => Err("a line without an end".into()),
        Some(_) => Ok(trimmed(&line)),
    }
}

fn trimmed(line: &[u8]) -> String {
    String::from_utf8_lossy(line).trim().to_owned()
}

/// The numbers of a line; NaN is one.
pub(super) fn words(line: &str) -> impl Iterator<Item = Result<f64, String>> + '_ {
    line.split_ascii_whitespace().map(|word| {
        word.parse().map_err(|_| format!("`{}`", word.chars().take(40).collect::<String>()))
    })
}
