//! Protocol buffers and records, taken apart and put together again, to bend logs.

use std::io::{Read, Write};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

/// A record around these bytes, its checksums right.
pub(crate) fn record(data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u64).to_le_bytes();
    [&length[..], &checksum(&length), data, &checksum(data)].concat()
}

fn checksum(bytes: &[u8]) -> [u8; 4] {
    crc32c::crc32c(bytes).rotate_right(15).wrapping_add(0xa282_ead8).to_le_bytes()
}

/// The message with what stands at a path (a field number and which of its like, each) changed.
///
/// # Panics
/// If nothing stands there.
pub(crate) fn edit(
    message: &[u8],
    path: &[(u64, usize)],
    change: &mut dyn FnMut(&[u8]) -> Vec<u8>,
) -> Vec<u8> {
    let Some((&(number, which), deeper)) = path.split_first() else { return change(message) };
    let (mut edited, mut rest, mut nth) = (Vec::new(), message, 0);
    while !rest.is_empty() {
        let (key, payload, size) = field(rest);
        if key >> 3 == number && key & 7 == 2 {
            if nth == which {
                let inner = edit(payload, deeper, change);
                edited.extend([varint(key), varint(inner.len() as u64), inner].concat());
                edited.extend_from_slice(&rest[size..]);
                return edited;
            }
            nth += 1;
        }
        edited.extend_from_slice(&rest[..size]);
        rest = &rest[size..];
    }
    panic!("no field {number} number {which}");
}

/// The message without any field of a number.
pub(crate) fn without(message: &[u8], number: u64) -> Vec<u8> {
    let (mut kept, mut rest) = (Vec::new(), message);
    while !rest.is_empty() {
        let (key, _, size) = field(rest);
        if key >> 3 != number {
            kept.extend_from_slice(&rest[..size]);
        }
        rest = &rest[size..];
    }
    kept
}

/// The first field's key, its payload, and how many bytes it takes in all.
fn field(bytes: &[u8]) -> (u64, &[u8], usize) {
    let (key, head) = read_varint(bytes);
    match key & 7 {
        0 => (key, &[], head + read_varint(&bytes[head..]).1),
        1 => (key, &[], head + 8),
        5 => (key, &[], head + 4),
        _ => {
            let (length, more) = read_varint(&bytes[head..]);
            let end = head + more + length as usize;
            (key, &bytes[head + more..end], end)
        }
    }
}

fn read_varint(bytes: &[u8]) -> (u64, usize) {
    let length = bytes.iter().position(|byte| *byte < 0x80).unwrap() + 1;
    let digits = bytes[..length].iter().rev();
    (digits.fold(0, |number, byte| number << 7 | u64::from(byte & 0x7f)), length)
}

fn varint(mut number: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
    bytes
}

/// A `Transform` with number `place` of its 16 replaced.
pub(crate) fn with_double(transform: &[u8], place: usize, number: f64) -> Vec<u8> {
    let mut bytes = transform.to_vec();
    bytes[9 * place + 1..9 * place + 9].copy_from_slice(&number.to_le_bytes());
    bytes
}

/// What zlib holds, changed.
pub(crate) fn recompressed(bytes: &[u8], change: impl FnOnce(Vec<u8>) -> Vec<u8>) -> Vec<u8> {
    let mut plain = Vec::new();
    ZlibDecoder::new(bytes).read_to_end(&mut plain).unwrap();
    compressed(&change(plain))
}

/// These bytes behind zlib.
pub(crate) fn compressed(plain: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(plain).unwrap();
    encoder.finish().unwrap()
}
