//! The one array that a panoptic label file holds.

use std::io::{Read, Seek};

use zip::ZipArchive;

/// Longer headers are refused: NumPy's own has 128 bytes.
const MAX_HEADER_BYTES: u64 = 1 << 16;

/// What such a file can hold instead of labels.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum NpzDefect {
    /// Another number of labels.
    Count(usize),
    /// No labels at all, and why.
    Format(String),
}

/// The 16-bit numbers of member `data`, of which there have to be `count`.
///
/// Nothing is reserved that the caller did not count, whatever sizes the file declares, and nothing
/// is ever unpickled: only an array of plain 16-bit numbers of one dimension is read.
/// Source: NumPy, `numpy.lib.format`, versions 1 to 3.
///
/// # Errors
/// If the file is no zip, has no such member, or that is no such array.
pub(crate) fn read_data(file: impl Read + Seek, count: usize) -> Result<Vec<u16>, NpzDefect> {
    let mut archive = ZipArchive::new(file).map_err(format)?;
    let mut member = archive.by_name("data.npy").map_err(format)?;
    let header = read_header(&mut member)?;
    let big_endian = match text_of(&header, "'descr':") {
        Some(text) if text.starts_with("'<u2'") => false,
        Some(text) if text.starts_with("'>u2'") => true,
        _ => return Err(format(format_args!("{header}"))),
    };
    let length = length_of(&header).ok_or_else(|| format(format_args!("{header}")))?;
    if length != count {
        return Err(NpzDefect::Count(length));
    }
    let bytes = read_exactly(&mut member, 2 * count)?;
    let number = |pair: &[u8]| {
        let little = u16::from(pair[0]) | u16::from(pair[1]) << 8;
        if big_endian { little.swap_bytes() } else { little }
    };
    Ok(bytes.chunks_exact(2).map(number).collect())
}

/// The dictionary that stands before the array.
pub(crate) fn read_header(member: &mut impl Read) -> Result<String, NpzDefect> {
    let mut start = [0; 8];
    member.read_exact(&mut start).map_err(format)?;
    let length = match start {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _] => little_endian::<2>(member)?,
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _] => little_endian::<4>(member)?,
        _ => return Err(format("no NumPy array")),
    };
    if length > MAX_HEADER_BYTES {
        return Err(format(format_args!("a header of {length} bytes")));
    }
    let mut header = String::new();
    let read = member.take(length).read_to_string(&mut header).map_err(format)?;
    if read as u64 == length { Ok(header) } else { Err(format("a truncated header")) }
}

fn little_endian<const N: usize>(reader: &mut impl Read) -> Result<u64, NpzDefect> {
    let mut bytes = [0; N];
    reader.read_exact(&mut bytes).map_err(format)?;
    Ok(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
}

/// What follows a key of the dictionary.
pub(crate) fn text_of<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, text) = header.split_once(key)?;
    Some(text.trim_start())
}

/// The length of an array of one dimension, `(123,)`.
fn length_of(header: &str) -> Option<usize> {
    let (length, _) = text_of(header, "'shape':")?.strip_prefix('(')?.split_once(",)")?;
    length.trim().parse().ok()
}

/// All that the member holds, if that is `length` bytes.
fn read_exactly(member: &mut impl Read, length: usize) -> Result<Vec<u8>, NpzDefect> {
    let mut bytes = Vec::new();
    member.take(length as u64 + 1).read_to_end(&mut bytes).map_err(format)?;
    match bytes.len() == length {
        true => Ok(bytes),
        false => Err(format(format_args!("not the {length} bytes that its header tells"))),
    }
}

fn format(defect: impl std::fmt::Display) -> NpzDefect {
    NpzDefect::Format(defect.to_string())
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Write};

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    /// An npz whose only member has this name and these bytes.
    fn npz(name: &str, bytes: &[u8]) -> Cursor<Vec<u8>> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        writer.start_file(name, SimpleFileOptions::default()).unwrap();
        writer.write_all(bytes).unwrap();
        writer.finish().unwrap()
    }

    fn npy(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let length = (header.len() as u32).to_le_bytes();
        let length = if version == 1 { &length[..2] } else { &length[..] };
        [b"\x93NUMPY", &[version, 0][..], length, header.as_bytes(), data].concat()
    }

    fn read(header: &str, data: &[u8], count: usize) -> Result<Vec<u16>, NpzDefect> {
        read_data(npz("data.npy", &npy(1, header, data)), count)
    }

    fn header(descr: &str, fortran: &str, shape: &str) -> String {
        format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}  \n")
    }

    #[test]
    fn fault_35_byte_order_and_versions_are_read_right() {
        let (little, big) = ([0x39, 0x30, 1, 0], [0x30, 0x39, 0, 1]);
        assert_eq!(read(&header("<u2", "False", "(2,)"), &little, 2), Ok(vec![12345, 1]));
        assert_eq!(read(&header(">u2", "True", "(2,)"), &big, 2), Ok(vec![12345, 1]));
        for version in [2, 3] {
            let file = npy(version, &header("<u2", "False", "(2,)"), &little);
            assert_eq!(read_data(npz("data.npy", &file), 2), Ok(vec![12345, 1]));
        }
    }

    #[test]
    fn fault_35_pickles_other_types_and_other_shapes_are_refused() {
        for (descr, shape) in
            [("|O", "(2,)"), ("<f4", "(1,)"), ("|u1", "(4,)"), ("<u2", "(1, 2)"), ("<u2", "()")]
        {
            let refused = read(&header(descr, "False", shape), &[0; 4], 2);
            assert!(matches!(refused, Err(NpzDefect::Format(_))), "{descr} {shape}");
        }
        assert!(matches!(read_data(npz("x.npy", b""), 0), Err(NpzDefect::Format(_))));
        assert!(matches!(read_data(npz("data.npy", b"\x80\x04cos"), 0), Err(NpzDefect::Format(_))));
        assert!(matches!(read_data(Cursor::new(b"PK".to_vec()), 0), Err(NpzDefect::Format(_))));
    }

    #[test]
    fn fault_34_declared_sizes_reserve_nothing() {
        let giant = header("<u2", "False", "(4611686018427387904,)");
        assert_eq!(read(&giant, &[0; 4], 2), Err(NpzDefect::Count(1 << 62)));
        let long = npy(2, "", b"");
        let long = [&long[..8], &u32::MAX.to_le_bytes()[..]].concat();
        assert!(matches!(read_data(npz("data.npy", &long), 2), Err(NpzDefect::Format(_))));
    }

    #[test]
    fn data_that_the_header_does_not_tell_is_refused() {
        for data in [&[0; 3][..], &[0; 5], &[]] {
            let refused = read(&header("<u2", "False", "(2,)"), data, 2);
            assert!(matches!(refused, Err(NpzDefect::Format(_))), "{} bytes", data.len());
        }
    }
}
