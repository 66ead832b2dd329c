//! The `.npy` format: a header of text, then the numbers.
//!
//! See numpy's own documentation (`numpy.lib.format`). `ndarray-npy` writes arrays, and reads them
//! in whatever order and with whatever byte first; but before it may, the header is checked, for it
//! would allocate what a header declares. Anything but plain numbers, a pickle above all, is refused.

use std::io::{Read, Write};

use ndarray::{ArrayD, ArrayViewD, IxDyn};
use ndarray_npy::{ReadNpyExt, WriteNpyError, WriteNpyExt};

use crate::numbers::with_type;
use crate::{Number, NumberArray, NumberType};

/// Longest header of an array that is accepted: version 1 of the format allows no more.
pub(crate) const MAX_HEADER_BYTES: u64 = 1 << 16;

/// What stands in a header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NpyHeader {
    /// The type of each number.
    pub number: NumberType,
    /// How many numbers there are along each axis.
    pub shape: Vec<usize>,
}

/// Why a file is none of ours: what was expected, what was found.
pub(crate) type Refusal = (String, String);

impl NpyHeader {
    /// Reads the header that a file begins with.
    pub(crate) fn read(source: &mut impl Read) -> Result<Self, Refusal> {
        Self::read_bytes(source).map(|(header, _)| header)
    }

    /// The header that a file begins with, and its bytes.
    fn read_bytes(source: &mut impl Read) -> Result<(Self, Vec<u8>), Refusal> {
        let (bytes, text_at) = header_bytes(source).unwrap_or_default();
        let told = header_text(&bytes[text_at..]).unwrap_or_else(|| "no header".to_owned());
        match parse_text(&told) {
            Some(header) => Ok((header, bytes)),
            None => {
                let found = told.chars().take(200).collect();
                Err(("an array of plain numbers".to_owned(), found))
            }
        }
    }

    /// The bytes that the numbers take; `None` if they cannot be counted.
    pub fn value_bytes(&self) -> Option<u64> {
        let count = self.shape.iter().try_fold(1_u64, |n, &side| n.checked_mul(side as u64))?;
        count.checked_mul(self.number.size() as u64)
    }
}

impl NumberArray {
    /// Reads an `.npy` file to its end; no more than `max_bytes` of numbers can be in it.
    pub(crate) fn read(mut source: impl Read, max_bytes: u64) -> Result<Self, Refusal> {
        let (header, mut head) = NpyHeader::read_bytes(&mut source)?;
        let expected = header.value_bytes().ok_or_else(|| {
            ("an array that can be counted".to_owned(), format!("{:?}", header.shape))
        })?;
        if expected > max_bytes {
            let found = format!("at most {max_bytes} bytes");
            return Err((format!("{expected} bytes of numbers"), found));
        }
        if header.number == NumberType::F16 {
            retype(&mut head, b"f2'", b"u2'");
        }
        let bytes = with_type!(header.number, read_numbers(head.chain(source)))?;
        Ok(Self { number: header.number, shape: header.shape, bytes })
    }

    /// The bytes of an `.npy` file.
    pub fn to_npy(&self) -> Vec<u8> {
        let mut file = Vec::new();
        self.write_npy(&mut file).expect("room in memory");
        file
    }
}

impl WriteNpyExt for NumberArray {
    fn write_npy<W: Write>(&self, mut writer: W) -> Result<(), WriteNpyError> {
        if self.number != NumberType::F16 {
            return with_type!(self.number, write_numbers(self, writer));
        }
        let mut file = Vec::new();
        write_numbers::<u16>(self, &mut file)?;
        retype(&mut file, b"u2'", b"f2'");
        writer.write_all(&file)?;
        Ok(writer.flush()?)
    }
}

/// The numbers of a file as the bytes of an array.
fn read_numbers<T: Number>(file: impl Read) -> Result<Vec<u8>, Refusal> {
    let array = ArrayD::<T>::read_npy(file)
        .map_err(|error| ("a whole array".to_owned(), error.to_string()))?;
    Ok(T::bytes(array.as_standard_layout().as_slice().expect("C order")))
}

fn write_numbers<T: Number>(array: &NumberArray, writer: impl Write) -> Result<(), WriteNpyError> {
    let values = T::numbers(&array.bytes);
    let view = ArrayViewD::from_shape(IxDyn(&array.shape), &values);
    view.expect("a number for each place").write_npy(writer)
}

