//! Unpacking of LAZ (LASzip), record by record.

use std::io::{Cursor, Error, ErrorKind, Read, Result as IoResult, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

use laz::{LasZipDecompressor, LazVlr};

/// Where a header says how long it is, and how many variable records follow it.
const HEADER_BYTES_AT: usize = 94;
const RECORDS_AT: usize = 100;
/// Bytes of a variable record before its data.
const RECORD_HEAD_BYTES: usize = 54;

/// Unpacks so many records of so many bytes each. `head` are the file's bytes up to the first packed
/// one, `packed` those after it.
///
/// # Errors
/// What was found, if they do not unpack.
pub(super) fn unpack(
    head: &[u8],
    packed: Vec<u8>,
    [points, record_bytes]: [u64; 2],
    mut visit: impl FnMut(&[u8]),
) -> Result<(), String> {
    let description = description(head).ok_or("no record of LASzip")?;
    let mut record = vec![0; record_bytes as usize];
    // The library panics at some files that lie about themselves.
    let unpacked = catch_unwind(AssertUnwindSafe(|| {
        let vlr = LazVlr::from_buffer(description).map_err(|error| error.to_string())?;
        if vlr.items_size() != record_bytes {
            return Err(format!("{} bytes a packed record", vlr.items_size()));
        }
        let source = Forward(Cursor::new(packed));
        let mut unpacker =
            LasZipDecompressor::new(source, vlr).map_err(|error| error.to_string())?;
        for number in 0..points {
            let unpacked = unpacker.decompress_one(&mut record);
            unpacked.map_err(|error| format!("{error} at point {number} of {points}"))?;
            visit(&record);
        }
        Ok(())
    }));
    unpacked.unwrap_or_else(|_| Err("packed points that contradict themselves".into()))
}

/// The data of LASzip's own variable record.
fn description(head: &[u8]) -> Option<&[u8]> {
    let short = |at: usize| Some(usize::from(u16::from_le_bytes(*head.get(at..)?.first_chunk()?)));
    let count = u32::from_le_bytes(*head.get(RECORDS_AT..)?.first_chunk()?);
    let mut at = short(HEADER_BYTES_AT)?;
    for _ in 0..count {
        let (user, id, bytes) = (head.get(at + 2..at + 18)?, short(at + 18)?, short(at + 20)?);
        let data = head.get(at + RECORD_HEAD_BYTES..at + RECORD_HEAD_BYTES + bytes)?;
        if user.starts_with(LazVlr::USER_ID.as_bytes()) && id == usize::from(LazVlr::RECORD_ID) {
            return Some(data);
        }
        at += RECORD_HEAD_BYTES + bytes;
    }
    None
}

/// Bytes that are read onwards alone: then no table of chunks is looked for, whose length would have to
/// be believed.
struct Forward(Cursor<Vec<u8>>);

impl Read for Forward {
    fn read(&mut self, bytes: &mut [u8]) -> IoResult<usize> {
        self.0.read(bytes)
    }
}

impl Seek for Forward {
    fn seek(&mut self, _: SeekFrom) -> IoResult<u64> {
        Err(Error::from(ErrorKind::Unsupported))
    }
}

#[cfg(test)]
mod tests {
    use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlrBuilder};

    use super::super::las::{Las, sample};
    use super::*;

    /// A LAS file of as many points as wanted, packed in chunks of 3.
    fn packed(format: u8, points: usize) -> (Vec<u8>, Vec<u8>) {
        let loose = sample(format);
        let begin = u32::from_le_bytes(*loose[96..].first_chunk().unwrap()) as usize;
        let bytes = usize::from(u16::from_le_bytes(*loose[105..].first_chunk().unwrap()));
        let records: Vec<u8> =
            loose[begin..].iter().copied().cycle().take(points * bytes).collect();
        let items =
            LazItemRecordBuilder::default_for_point_format_id(format, bytes as u16 - least(format));
        let vlr = LazVlrBuilder::new(items.unwrap()).with_fixed_chunk_size(3).build();
        let mut data = Vec::new();
        vlr.write_to(&mut data).unwrap();
        let mut head = loose[..227].to_vec();
        let begin = 227 + RECORD_HEAD_BYTES + data.len();
        head[96..100].copy_from_slice(&(begin as u32).to_le_bytes());
        head[100..104].copy_from_slice(&1_u32.to_le_bytes());
        head[104] |= 0x80;
        head[107..111].copy_from_slice(&(points as u32).to_le_bytes());
        head.extend([0; 2]);
        head.extend(format!("{:\0<16}", LazVlr::USER_ID).bytes());
        head.extend(LazVlr::RECORD_ID.to_le_bytes());
        head.extend((data.len() as u16).to_le_bytes());
        head.extend([0; 32]);
        head.extend(data);
        let mut file = Cursor::new(head);
        file.set_position(begin as u64);
        let mut packer = LasZipCompressor::new(&mut file, vlr).unwrap();
        packer.compress_many(&records).unwrap();
        packer.done().unwrap();
        drop(packer);
        (file.into_inner(), records)
    }

    /// Bytes of a record without those that a format leaves to its users.
    fn least(format: u8) -> u16 {
        if format <= 5 { 20 } else { 30 }
    }

    fn classes(bytes: &[u8]) -> Result<Vec<f64>, String> {
        use super::super::columns::Column;
        let (mut reader, mut classes) = (bytes, Vec::new());
        let las = Las::open(&mut reader)?;
        las.read(&mut reader, |row| classes.push(row.get(Column::Class)))?;
        Ok(classes)
    }

    #[test]
    fn packed_points_are_those_that_were_packed() {
        for format in [0, 6] {
            let (bytes, records) = packed(format, 8);
            assert!(!records.is_empty());
            assert_eq!(classes(&bytes).unwrap(), [2.0, 6.0, 2.0, 6.0, 2.0, 6.0, 2.0, 6.0]);
        }
    }

    #[test]
    fn fault_34_damaged_packings_are_refused() {
        let (sound, _) = packed(6, 8);
        let mut refused = 0;
        for at in (96..sound.len()).step_by(5) {
            let mut broken = sound.clone();
            broken[at] ^= 0x55;
            refused += usize::from(classes(&broken).is_err());
        }
        assert!(refused > 10, "{refused}");
        assert!(classes(&sound[..sound.len() / 2]).is_err());
        let mut nameless = sound;
        nameless[229] = b'x';
        assert!(classes(&nameless).unwrap_err().contains("LASzip"));
    }
}
