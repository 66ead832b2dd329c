//! The `.npy` format: a header of text, then the numbers.
//!
//! See numpy's own documentation (`numpy.lib.format`). Fortran order and big-endian numbers are read
//! right; anything but plain numbers, a pickle above all, is refused.

use std::io::Read;

use crate::{NumberArray, NumberType};

/// Longest header of an array that is accepted: version 1 of the format allows no more.
pub(crate) const MAX_HEADER_BYTES: u64 = 1 << 16;

/// What stands in a header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NpyHeader {
    /// The type of each number.
    pub number: NumberType,
    /// Whether the bytes of a number come highest first.
    pub is_big_endian: bool,
    /// Whether the first axis is the fastest.
    pub is_fortran: bool,
    /// How many numbers there are along each axis.
    pub shape: Vec<usize>,
}

/// Why a file is none of ours: what was expected, what was found.
pub(crate) type Refusal = (String, String);

impl NpyHeader {
    /// Reads the header that a file begins with.
    pub(crate) fn read(source: &mut impl Read) -> Result<Self, Refusal> {
        let found = header_text(source);
        let told = found.as_deref().unwrap_or("no header");
        let refused = || ("an array of plain numbers".to_owned(), told.chars().take(200).collect());
        parse_text(told).ok_or_else(refused)
    }

    /// The bytes that the numbers take; `None` if they cannot be counted.
    pub fn value_bytes(&self) -> Option<u64> {
        let count = self.shape.iter().try_fold(1_u64, |n, &side| n.checked_mul(side as u64))?;
        count.checked_mul(self.number.size() as u64)
    }
}

impl NumberArray {
    /// Reads an `.npy` file to its end; there is `room` for so many bytes at first.
    pub(crate) fn read(mut source: impl Read, room: u64) -> Result<Self, Refusal> {
        let header = NpyHeader::read(&mut source)?;
        let expected = header.value_bytes().ok_or_else(|| {
            ("an array that can be counted".to_owned(), format!("{:?}", header.shape))
        })?;
        let mut bytes = Vec::with_capacity(expected.min(room) as usize);
        if let Err(error) = source.read_to_end(&mut bytes) {
            return Err(("a whole array".to_owned(), error.to_string()));
        }
        if bytes.len() as u64 != expected {
            return Err((format!("{expected} bytes of numbers"), bytes.len().to_string()));
        }
        if header.is_big_endian {
            bytes.chunks_exact_mut(header.number.size()).for_each(<[u8]>::reverse);
        }
        let NpyHeader { number, shape, .. } = header;
        if header.is_fortran {
            bytes = c_order(&bytes, number.size(), &shape);
        }
        Ok(Self { number, shape, bytes })
    }

    /// The bytes of an `.npy` file, the same as numpy's.
    pub fn to_npy(&self) -> Vec<u8> {
        let mut bytes = self.npy_header();
        bytes.extend_from_slice(&self.bytes);
        bytes
    }

    /// What stands before the numbers in an `.npy` file.
    pub(crate) fn npy_header(&self) -> Vec<u8> {
        let sides: Vec<_> = self.shape.iter().map(usize::to_string).collect();
        let shape = match &sides[..] {
            [side] => format!("({side},)"),
            _ => format!("({})", sides.join(", ")),
        };
        let descr = self.number.descr();
        let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
        // Room for the first axis to grow to 21 digits, then up to a multiple of 64 bytes.
        let spare = sides.first().map_or(0, |side| 21_usize.saturating_sub(side.len()));
        let length = (10 + text.len() + spare + 1).next_multiple_of(64) - 10;
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend_from_slice(&(length as u16).to_le_bytes());
        bytes.extend_from_slice(format!("{text:<width$}\n", width = length - 1).as_bytes());
        bytes
    }
}

/// The header's dictionary, without blanks and without the comma before a closing bracket.
fn header_text(source: &mut impl Read) -> Option<String> {
    let [magic @ .., version, _] = take::<8>(source)?;
    let length = match version {
        1 => usize::from(u16::from_le_bytes(take(source)?)),
        2 | 3 => u32::from_le_bytes(take(source)?) as usize,
        _ => return None,
    };
    if magic != *b"\x93NUMPY" || length as u64 > MAX_HEADER_BYTES {
        return None;
    }
    let mut text = vec![0; length];
    source.read_exact(&mut text).ok()?;
    let text = std::str::from_utf8(&text).ok()?;
    let text: String = text.chars().filter(|c| !c.is_ascii_whitespace()).collect();
    Some(text.replace(",)", ")").replace(",}", "}"))
}

fn take<const N: usize>(source: &mut impl Read) -> Option<[u8; N]> {
    let mut bytes = [0; N];
    source.read_exact(&mut bytes).ok().map(|()| bytes)
}

fn parse_text(text: &str) -> Option<NpyHeader> {
    let (descr, rest) = text.strip_prefix("{'descr':'")?.split_once('\'')?;
    let (order, rest) = rest.strip_prefix(",'fortran_order':")?.split_once(',')?;
    let sides = rest.strip_prefix("'shape':(")?.strip_suffix(")}")?;
    let shape: Option<Vec<usize>> = match sides {
        "" => Some(Vec::new()),
        sides => sides.split(',').map(|side| side.parse().ok()).collect(),
    };
    let is_fortran = match order {
        "True" => true,
        "False" => false,
        _ => return None,
    };
    let (endian, kind) = descr.split_at_checked(1)?;
    let number = NumberType::ALL.into_iter().find(|number| number.descr()[1..] == *kind)?;
    let is_big_endian = match endian {
        ">" => true,
        "<" | "|" | "=" => false,
        _ => return None,
    };
    Some(NpyHeader { number, is_big_endian, is_fortran, shape: shape? })
}

/// Numbers whose first axis is the fastest, put into C order.
fn c_order(bytes: &[u8], size: usize, shape: &[usize]) -> Vec<u8> {
    let mut ordered = Vec::with_capacity(bytes.len());
    let mut index = vec![0; shape.len()];
    for _ in 0..bytes.len() / size {
        let at = index.iter().zip(shape).rev().fold(0, |at, (i, side)| at * side + i);
        ordered.extend_from_slice(&bytes[at * size..][..size]);
        for axis in (0..shape.len()).rev() {
            index[axis] += 1;
            if index[axis] < shape[axis] {
                break;
            }
            index[axis] = 0;
        }
    }
    ordered
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_is_the_one_that_numpy_writes() {
        let text = |array: &NumberArray| String::from_utf8(array.to_npy()[10..].to_vec()).unwrap();
        // numpy.save of zeros((0, 4), int64), of zeros(0, uint8) and of zeros((0, 2, 3), float32)
        let rows = text(&NumberArray::new::<i64>(&[0, 4], &[]));
        let expected = "{'descr': '<i8', 'fortran_order': False, 'shape': (0, 4), }";
        assert_eq!(rows, format!("{expected:<117}\n"));
        let line = text(&NumberArray::new::<u8>(&[0], &[]));
        let expected = "{'descr': '|u1', 'fortran_order': False, 'shape': (0,), }";
        assert_eq!(line, format!("{expected:<117}\n"));
    }

    #[test]
    fn an_array_survives_its_file() {
        let array = NumberArray::new(&[2, 3], &[1.5_f32, -2.0, 0.0, 4.0, 1e9, f32::MIN]);
        assert_eq!(NumberArray::read(&array.to_npy()[..], 0), Ok(array));
        let scalar = NumberArray::new(&[], &[7_i64]);
        assert_eq!(NumberArray::read(&scalar.to_npy()[..], 0), Ok(scalar));
    }
}
