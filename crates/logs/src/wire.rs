//! The wire format of protocol buffers, as far as the reader needs it.
//!
//! A message is walked where it lies, in a file or in memory: fields that nobody asks for (images,
//! above all) are stepped over and never read. Source: protobuf.dev, "Encoding".

use std::io::{Read, Seek, SeekFrom};

/// A message with more fields than this is refused.
const MAX_FIELDS: usize = 1 << 16;
/// A text or a list of numbers of more bytes than this is refused.
const MAX_VALUE_BYTES: u64 = 1 << 20;

/// A range of bytes of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    pub(crate) start: u64,
    pub(crate) end: u64,
}

impl Span {
    /// Bytes in it.
    pub(crate) fn len(&self) -> u64 {
        self.end - self.start
    }
}

/// What a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Value {
    Varint(u64),
    Fixed64(u64),
    Fixed32(u32),
    Bytes(Span),
}

/// What is wrong with a message, and at which byte of its source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Defect {
    pub(crate) at: u64,
    pub(crate) expected: &'static str,
    pub(crate) found: String,
}

/// Walks the fields of a message.
struct Walk<'a, S> {
    source: &'a mut S,
    at: u64,
    end: u64,
}

impl<'a, S: Read + Seek> Walk<'a, S> {
    /// Begins at the first field of the message that fills a span.
    fn new(source: &'a mut S, span: Span) -> Result<Self, Defect> {
        seek(source, span.start)?;
        Ok(Self { source, at: span.start, end: span.end })
    }

    /// The next field's number and value; `None` at the message's end.
    fn next(&mut self) -> Result<Option<(u32, Value)>, Defect> {
        if self.at == self.end {
            return Ok(None);
        }
        let at = self.at;
        let key = self.varint()?;
        let value = match key & 7 {
            0 => Value::Varint(self.varint()?),
            1 => Value::Fixed64(u64::from_le_bytes(self.take()?)),
            2 => Value::Bytes(self.skip()?),
            5 => Value::Fixed32(u32::from_le_bytes(self.take()?)),
            kind => {
                return Err(defect(at, "a field of wire type 0, 1, 2 or 5", format!("{kind}")));
            }
        };
        let number = u32::try_from(key >> 3).ok().filter(|number| (1..1 << 29).contains(number));
        let number = number
            .ok_or_else(|| defect(at, "a field number below 2^29", format!("{}", key >> 3)))?;
        Ok(Some((number, value)))
    }

