//! The records within a chunk.

use std::io::Read;

use flate2::Crc;
use mcap::records::{ChunkHeader, Record};

use super::record::parse;

/// A record's kind and length.
const FRAMING_BYTES: usize = 9;

/// The bytes of a chunk, unpacked and verified by their checksum, if there is one.
///
/// They grow as they are unpacked: what the chunk declares only ends it.
///
/// # Errors
/// What was found, if they are not what the chunk declares.
pub(super) fn unpack(header: &ChunkHeader, packed: &[u8]) -> Result<Vec<u8>, String> {
    let declared = header.uncompressed_size;
    let bytes = match header.compression.as_str() {
        "" => packed.to_vec(),
        "zstd" => grow(zstd::Decoder::with_buffer(packed), declared)?,
        "lz4" => grow(lz4::Decoder::new(packed), declared)?,
        other => return Err(format!("compression `{other}`")),
    };
    if bytes.len() as u64 != declared {
        let which = if bytes.len() as u64 > declared { "more" } else { "fewer" };
        return Err(format!("{which} than the {declared} bytes that it declares"));
    }
    let mut crc = Crc::new();
    crc.update(&bytes);
    let is_sound = header.uncompressed_crc == 0 || header.uncompressed_crc == crc.sum();
    if is_sound { Ok(bytes) } else { Err("another checksum than it says".into()) }
}

/// Reads to the end, but not much beyond what is declared.
fn grow<R: Read>(unpacker: std::io::Result<R>, declared: u64) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let limit = declared.saturating_add(1);
    let read = unpacker.and_then(|unpacker| unpacker.take(limit).read_to_end(&mut bytes));
    read.map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// The records of a chunk's bytes; the last is an error if they are no records to the end.
pub(super) fn records(mut bytes: &[u8]) -> impl Iterator<Item = Result<Record<'_>, String>> {
    std::iter::from_fn(move || {
        if bytes.is_empty() {
            return None;
        }
        let record = next(&mut bytes);
        if record.is_err() {
            bytes = &[];
        }
        Some(record)
    })
}

fn next<'a>(bytes: &mut &'a [u8]) -> Result<Record<'a>, String> {
    let cut_off = || "a record beyond its end".to_owned();
    let ([kind, length @ ..], rest) =
        bytes.split_first_chunk::<FRAMING_BYTES>().ok_or_else(cut_off)?;
    let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| cut_off())?;
    let (body, rest) = rest.split_at_checked(length).ok_or_else(cut_off)?;
    *bytes = rest;
    parse(*kind, body)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(compression: &str, size: u64) -> ChunkHeader {
        ChunkHeader {
            message_start_time: 0,
            message_end_time: 0,
            uncompressed_size: size,
            uncompressed_crc: 0,
            compression: compression.into(),
            compressed_size: 0,
        }
    }

    fn lz4(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = lz4::EncoderBuilder::new().build(Vec::new()).unwrap();
        std::io::Write::write_all(&mut encoder, bytes).unwrap();
        encoder.finish().0
    }

    #[test]
    fn fault_34_a_chunk_gives_no_more_than_it_declares_and_takes_no_more_than_it_gives() {
        let zeros = vec![0; 1 << 22];
        let packed =
            [("zstd", zstd::encode_all(zeros.as_slice(), 3).unwrap()), ("lz4", lz4(&zeros))];
        for (compression, packed) in packed {
            assert!(packed.len() < 1 << 15, "{compression}: {}", packed.len());
            let unpacked = |size| unpack(&header(compression, size), &packed);
            assert_eq!(unpacked(1 << 22).unwrap().len(), 1 << 22);
            assert!(unpacked(1 << 10).unwrap_err().contains("more than the 1024 bytes"));
            assert!(unpacked(u64::MAX).unwrap_err().contains("fewer"), "{compression}");
        }
    }

    #[test]
    fn another_compression_is_named() {
        assert_eq!(unpack(&header("br", 0), &[]).unwrap_err(), "compression `br`");
        for compression in ["zstd", "lz4"] {
            assert!(unpack(&header(compression, 3), &[1, 2, 3]).is_err());
        }
    }

    #[test]
    fn records_end_with_what_is_none() {
        let record = |kind: u8, length: u64, body: &[u8]| {
            [&[kind][..], &length.to_le_bytes(), body].concat()
        };
        let whole = [record(0x80, 2, &[1, 2]), record(0x81, 0, &[])].concat();
        assert!(records(&whole).all(|record| record.is_ok()) && records(&whole).count() == 2);
        let giant = record(0x80, u64::MAX, &[]);
        for broken in [giant, record(0x80, 3, &[1, 2]), vec![0x80, 1], vec![0; 1 << 10]] {
            let both = [whole.as_slice(), &broken].concat();
            let read: Vec<_> = records(&both).collect();
            assert!(read.len() == 3 && read[2].is_err(), "{read:?}");
        }
    }
}
