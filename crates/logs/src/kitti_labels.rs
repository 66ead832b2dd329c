//! Labels of points as files of KITTI's kind have them.

use occlabel_core::Fault;

/// Nobody labelled the point.
const UNLABELED: i64 = 0;

/// The raw classes of `count` points from a file of 32-bit little-endian numbers: the class in the
/// lower half, the instance in the upper one.
///
/// # Errors
/// If there is not one label for each point.
pub(crate) fn decode_labels(bytes: &[u8], file: &str, count: usize) -> Result<Vec<u16>, Fault> {
    if bytes.len() != 4 * count {
        let expected = format!("{} bytes, a label for each of {count} points", 4 * count);
        return Err(Fault::new("label-count", file, expected, format!("{} bytes", bytes.len())));
    }
    Ok(bytes.chunks_exact(4).map(|word| u16::from_le_bytes([word[0], word[1]])).collect())
}

/// What a class is called: as `known` says, else its number; none where nobody labelled the point.
pub(crate) fn class_name(raw: i64, known: fn(u16) -> Option<&'static str>) -> Option<String> {
    let name = u16::try_from(raw).ok().and_then(known);
    (raw != UNLABELED).then(|| name.map_or_else(|| raw.to_string(), str::to_owned))
}