    fn varint(&mut self) -> Result<u64, Defect> {
        let (at, mut value) = (self.at, 0_u64);
        for shift in (0..64).step_by(7) {
            let [byte] = self.take()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(defect(at, "a number of at most 10 bytes", "a longer one"))
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Defect> {
        if self.end - self.at < N as u64 {
            return Err(cut_off(self.at, N as u64, self.end));
        }
        let mut bytes = [0; N];
        self.source.read_exact(&mut bytes).map_err(|error| unreadable(self.at, &error))?;
        self.at += N as u64;
        Ok(bytes)
    }

    fn skip(&mut self) -> Result<Span, Defect> {
        let length = self.varint()?;
        if length > self.end - self.at {
            return Err(cut_off(self.at, length, self.end));
        }
        let start = self.at;
        let jump = self.source.seek_relative(length as i64);
        jump.map_err(|error| unreadable(self.at, &error))?;
        self.at += length;
        Ok(Span { start, end: self.at })
    }
}

/// The first field of each number, in a walk that ends when all are found.
pub(crate) fn first_of<S: Read + Seek, const N: usize>(
    source: &mut S,
    span: Span,
    numbers: [u32; N],
) -> Result<[Option<Value>; N], Defect> {
    let mut walk = Walk::new(source, span)?;
    let mut found = [None; N];
    while found.contains(&None) {
        let Some((number, value)) = walk.next()? else { break };
        if let Some(place) = numbers.iter().position(|wanted| *wanted == number) {
            found[place].get_or_insert(value);
        }
    }
    Ok(found)
}

/// The fields of a message, to be asked for by number. Where one stands there several times, the
/// last counts.
#[derive(Debug, Default)]
pub(crate) struct Fields(Vec<(u32, Value)>);

impl Fields {
    /// Walks the message that fills a span.
    pub(crate) fn read<S: Read + Seek>(source: &mut S, span: Span) -> Result<Self, Defect> {
        let mut walk = Walk::new(source, span)?;
        let mut fields = Vec::new();
        while let Some(field) = walk.next()? {
            if fields.len() == MAX_FIELDS {
                return Err(defect(walk.at, "at most 65536 fields in a message", "more"));
            }
            fields.push(field);
        }
        Ok(Self(fields))
    }

    fn values(&self, number: u32) -> impl DoubleEndedIterator<Item = Value> {
        self.0.iter().filter(move |field| field.0 == number).map(|field| field.1)
    }

    /// All texts, byte strings or messages of that number, in order.
    pub(crate) fn all(&self, number: u32) -> impl DoubleEndedIterator<Item = Span> {
        self.values(number).filter_map(|value| match value {
            Value::Bytes(span) => Some(span),
            _ => None,
        })
    }

    /// The text, byte string or message.
    pub(crate) fn bytes(&self, number: u32) -> Option<Span> {
        self.all(number).next_back()
    }

    /// The integer.
    pub(crate) fn integer(&self, number: u32) -> Option<i64> {
        self.values(number).rev().find_map(|value| match value {
            Value::Varint(bits) => Some(bits as i64),
            _ => None,
        })
    }

    /// The `fixed32`.
    pub(crate) fn fixed32(&self, number: u32) -> Option<u32> {
        self.values(number).rev().find_map(|value| match value {
            Value::Fixed32(bits) => Some(bits),
            _ => None,
        })
    }

    /// The `double`.
    pub(crate) fn double(&self, number: u32) -> Option<f64> {
        self.values(number).rev().find_map(|value| match value {
            Value::Fixed64(bits) => Some(f64::from_bits(bits)),
            _ => None,
        })
    }

    /// The repeated `double`s, packed or not.
    pub(crate) fn doubles<S: Read + Seek>(
        &self,
        source: &mut S,
        number: u32,
    ) -> Result<Vec<f64>, Defect> {
        let mut numbers = Vec::new();
        for value in self.values(number) {
            match value {
                Value::Fixed64(bits) => numbers.push(f64::from_bits(bits)),
                Value::Bytes(span) => {
                    let bytes = bytes(source, span)?;
                    let (packed, _) = bytes.as_chunks();
                    numbers.extend(packed.iter().map(|bytes| f64::from_le_bytes(*bytes)));
                }
                _ => {}
            }
        }
        Ok(numbers)
    }

    /// The repeated `int32`s, packed or not.
    pub(crate) fn integers<S: Read + Seek>(
        &self,
        source: &mut S,
        number: u32,
    ) -> Result<Vec<i32>, Defect> {
        let mut numbers = Vec::new();
        for value in self.values(number) {
            match value {
                Value::Varint(bits) => numbers.push(bits as i32),
                Value::Bytes(span) => numbers.extend(packed_integers(source, span)?),
                _ => {}
            }
        }
        Ok(numbers)
    }
}

/// `int32`s that fill a span.
pub(crate) fn packed_integers<S: Read + Seek>(
    source: &mut S,
    span: Span,
) -> Result<Vec<i32>, Defect> {
    let mut walk = Walk::new(source, span)?;
    let mut numbers = Vec::new();
    while walk.at < walk.end {
        numbers.push(walk.varint()? as i32);
    }
    Ok(numbers)
}

/// A text; what is no UTF-8 in it is replaced.
pub(crate) fn text<S: Read + Seek>(source: &mut S, span: Span) -> Result<String, Defect> {
    Ok(String::from_utf8_lossy(&bytes(source, span)?).into_owned())
}

/// The bytes of a span, at most 1 MiB.
fn bytes<S: Read + Seek>(source: &mut S, span: Span) -> Result<Vec<u8>, Defect> {
    if span.len() > MAX_VALUE_BYTES {
        let found = format!("{} bytes", span.len());
        return Err(defect(span.start, "at most 1 MiB of text or numbers", found));
    }
    seek(source, span.start)?;
    let mut bytes = vec![0; span.len() as usize];
    source.read_exact(&mut bytes).map_err(|error| unreadable(span.start, &error))?;
    Ok(bytes)
}

fn seek(source: &mut impl Seek, at: u64) -> Result<(), Defect> {
    source.seek(SeekFrom::Start(at)).map(drop).map_err(|error| unreadable(at, &error))
}

fn defect(at: u64, expected: &'static str, found: impl Into<String>) -> Defect {
    Defect { at, expected, found: found.into() }
}

fn cut_off(at: u64, needed: u64, end: u64) -> Defect {
    defect(at, "fields within their message", format!("{needed} bytes with {} left", end - at))
}

fn unreadable(at: u64, error: &std::io::Error) -> Defect {
    defect(at, "readable bytes", error.to_string())
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn fields(bytes: &[u8]) -> Result<Fields, Defect> {
        Fields::read(&mut Cursor::new(bytes), Span { start: 0, end: bytes.len() as u64 })
    }

    #[test]
    fn fields_are_found_by_number_and_the_last_counts() {
        let bytes = [
            0x08, 0x96, 0x01, // 1: 150
            0x12, 0x02, b'h', b'i', // 2: "hi"
            0x08, 0x07, // 1 again: 7
            0x19, 0, 0, 0, 0, 0, 0, 0xf8, 0x3f, // 3: 1.5
            0x25, 1, 0, 0, 0, // 4: fixed 32
        ];
        let read = fields(&bytes).unwrap();
        assert_eq!((read.integer(1), read.double(3), read.integer(9)), (Some(7), Some(1.5), None));
        let hi = read.bytes(2).unwrap();
        assert_eq!(text(&mut Cursor::new(&bytes), hi).unwrap(), "hi");
        assert_eq!((read.0.len(), read.double(2)), (5, None));
    }

    #[test]
    fn repeated_numbers_are_read_packed_or_not() {
        let bytes = [0x08, 3, 0x0a, 3, 0x96, 0x01, 5, 0x08, 4];
        let mut source = Cursor::new(bytes.as_slice());
        assert_eq!(fields(&bytes).unwrap().integers(&mut source, 1).unwrap(), [3, 150, 5, 4]);
        let minus_one = [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1];
        let span = Span { start: 0, end: 10 };
        assert_eq!(packed_integers(&mut Cursor::new(minus_one), span).unwrap(), [-1]);
    }

    #[test]
    fn broken_messages_say_where() {
        let at = |bytes: &[u8]| fields(bytes).unwrap_err().at;
        assert_eq!(at(&[0x08, 1, 0x12, 9, 0]), 4, "longer than its message");
        assert_eq!(at(&[0x08, 0x80]), 2, "cut off in a number");
        assert_eq!(at(&[0x08, 1, 0x0b]), 2, "a group");
        assert_eq!(at(&[0x00, 1]), 0, "field 0");
        assert_eq!(at(&[0xff; 12]), 0, "an endless number");
        assert_eq!(at(&[&[0x12][..], &[0xff; 9], &[1]].concat()), 11, "a length of 2^64 - 1");
    }
}
