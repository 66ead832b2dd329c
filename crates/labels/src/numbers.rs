//! Arrays of numbers of any type and shape, as files of other programs bring them.

use ndarray_npy::{ReadableElement, WritableElement};
use serde::{Deserialize, Serialize};

/// A type of numbers that numpy writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "each is named for what it is")]
pub enum NumberType {
    Bool,
    U8,
    U16,
    U32,
    U64,
    I8,
    I16,
    I32,
    I64,
    F16,
    F32,
    F64,
}

impl NumberType {
    /// All of them.
    pub const ALL: [Self; 12] = {
        use NumberType::*;
        [Bool, U8, U16, U32, U64, I8, I16, I32, I64, F16, F32, F64]
    };

    /// Bytes of a number.
    pub fn size(self) -> usize {
        match self {
            Self::Bool | Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Whether it has digits after the point.
    pub fn is_float(self) -> bool {
        matches!(self, Self::F16 | Self::F32 | Self::F64)
    }

    /// What numpy calls it, little-endian.
    pub fn descr(self) -> String {
        let kind = match self {
            Self::Bool => 'b',
            Self::U8 | Self::U16 | Self::U32 | Self::U64 => 'u',
            Self::I8 | Self::I16 | Self::I32 | Self::I64 => 'i',
            Self::F16 | Self::F32 | Self::F64 => 'f',
        };
        format!("{}{kind}{}", if self.size() == 1 { '|' } else { '<' }, self.size())
    }
}

/// Numbers of one type in an array of any shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NumberArray {
    /// The type of each number.
    pub number: NumberType,
    /// How many there are along each axis, the slowest first.
    pub shape: Vec<usize>,
    /// The numbers, little-endian, in C order.
    pub bytes: Vec<u8>,
}

/// A number as the bytes of a [`NumberArray`], and in files as `ndarray-npy` has it.
pub trait Number: ReadableElement + WritableElement + Copy {
    /// Its type.
    const TYPE: NumberType;

    /// The bytes of numbers, little-endian.
    fn bytes(values: &[Self]) -> Vec<u8>;

    /// The numbers of bytes, little-endian.
    fn numbers(bytes: &[u8]) -> Vec<Self>;
}

macro_rules! numbers {
    ($($number:ty: $of:ident)*) => {
        $(impl Number for $number {
            const TYPE: NumberType = NumberType::$of;

            fn bytes(values: &[Self]) -> Vec<u8> {
                let numbers: Vec<_> = values.iter().map(|value| value.to_le_bytes()).collect();
                numbers.into_flattened()
            }

            fn numbers(bytes: &[u8]) -> Vec<Self> {
                each(bytes, Self::from_le_bytes)
            }
        })*
    };
}

numbers!(u8: U8 u16: U16 u32: U32 u64: U64 i8: I8 i16: I16 i32: I32 i64: I64 f32: F32 f64: F64);

impl Number for bool {
    const TYPE: NumberType = NumberType::Bool;

    fn bytes(values: &[Self]) -> Vec<u8> {
        values.iter().map(|&value| u8::from(value)).collect()
    }

    fn numbers(bytes: &[u8]) -> Vec<Self> {
        bytes.iter().map(|&byte| byte != 0).collect()
    }
}

/// Calls a function with the Rust type of a [`NumberType`]: halves, which there are none of in Rust,
/// as the words of their bits.
macro_rules! with_type {
    ($number:expr, $function:ident($($argument:expr),*)) => {
        match $number {
            NumberType::Bool => $function::<bool>($($argument),*),
            NumberType::U8 => $function::<u8>($($argument),*),
            NumberType::U16 | NumberType::F16 => $function::<u16>($($argument),*),
            NumberType::U32 => $function::<u32>($($argument),*),
            NumberType::U64 => $function::<u64>($($argument),*),
            NumberType::I8 => $function::<i8>($($argument),*),
            NumberType::I16 => $function::<i16>($($argument),*),
            NumberType::I32 => $function::<i32>($($argument),*),
            NumberType::I64 => $function::<i64>($($argument),*),
            NumberType::F32 => $function::<f32>($($argument),*),
            NumberType::F64 => $function::<f64>($($argument),*),
        }
    };
}
pub(crate) use with_type;

impl NumberArray {
    /// An array of numbers in C order.
    ///
    /// # Panics
    /// If there is not one number for each place of the shape.
    pub fn new<T: Number>(shape: &[usize], values: &[T]) -> Self {
        assert_eq!(values.len(), shape.iter().product::<usize>(), "a number for each place");
        Self { number: T::TYPE, shape: shape.to_vec(), bytes: T::bytes(values) }
    }

    /// An array of whole numbers of a type; digits that the type has no room for are cut off.
    ///
    /// # Panics
    /// If there is not one number for each place of the shape.
    pub fn of_whole(number: NumberType, shape: &[usize], values: &[i64]) -> Self {
        if number.is_float() {
            let values: Vec<f64> = values.iter().map(|&value| value as f64).collect();
            return Self::of_floats(number, shape, &values);
        }
        assert_eq!(values.len(), shape.iter().product::<usize>(), "a number for each place");
        let bytes = match number.size() {
            1 => values.iter().map(|&value| value as u8).collect(),
            2 => u16::bytes(&values.iter().map(|&value| value as u16).collect::<Vec<_>>()),
            4 => u32::bytes(&values.iter().map(|&value| value as u32).collect::<Vec<_>>()),
            _ => i64::bytes(values),
        };
        Self { number, shape: shape.to_vec(), bytes }
    }

