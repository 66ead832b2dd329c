//! A Feather file (Arrow IPC) as columns.

use std::path::Path;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float16Type, Float32Type, Float64Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type,
    UInt64Type,
};
use arrow_array::{Array, RecordBatch};
use arrow_buffer::Buffer;
use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::reader::FileDecoder;
use arrow_ipc::{Block, root_as_footer, root_as_message};
use arrow_schema::DataType;
use occlabel_core::Fault;

use crate::files::read_file;

/// A file unpacks to at most so many bytes.
const MAX_BYTES: u64 = 1 << 30;
/// What an Arrow file ends with, after the footer's length.
const MAGIC: &[u8] = b"ARROW1";

/// The rows of a file.
pub(super) struct Table {
    file: String,
    batches: Vec<RecordBatch>,
}

impl Table {
    /// Reads a file of the log.
    ///
    /// # Errors
    /// If it is absent, no sound Arrow file, or unpacks to more than 1 GiB.
    pub(super) fn read(root: &Path, file: &str) -> Result<Self, Fault> {
        let bytes = read_file(root, file)?;
        let batches = batches(bytes).map_err(|found| fault(file, "a sound Arrow file", found))?;
        Ok(Self { file: file.to_owned(), batches })
    }

    /// A column of numbers of any type.
    pub(super) fn reals(&self, name: &str) -> Result<Vec<f64>, Fault> {
        self.column(name, "a column of numbers", reals)
    }

    /// A column of whole numbers.
    pub(super) fn integers(&self, name: &str) -> Result<Vec<i64>, Fault> {
        self.column(name, "a column of whole numbers", integers)
    }

    /// A column of texts.
    pub(super) fn texts(&self, name: &str) -> Result<Vec<String>, Fault> {
        self.column(name, "a column of texts", texts)
    }

    fn column<T>(
        &self,
        name: &str,
        expected: &str,
        read: impl Fn(&dyn Array) -> Option<Vec<T>>,
    ) -> Result<Vec<T>, Fault> {
        let mut values = Vec::new();
        for batch in &self.batches {
            let located = |found: String| fault(&self.file, expected, found).record(name);
            let column = batch.column_by_name(name).ok_or_else(|| located("none".into()))?;
            if column.null_count() > 0 {
                return Err(located(format!("{} nulls", column.null_count())));
            }
            let other = || located(format!("one of {}", column.data_type()));
            values.extend(read(column).ok_or_else(other)?);
        }
        Ok(values)
    }
}

fn fault(file: &str, expected: &str, found: impl Into<String>) -> Fault {
    Fault::new("av2-table", file, expected, found)
}

fn reals(column: &dyn Array) -> Option<Vec<f64>> {
    Some(match column.data_type() {
        DataType::Float16 => {
            column.as_primitive::<Float16Type>().values().iter().map(|v| v.to_f64()).collect()
        }
        DataType::Float32 => {
            column.as_primitive::<Float32Type>().values().iter().map(|v| f64::from(*v)).collect()
        }
        DataType::Float64 => column.as_primitive::<Float64Type>().values().to_vec(),
        _ => integers(column)?.into_iter().map(|v| v as f64).collect(),
    })
}

fn integers(column: &dyn Array) -> Option<Vec<i64>> {
    Some(match column.data_type() {
        DataType::UInt8 => wide(column.as_primitive::<UInt8Type>().values()),
        DataType::UInt16 => wide(column.as_primitive::<UInt16Type>().values()),
        DataType::UInt32 => wide(column.as_primitive::<UInt32Type>().values()),
        DataType::Int32 => wide(column.as_primitive::<Int32Type>().values()),
        DataType::Int64 => column.as_primitive::<Int64Type>().values().to_vec(),
        DataType::UInt64 => {
            let values = column.as_primitive::<UInt64Type>().values();
            return values.iter().map(|v| i64::try_from(*v).ok()).collect();
        }
        _ => return None,
    })
}

fn wide<T: Copy + Into<i64>>(values: &[T]) -> Vec<i64> {
    values.iter().map(|value| (*value).into()).collect()
}

