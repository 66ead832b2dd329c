//! TFRecord files: each record between its length and checksums (tensorflow.org, "TFRecord").

use occlabel_core::Fault;

use crate::write::files::OutputFile;

/// Appends a record.
pub(super) fn write_record(file: &mut OutputFile, data: &[u8]) -> Result<(), Fault> {
    let length = (data.len() as u64).to_le_bytes();
    file.write(&length)?;
    file.write(&masked_checksum(&length))?;
    file.write(data)?;
    file.write(&masked_checksum(data))
}

/// CRC-32C, turned and shifted so that a checksum of data that holds checksums is none of theirs.
fn masked_checksum(bytes: &[u8]) -> [u8; 4] {
    crc32c::crc32c(bytes).rotate_right(15).wrapping_add(0xa282_ead8).to_le_bytes()
}
