//! TFRecord files: records of bytes one after the other, each with its length and two checksums.
//!
//! ```text
//! u64 length | u32 checksum of the length | length bytes | u32 checksum of these     little-endian
//! ```
//!
//! Source: tensorflow.org, "TFRecord and tf.train.Example".

use std::io::{BufReader, Read, Seek, SeekFrom};

use occlabel_core::Fault;
use occlabel_disk::File;

use crate::wire::Span;

/// Bytes before a record's data.
const HEAD_BYTES: u64 = 12;
/// Bytes behind it.
const TAIL_BYTES: u64 = 4;
/// A longer record is refused.
const MAX_RECORD_BYTES: u64 = 1 << 30;

/// The records of a file, up to the first that is none: then with what is wrong there.
pub(super) fn index_records(file: &mut BufReader<File>, place: &str) -> (Vec<Span>, Option<Fault>) {
    let mut records = Vec::new();
    loop {
        let at = records.last().map_or(0, |last: &Span| last.end + TAIL_BYTES);
        match next_record(file, at, place) {
            Ok(Some(record)) => records.push(record),
            Ok(None) => return (records, None),
            Err(fault) => return (records, Some(fault)),
        }
    }
}

/// Whether a file begins as a record does.
pub(super) fn is_record_head(head: &[u8]) -> bool {
    length(head).is_some()
}

/// The data of a record, its checksum verified.
///
/// # Errors
/// If it cannot be read, or has another checksum than it says.
pub(super) fn read_record(
    file: &mut (impl Read + Seek),
    record: Span,
    place: &str,
) -> Result<Vec<u8>, Fault> {
    let unreadable = |error: std::io::Error| {
        Fault::new("unreadable-file", place, "a readable record", error.to_string())
            .offset(record.start)
    };
    let whole = record.len() + TAIL_BYTES;
    let left = file.seek(SeekFrom::End(0)).map_err(unreadable)?.saturating_sub(record.start);
    if left < whole {
        return Err(cut_off(record.start, whole, left, place));
    }
    file.seek(SeekFrom::Start(record.start)).map_err(unreadable)?;
    let mut data = vec![0; whole as usize];
    file.read_exact(&mut data).map_err(unreadable)?;
    let checksum = data.split_off(record.len() as usize);
    if checksum == masked_checksum(&data).to_le_bytes() {
        return Ok(data);
    }
    let (expected, found) = ("a record with the checksum that it says", "another checksum");
    Err(Fault::new("record-checksum", place, expected, found).offset(record.start))
}

fn next_record(file: &mut BufReader<File>, at: u64, place: &str) -> Result<Option<Span>, Fault> {
    let unreadable = |error: std::io::Error| {
        Fault::new("unreadable-file", place, "a readable file", error.to_string()).offset(at)
    };
    let size = file.get_ref().size_bytes().map_err(unreadable)?;
    if at == size {
        return Ok(None);
    }
    file.seek(SeekFrom::Start(at)).map_err(unreadable)?;
    let mut head = Vec::new();
    file.take(HEAD_BYTES).read_to_end(&mut head).map_err(unreadable)?;
    if (head.len() as u64) < HEAD_BYTES {
        return Err(cut_off(at, HEAD_BYTES, head.len() as u64, place));
    }
    let expected = format!("a record's length of at most {MAX_RECORD_BYTES}, and its checksum");
    let none = |found: String| Fault::new("record-length", place, expected, found).offset(at);
    let Some(length) = length(&head) else { return Err(none("another checksum".into())) };
    if length > MAX_RECORD_BYTES {
        return Err(none(format!("{length}")));
    }
    let start = at + HEAD_BYTES;
    if size - start < length + TAIL_BYTES {
        return Err(cut_off(start, length + TAIL_BYTES, size - start, place));
    }
    Ok(Some(Span { start, end: start + length }))
}

fn cut_off(at: u64, needed: u64, left: u64, place: &str) -> Fault {
    let (expected, found) = (format!("{needed} bytes of a record"), format!("{left} left"));
    Fault::new("record-cut-off", place, expected, found).offset(at)
}

/// The length that a record's head says, if its checksum is right.
fn length(head: &[u8]) -> Option<u64> {
    let (length, rest) = head.split_first_chunk::<8>()?;
    let (checksum, _) = rest.split_first_chunk::<4>()?;
    let is_right = u32::from_le_bytes(*checksum) == masked_checksum(length);
    is_right.then_some(u64::from_le_bytes(*length))
}

/// CRC-32C, turned and shifted so that a checksum of data that holds checksums is none of theirs.
fn masked_checksum(bytes: &[u8]) -> u32 {
    crc32c::crc32c(bytes).rotate_right(15).wrapping_add(0xa282_ead8)
}
