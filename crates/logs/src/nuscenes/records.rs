//! The objects of a table, one by one.

use std::io::{self, BufRead};

use occlabel_core::Fault;

/// A record longer than this is refused: the longest of real tables has a few hundred bytes.
const MAX_RECORD_BYTES: usize = 1 << 20;

/// Splits a JSON array of objects into the bytes of each object.
///
/// Only brackets and strings are looked at, so that a row that nobody wants costs next to nothing
/// and a broken one can be told by its place.
pub(crate) struct Records<R> {
    reader: R,
    file: String,
    offset: u64,
    position: Position,
    bytes: Vec<u8>,
}

/// One object of the array, unread.
pub(crate) struct Record<'a> {
    /// Where in the file it begins.
    pub(crate) offset: u64,
    /// From `{` to `}`.
    pub(crate) bytes: &'a [u8],
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Position {
    BeforeArray,
    BeforeFirst,
    AfterRecord,
    AfterArray,
}

impl<R: BufRead> Records<R> {
    /// The objects of an array; `file` names it in faults.
    pub(crate) fn new(reader: R, file: &str) -> Self {
        let position = Position::BeforeArray;
        Self { reader, file: file.to_owned(), offset: 0, position, bytes: Vec::new() }
    }

    /// The next object; `None` at the end of the file.
    ///
    /// # Errors
    /// If the file is no array of objects, an object is longer than 1 MiB, or reading fails.
    pub(crate) fn next_record(&mut self) -> Result<Option<Record<'_>>, Fault> {
        if !self.find_record()? {
            return Ok(None);
        }
        let offset = self.offset;
        self.take_record()?;
        Ok(Some(Record { offset, bytes: &self.bytes }))
    }

    /// Comes to the next `{`; `false` at the end.
    fn find_record(&mut self) -> Result<bool, Fault> {
        use Position::{AfterArray, AfterRecord, BeforeArray, BeforeFirst};
        loop {
            let next = self.next_visible()?;
            match (self.position, next) {
                (AfterArray, None) => return Ok(false),
                (BeforeFirst, Some(b'{')) => return Ok(true),
                (BeforeArray, Some(b'[')) => self.step_to(BeforeFirst),
                (BeforeFirst | AfterRecord, Some(b']')) => self.step_to(AfterArray),
                (AfterRecord, Some(b',')) => self.step_over_comma()?,
                (BeforeArray, _) => return Err(self.unexpected("an array of records", next)),
                (BeforeFirst, _) => return Err(self.unexpected("an object or `]`", next)),
                (AfterRecord, _) => {
                    return Err(self.unexpected("`,` or `]` after a record", next));
                }
                (AfterArray, _) => return Err(self.unexpected("nothing after the array", next)),
            }
        }
    }

    /// Leaves the reader before the `{` that has to follow a comma.
    fn step_over_comma(&mut self) -> Result<(), Fault> {
        self.step_to(Position::BeforeFirst);
        match self.next_visible()? {
            Some(b'{') => Ok(()),
            next => Err(self.unexpected("an object after `,`", next)),
        }
    }

    /// Copies the object that begins here.
    fn take_record(&mut self) -> Result<(), Fault> {
        let begin = self.offset;
        let mut scan = ObjectScan::default();
        self.bytes.clear();
        self.position = Position::AfterRecord;
        loop {
            let chunk = fill(&mut self.reader, &self.file, self.offset)?;
            let end = scan.end(chunk);
            let taken = end.unwrap_or(chunk.len());
            if taken == 0 {
                return Err(self.broken(begin, "a record that ends", "the end of the file"));
            }
            if self.bytes.len() + taken > MAX_RECORD_BYTES {
                let expected = format!("records up to {MAX_RECORD_BYTES} bytes");
                return Err(self.broken(begin, &expected, "more"));
            }
            self.bytes.extend_from_slice(&chunk[..taken]);
            self.consume(taken);
            if end.is_some() {
                return Ok(());
            }
        }
    }

    /// The next byte that is no white space, which stays unread. A byte order mark is white space.
    fn next_visible(&mut self) -> Result<Option<u8>, Fault> {
        loop {
            let chunk = fill(&mut self.reader, &self.file, self.offset)?;
            let marked = self.offset == 0 && chunk.starts_with(b"\xef\xbb\xbf");
            let blank = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\n' | b'\r');
            let skipped =
                if marked { 3 } else { chunk.iter().take_while(|byte| blank(byte)).count() };
            let next = chunk.get(skipped).copied();
            let finished = chunk.is_empty() || (next.is_some() && !marked);
            self.consume(skipped);
            if finished {
                return Ok(next);
            }
        }
    }

    fn step_to(&mut self, position: Position) {
        self.consume(1);
        self.position = position;
    }

    fn consume(&mut self, bytes: usize) {
        self.reader.consume(bytes);
        self.offset += bytes as u64;
    }

    fn unexpected(&self, expected: &str, next: Option<u8>) -> Fault {
        let found = match next {
            None => "the end of the file".to_owned(),
            Some(byte) => format!("`{}`", byte.escape_ascii()),
        };
        self.broken(self.offset, expected, &found)
    }

    fn broken(&self, offset: u64, expected: &str, found: &str) -> Fault {
        Fault::new("table-syntax", &self.file, expected, found).offset(offset)
    }
}

