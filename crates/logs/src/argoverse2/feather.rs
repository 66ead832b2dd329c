//! A Feather file (Arrow IPC) in memory. No size that it declares is believed before it is checked.
//!
//! ```text
//!   "ARROW1"  blocks ...  footer  footer's length  "ARROW1"
//!              block: message, then its buffers, each packed or not
//! ```

use arrow_array::RecordBatch;
use arrow_buffer::Buffer;
use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::reader::FileDecoder;
use arrow_ipc::{Block, Message, root_as_footer, root_as_message};

/// A file unpacks to at most so many bytes.
const MAX_BYTES: u64 = 1 << 30;
/// What a file ends with, after the footer's length.
const MAGIC: &[u8] = b"ARROW1";

/// A file whose footer is sound.
pub(super) struct Feather {
    decoder: FileDecoder,
    /// Message and buffers of each block, all within the file.
    blocks: Vec<(Block, Buffer)>,
}

impl Feather {
    /// Finds the blocks of a file.
    ///
    /// # Errors
    /// What was found, if it is no such file, or has nested or dictionary columns.
    pub(super) fn open(bytes: Vec<u8>) -> Result<Self, String> {
        let length = bytes.len();
        let tail = bytes.last_chunk::<10>().filter(|tail| tail.ends_with(MAGIC));
        let [a, b, c, d, ..] = tail.ok_or("no footer")?;
        let footer_length = u32::from_le_bytes([*a, *b, *c, *d]) as usize;
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
        let block = |block: &Block| {
            let (from, size) = block_span(block, start)?;
            Ok::<_, String>((*block, buffer.slice_with_length(from, size)))
        };
        let blocks = footer.recordBatches().ok_or("no batches")?.iter().map(block);
        Ok(Self { decoder, blocks: blocks.collect::<Result<_, _>>()? })
    }

    /// How many rows its blocks say that they have.
    ///
    /// # Errors
    /// What was found, if a block is no batch of rows.
    pub(super) fn rows(&self) -> Result<u64, String> {
        self.blocks.iter().try_fold(0_u64, |rows, (block, data)| {
            let message = message(data, block)?;
            let batch = message.header_as_record_batch().ok_or("a block that is no batch")?;
            let more = batch.length().unsigned_abs();
            // A row is a byte at least.
            let rows = rows.checked_add(more).filter(|rows| *rows <= MAX_BYTES);
            rows.ok_or_else(|| "more than 1 GiB".into())
        })
    }

    /// Unpacks all blocks.
    ///
    /// # Errors
    /// What was found, if one is broken, or they unpack to more than 1 GiB.
    pub(super) fn unpack(self) -> Result<Vec<RecordBatch>, String> {
        let mut left = MAX_BYTES;
        let mut batches = Vec::new();
        for (block, data) in &self.blocks {
            left = left.checked_sub(unpacked(data, block)?).ok_or("more than 1 GiB")?;
            let batch = self.decoder.read_record_batch(block, data);
            batches.extend(batch.map_err(|error| error.to_string())?);
        }
        Ok(batches)
    }
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

/// What a block says about itself.
fn message<'a>(data: &'a [u8], block: &Block) -> Result<Message<'a>, String> {
    let head = &data[..block.metaDataLength() as usize];
    let skip = if head.starts_with(&[0xff; 4]) { 8 } else { 4 };
    let message = head.get(skip..).ok_or("a block without a message")?;
    root_as_message(message).map_err(|error| error.to_string())
}

/// How many bytes the buffers of a block say that they unpack to, each of them within the block.
fn unpacked(data: &[u8], block: &Block) -> Result<u64, String> {
    let message = message(data, block)?;
    let batch = message.header_as_record_batch().ok_or("a block that is no batch")?;
    let body = &data[block.metaDataLength() as usize..];
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
