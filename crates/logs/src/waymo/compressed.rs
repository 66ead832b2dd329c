//! Matrices as v1 keeps them: a protocol buffer, compressed by zlib.

use std::io::{Cursor, Read};

use flate2::read::ZlibDecoder;

use super::matrix::Matrix;
use crate::wire::{Defect, Fields, Span, packed_integers};

/// A `float` takes 4 bytes.
const FLOAT_BYTES: usize = 4;
/// An `int32` takes at most 10.
const INTEGER_BYTES: usize = 10;
/// The shape of a matrix and the heads of its fields take fewer bytes than these.
const SHAPE_BYTES: usize = 256;

/// A matrix of `float`s, `values` of them a pixel.
///
/// # Errors
/// What was found, if it is none, or larger than an image of so many `pixels`.
pub(crate) fn floats(
    compressed: &[u8],
    values: usize,
    pixels: usize,
) -> Result<Matrix<f32>, String> {
    let bytes = inflate(compressed, pixels * values * FLOAT_BYTES)?;
    let mut data = Vec::new();
    let shape = read(&bytes, |span| {
        let (packed, _) = bytes[span.start as usize..span.end as usize].as_chunks();
        data.extend(packed.iter().map(|bytes| f32::from_le_bytes(*bytes)));
        Ok(())
    })?;
    Matrix::new(&shape, values, data)
}

/// A matrix of `int32`s, `values` of them a pixel.
///
/// # Errors
/// What was found, if it is none, or larger than an image of so many `pixels`.
pub(crate) fn integers(
    compressed: &[u8],
    values: usize,
    pixels: usize,
) -> Result<Matrix<i32>, String> {
    let bytes = inflate(compressed, pixels * values * INTEGER_BYTES)?;
    let mut data = Vec::new();
    let shape = read(&bytes, |span| {
        data.extend(packed_integers(&mut Cursor::new(&bytes), span)?);
        Ok(())
    })?;
    Matrix::new(&shape, values, data)
}

/// The bytes behind zlib, as many as a matrix of `limit` bytes may have.
fn inflate(compressed: &[u8], limit: usize) -> Result<Vec<u8>, String> {
    let limit = limit + SHAPE_BYTES;
    let mut bytes = Vec::new();
    let stream = ZlibDecoder::new(compressed).take(limit as u64 + 1).read_to_end(&mut bytes);
    stream.map_err(|error| format!("zlib: {error}"))?;
    if bytes.len() > limit {
        return Err(format!("more than {limit} bytes behind zlib"));
    }
    Ok(bytes)
}

/// Hands on the packed values, and gives the shape.
fn read(bytes: &[u8], values: impl FnMut(Span) -> Result<(), Defect>) -> Result<Vec<i32>, String> {
    let tell = |defect: Defect| format!("{} at byte {} behind zlib", defect.found, defect.at);
    let mut source = Cursor::new(bytes);
    let all = Span { start: 0, end: bytes.len() as u64 };
    let matrix = Fields::read(&mut source, all).map_err(tell)?;
    matrix.all(1).try_for_each(values).map_err(tell)?;
    let Some(shape) = matrix.bytes(2) else { return Err("a matrix without a shape".into()) };
    let shape = Fields::read(&mut source, shape).map_err(tell)?;
    shape.integers(&mut source, 1).map_err(tell)
}