fn fill<'a>(reader: &'a mut impl BufRead, file: &str, offset: u64) -> Result<&'a [u8], Fault> {
    let fault = |error: io::Error| {
        Fault::new("unreadable-file", file, "a readable file", error.to_string()).offset(offset)
    };
    reader.fill_buf().map_err(fault)
}

/// How deep in an object a scan is.
#[derive(Default)]
struct ObjectScan {
    depth: usize,
    in_string: bool,
    escaped: bool,
}

impl ObjectScan {
    /// Goes on through `bytes`; the place after the bracket that closes the object, if it is there.
    fn end(&mut self, bytes: &[u8]) -> Option<usize> {
        let mut at = 0;
        while at < bytes.len() {
            at = if self.in_string {
                self.skip_string(bytes, at)
            } else {
                let next = bytes[at..].iter().position(|byte| is_structural(*byte))? + at;
                match bytes[next] {
                    b'"' => self.in_string = true,
                    b'{' | b'[' => self.depth += 1,
                    _ => self.depth = self.depth.saturating_sub(1),
                }
                if self.depth == 0 {
                    return Some(next + 1);
                }
                next + 1
            };
        }
        None
    }

    /// From within a string to the place after its closing quote, or to the end of `bytes`.
    fn skip_string(&mut self, bytes: &[u8], from: usize) -> usize {
        for (at, &byte) in bytes.iter().enumerate().skip(from) {
            match byte {
                _ if self.escaped => self.escaped = false,
                b'\\' => self.escaped = true,
                b'"' => {
                    self.in_string = false;
                    return at + 1;
                }
                _ => {}
            }
        }
        bytes.len()
    }
}