/// Gives another type to the numbers of a file: `ndarray-npy` knows no halves, but their bits.
fn retype(file: &mut [u8], from: &[u8; 3], to: &[u8; 3]) {
    if let Some(at) = file.array_windows().position(|word| word == from) {
        file[at..at + 3].copy_from_slice(to);
    }
}

/// All that stands before the numbers, and where the text in it begins.
fn header_bytes(source: &mut impl Read) -> Option<(Vec<u8>, usize)> {
    let mut bytes = Vec::new();
    extend(&mut bytes, source, 8)?;
    let length_bytes = match bytes.strip_prefix(b"\x93NUMPY")?[0] {
        1 => 2,
        2 | 3 => 4,
        _ => return None,
    };
    extend(&mut bytes, source, length_bytes)?;
    let length = bytes[8..].iter().rev().fold(0, |length, &byte| length << 8 | u64::from(byte));
    if length > MAX_HEADER_BYTES {
        return None;
    }
    extend(&mut bytes, source, length as usize)?;
    Some((bytes, 8 + length_bytes))
}

/// Appends the next bytes of a source.
fn extend(bytes: &mut Vec<u8>, source: &mut impl Read, count: usize) -> Option<()> {
    let at = bytes.len();
    bytes.resize(at + count, 0);
    source.read_exact(&mut bytes[at..]).ok()
}

/// The header's dictionary, without blanks and without the comma before a closing bracket.
fn header_text(text: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(text).ok().filter(|text| !text.is_empty())?;
    let text: String = text.chars().filter(|c| !c.is_ascii_whitespace()).collect();
    Some(text.replace(",)", ")").replace(",}", "}"))
}

/// The keys in numpy's order, and nothing nested: what follows can be given to any parser.
fn parse_text(text: &str) -> Option<NpyHeader> {
    let (descr, rest) = text.strip_prefix("{'descr':'")?.split_once('\'')?;
    let (order, rest) = rest.strip_prefix(",'fortran_order':")?.split_once(',')?;
    let sides = rest.strip_prefix("'shape':(")?.strip_suffix(")}")?;
    let shape: Option<Vec<usize>> = match sides {
        "" => Some(Vec::new()),
        sides => sides.split(',').map(|side| side.parse().ok()).collect(),
    };
    let (endian, kind) = descr.split_at_checked(1)?;
    if !matches!(order, "True" | "False") || !matches!(endian, "<" | ">" | "|") {
        return None;
    }
    let number = NumberType::ALL.into_iter().find(|number| number.descr()[1..] == *kind)?;
    Some(NpyHeader { number, shape: shape? })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str, numbers: &[u8]) -> Vec<u8> {
        let length = (text.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes(), numbers].concat()
    }

    #[test]
    fn arrays_of_every_type_survive_their_file() {
        for number in NumberType::ALL {
            let bytes: Vec<u8> = (0..6 * number.size()).map(|at| (at % 2) as u8).collect();
            let array = NumberArray { number, shape: vec![2, 3], bytes };
            let npy = array.to_npy();
            assert_eq!(NpyHeader::read(&mut &npy[..]).unwrap().number, number);
            assert_eq!(NumberArray::read(&npy[..], array.bytes.len() as u64), Ok(array));
        }
        let scalar = NumberArray::new(&[], &[7_i64]);
        assert_eq!(NumberArray::read(&scalar.to_npy()[..], 8), Ok(scalar));
        let rows = NumberArray::new::<f32>(&[0, 4], &[]);
        assert_eq!(NumberArray::read(&rows.to_npy()[..], 0), Ok(rows));
    }

    #[test]
    fn fault_35_halves_are_read_right_with_either_byte_first() {
        for (endian, bytes) in [("<", [0, 0x3c, 0, 0xc0]), (">", [0x3c, 0, 0xc0, 0])] {
            let text =
                format!("{{'descr': '{endian}f2', 'fortran_order': False, 'shape': (2,), }}\n");
            let array = NumberArray::read(&file(&text, &bytes)[..], 4).unwrap();
            assert_eq!((array.number, array.floats()), (NumberType::F16, vec![1.0, -2.0]));
        }
    }

    #[test]
    fn fault_34_what_a_file_has_no_room_for_is_not_allocated() {
        let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }\n";
        let (expected, found) = NumberArray::read(&file(text, &[0; 8])[..], 8).unwrap_err();
        assert_eq!(expected, "8000000000000 bytes of numbers");
        assert_eq!(found, "at most 8 bytes");
    }
}