    /// An array of numbers of a type; what stands after the point is cut off if the type has none.
    ///
    /// # Panics
    /// If there is not one number for each place of the shape, or the type is [`NumberType::F16`].
    pub fn of_floats(number: NumberType, shape: &[usize], values: &[f64]) -> Self {
        match number {
            NumberType::F64 => Self::new(shape, values),
            NumberType::F32 => {
                Self::new(shape, &values.iter().map(|&value| value as f32).collect::<Vec<_>>())
            }
            NumberType::F16 => panic!("numbers of 16 bits are read only"),
            _ => {
                Self::of_whole(number, shape, &values.iter().map(|&v| v as i64).collect::<Vec<_>>())
            }
        }
    }

    /// How many numbers there are.
    pub fn len(&self) -> usize {
        self.bytes.len() / self.number.size()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// The numbers as whole ones, true as 1; `None` if they are not whole by type, or too large.
    pub fn whole(&self) -> Option<Vec<i64>> {
        let bytes = &self.bytes;
        Some(match self.number {
            NumberType::Bool | NumberType::U8 => bytes.iter().map(|&v| i64::from(v)).collect(),
            NumberType::I8 => bytes.iter().map(|&v| i64::from(v as i8)).collect(),
            NumberType::U16 => each(bytes, |v| i64::from(u16::from_le_bytes(v))),
            NumberType::I16 => each(bytes, |v| i64::from(i16::from_le_bytes(v))),
            NumberType::U32 => each(bytes, |v| i64::from(u32::from_le_bytes(v))),
            NumberType::I32 => each(bytes, |v| i64::from(i32::from_le_bytes(v))),
            NumberType::I64 => each(bytes, i64::from_le_bytes),
            NumberType::U64 => {
                let values = each(bytes, |v| i64::try_from(u64::from_le_bytes(v)));
                values.into_iter().collect::<Result<_, _>>().ok()?
            }
            NumberType::F16 | NumberType::F32 | NumberType::F64 => return None,
        })
    }

    /// A number by its place: exact but for whole ones beyond 2^53.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline]
    pub fn float(&self, at: usize) -> f64 {
        use NumberType::*;
        let bytes = &self.bytes;
        match self.number {
            Bool | U8 => f64::from(bytes[at]),
            I8 => f64::from(bytes[at] as i8),
            U16 => f64::from(u16::from_le_bytes(number_at(bytes, at))),
            I16 => f64::from(i16::from_le_bytes(number_at(bytes, at))),
            U32 => f64::from(u32::from_le_bytes(number_at(bytes, at))),
            I32 => f64::from(i32::from_le_bytes(number_at(bytes, at))),
            U64 => u64::from_le_bytes(number_at(bytes, at)) as f64,
            I64 => i64::from_le_bytes(number_at(bytes, at)) as f64,
            F16 => half(u16::from_le_bytes(number_at(bytes, at))),
            F32 => f64::from(f32::from_le_bytes(number_at(bytes, at))),
            F64 => f64::from_le_bytes(number_at(bytes, at)),
        }
    }

    /// The numbers as f64: exact but for whole ones beyond 2^53.
    pub fn floats(&self) -> Vec<f64> {
        (0..self.len()).map(|at| self.float(at)).collect()
    }
}

#[inline]
fn number_at<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    bytes.as_chunks().0[at]
}

fn each<const N: usize, T>(bytes: &[u8], number: impl Fn([u8; N]) -> T) -> Vec<T> {
    bytes.as_chunks::<N>().0.iter().map(|&chunk| number(chunk)).collect()
}

/// IEEE 754 binary16: a sign, five bits of exponent, ten of fraction.
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff) / 1024.0);
    let size = match exponent {
        0 => libm::ldexp(fraction, -14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => libm::ldexp(1.0 + fraction, exponent - 15),
    };
    if bits >> 15 == 1 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_of_every_type_are_themselves() {
        let negative = [-1_i64, 0, 1, 127, -128];
        assert_eq!(NumberArray::new(&[5], &negative.map(|v| v as i8)).whole().unwrap(), negative);
        assert_eq!(NumberArray::new(&[5], &negative.map(|v| v as i16)).whole().unwrap(), negative);
        assert_eq!(NumberArray::new(&[5], &negative.map(|v| v as i32)).whole().unwrap(), negative);
        assert_eq!(NumberArray::new(&[5], &negative).whole().unwrap(), negative);
        assert_eq!(NumberArray::new(&[2], &[0_u8, 255]).whole().unwrap(), [0, 255]);
        assert_eq!(NumberArray::new(&[2], &[0_u16, 65535]).whole().unwrap(), [0, 65535]);
        assert_eq!(NumberArray::new(&[1], &[u32::MAX]).whole().unwrap(), [i64::from(u32::MAX)]);
        assert_eq!(NumberArray::new(&[1], &[u64::MAX]).whole(), None);
        assert_eq!(NumberArray::new(&[1], &[7_u64]).whole().unwrap(), [7]);
        assert_eq!(NumberArray::new(&[1], &[1.0_f32]).whole(), None);
    }

    #[test]
    fn halves_are_as_ieee_754_says() {
        let bits = [0x3c00_u16, 0xc000, 0x7bff, 0x0001, 0x8000, 0x7c00, 0x3555];
        let expected =
            [1.0, -2.0, 65504.0, 1.0 / f64::from(1 << 24), 0.0, f64::INFINITY, 0.333_251_953_125];
        assert_eq!(bits.map(half), expected);
        assert!(half(0x7e00).is_nan());
    }
}