fn is_structural(byte: u8) -> bool {
    matches!(byte, b'"' | b'{' | b'}' | b'[' | b']')
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::io::{BufReader, Cursor};

    use proptest::prelude::*;

    use super::*;

    /// The records of a table, read through a buffer of `capacity` bytes.
    fn split(table: &[u8], capacity: usize) -> Result<Vec<(u64, String)>, Fault> {
        let reader = BufReader::with_capacity(capacity, Cursor::new(table));
        let mut records = Records::new(reader, "t.json");
        let mut found = Vec::new();
        while let Some(record) = records.next_record()? {
            found.push((record.offset, String::from_utf8_lossy(record.bytes).into_owned()));
        }
        Ok(found)
    }

    fn refused(table: &str) -> String {
        let messages: Vec<String> = [1, 3, 4096]
            .map(|capacity| split(table.as_bytes(), capacity).unwrap_err().to_string())
            .into();
        assert!(messages.windows(2).all(|pair| pair[0] == pair[1]), "{messages:?}");
        messages[0].clone()
    }

    #[test]
    fn records_are_found_in_pretty_and_in_compact_tables() {
        for (table, offsets) in [
            ("[{\"a\":1},{\"b\":[{\"c\":{}}]}]", [1, 9]),
            ("\u{feff} [\r\n{\"a\":1}\n,\t{\"b\":[{\"c\":{}}]} ]\n", [7, 17]),
        ] {
            for capacity in [1, 2, 3, 4, 5, 7, 4096] {
                let found = split(table.as_bytes(), capacity);
                if capacity < 3 && table.starts_with('\u{feff}') {
                    continue;
                }
                let texts = ["{\"a\":1}", "{\"b\":[{\"c\":{}}]}"].map(str::to_owned);
                assert_eq!(found.unwrap(), offsets.into_iter().zip(texts).collect::<Vec<_>>());
            }
        }
        assert_eq!(split(b"[]", 9).unwrap(), []);
        assert_eq!(split(b" [ ] ", 1).unwrap(), []);
    }

    #[test]
    fn brackets_and_quotes_in_strings_are_text() {
        let record = r#"{"a":"}]{[\"}\\","b":"\\\"}","c":"é"}"#;
        let table = format!("[{record},{record}]");
        for capacity in 1..20 {
            let found = split(table.as_bytes(), capacity).unwrap();
            assert!(found.len() == 2 && found.iter().all(|(_, text)| text == record));
        }
    }

    #[test]
    fn truncated_tables_and_garbage_say_where() {
        let tells = |table: &str, message: &str| assert_eq!(refused(table), message);
        tells("", "t.json (at byte 0): expected an array of records, found the end of the file");
        tells(" nonsense", "t.json (at byte 1): expected an array of records, found `n`");
        tells("{\"a\":1}", "t.json (at byte 0): expected an array of records, found `{`");
        tells("[1]", "t.json (at byte 1): expected an object or `]`, found `1`");
        tells(
            "[{\"a\":",
            "t.json (at byte 1): expected a record that ends, found the end of the file",
        );
        tells(
            "[{}",
            "t.json (at byte 3): expected `,` or `]` after a record, found the end of the file",
        );
        tells("[{}{}]", "t.json (at byte 3): expected `,` or `]` after a record, found `{`");
        tells("[{},]", "t.json (at byte 4): expected an object after `,`, found `]`");
        tells("[{}]x", "t.json (at byte 4): expected nothing after the array, found `x`");
    }

    #[test]
    fn fault_34_a_huge_record_is_refused_before_it_is_held() {
        let table = format!("[{{\"a\":\"{}\"}}]", "x".repeat(MAX_RECORD_BYTES));
        let message = refused(&table);
        assert!(message.contains("records up to 1048576 bytes"), "{message}");
        let longest = format!("[{{\"a\":\"{}\"}}]", "x".repeat(MAX_RECORD_BYTES - 8));
        assert_eq!(split(longest.as_bytes(), 4096).unwrap().len(), 1);
    }

    #[test]
    fn mutated_tables_never_panic_and_every_capacity_agrees() {
        let table = r#"[{"a":"b\"c","d":[1,{"e":null}]}, {"f":"}"},
            {"g":-1.5e3}]"#;
        let (good, bad) = (Cell::new(0), Cell::new(0));
        let bytes = || prop_oneof![Just(b'"'), Just(b'\\'), Just(b'}'), Just(b']'), any::<u8>()];
        let edits = proptest::collection::vec((0..table.len(), bytes()), 0..3);
        let ends = prop_oneof![2 => Just(table.len()), 1 => 1..table.len()];
        proptest!(ProptestConfig::with_cases(4000), |(edits in edits, end in ends)| {
            let mut mutated = table.as_bytes().to_vec();
            for (at, byte) in edits {
                mutated[at] = byte;
            }
            mutated.truncate(end);
            let (fine, coarse) = (split(&mutated, 3), split(&mutated, 4096));
            prop_assert_eq!(&fine, &coarse);
            let seen = if fine.is_ok() { &good } else { &bad };
            seen.set(seen.get() + 1);
        });
        assert_eq!(good.get() + bad.get(), 4000);
        assert!(good.get() > 500 && bad.get() > 1000, "{} good, {} bad", good.get(), bad.get());
    }
}