fn texts(column: &dyn Array) -> Option<Vec<String>> {
    let owned = |text: Option<&str>| text.map(str::to_owned);
    match column.data_type() {
        DataType::Utf8 => column.as_string::<i32>().iter().map(owned).collect(),
        DataType::LargeUtf8 => column.as_string::<i64>().iter().map(owned).collect(),
        _ => None,
    }
}

/// The batches of a file in memory. No size that it declares is believed before it is checked.
fn batches(bytes: Vec<u8>) -> Result<Vec<RecordBatch>, String> {
    let length = bytes.len();
    let tail = bytes.last_chunk::<10>().filter(|tail| tail.ends_with(MAGIC)).ok_or("no footer")?;
    let footer_length = u32::from_le_bytes([tail[0], tail[1], tail[2], tail[3]]) as usize;
    let start = (length - 10).checked_sub(footer_length).ok_or("a footer beyond the file")?;
    let footer = bytes[start..length - 10].to_vec();
    let footer = root_as_footer(&footer).map_err(|error| error.to_string())?;
    let schema = footer.schema().ok_or("no schema")?;
    let schema = try_fb_to_schema(schema).map_err(|error| error.to_string())?;
    if let Some(field) = schema.fields().iter().find(|field| field.data_type().is_nested()) {
        return Err(format!("a nested column `{}`", field.name()));
    }
    if footer.dictionaries().is_some_and(|list| !list.is_empty()) {
        return Err("dictionaries".into());
    }
    let decoder = FileDecoder::new(schema.into(), footer.version());
    let buffer = Buffer::from_vec(bytes);
    let mut left = MAX_BYTES;
    let mut batches = Vec::new();
    for block in footer.recordBatches().ok_or("no batches")? {
        let (from, size) = block_span(block, start)?;
        let data = buffer.slice_with_length(from, size);
        left = left.checked_sub(unpacked(&data, block)?).ok_or("more than 1 GiB")?;
        let batch = decoder.read_record_batch(block, &data).map_err(|error| error.to_string())?;
        batches.extend(batch);
    }
    Ok(batches)
}

/// Where a block begins, and its bytes.
fn block_span(block: &Block, end: usize) -> Result<(usize, usize), String> {
    let whole = |number: i64| usize::try_from(number).ok();
    let head = whole(block.metaDataLength().into());
    let size = head.zip(whole(block.bodyLength())).and_then(|(head, body)| head.checked_add(body));
    let span = whole(block.offset()).zip(size);
    let inside =
        |(from, size): &(usize, usize)| from.checked_add(*size).is_some_and(|to| to <= end);
    span.filter(inside).ok_or_else(|| "a block beyond the file".into())
}

/// How many bytes the buffers of a block say that they unpack to, each of them within the block.
fn unpacked(data: &[u8], block: &Block) -> Result<u64, String> {
    let head = &data[..block.metaDataLength() as usize];
    let skip = if head.starts_with(&[0xff; 4]) { 8 } else { 4 };
    let message = head.get(skip..).ok_or("a block without a message")?;
    let message = root_as_message(message).map_err(|error| error.to_string())?;
    let batch = message.header_as_record_batch().ok_or("a block that is no batch")?;
    let body = &data[head.len()..];
    let mut total = batch.length().unsigned_abs();
    for buffer in batch.buffers().into_iter().flatten() {
        let number = |number: i64| usize::try_from(number).ok();
        let span = number(buffer.offset()).zip(number(buffer.length()));
        let part = span.and_then(|(at, length)| body.get(at..)?.get(..length));
        let part = part.ok_or("a buffer beyond its block")?;
        let declared = part.first_chunk().map(|size| i64::from_le_bytes(*size));
        // Minus 1 says that the buffer is not packed.
        let declared = declared.filter(|_| batch.compression().is_some());
        total = total.saturating_add(declared.map_or(0, |size| size.max(0).unsigned_abs()));
    }
    Ok(total)
}
