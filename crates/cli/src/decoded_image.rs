//! A picture from the bytes of a file.

use std::io::Cursor;

use image::{DynamicImage, ImageReader, Limits};
use occlabel_core::Fault;

/// Images that say they are larger are refused before anything is taken for them.
const MOST_SIDE_PX: u32 = 16_384;
const MOST_IMAGE_BYTES: u64 = 1 << 30;

/// A JPEG's or PNG's picture; `place` names it in faults.
///
/// # Errors
/// If it is none, or larger than 16384 x 16384 pixels.
pub(crate) fn decode_image(bytes: &[u8], place: &str) -> Result<DynamicImage, Fault> {
    let fault = |error: String| {
        let expected = format!("a JPEG or PNG of at most {MOST_SIDE_PX} x {MOST_SIDE_PX} pixels");
        Fault::new("image", place, expected, error)
    };
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_SIDE_PX);
    limits.max_image_height = Some(MOST_SIDE_PX);
    limits.max_alloc = Some(MOST_IMAGE_BYTES);
    let mut reader = ImageReader::new(Cursor::new(bytes));
    reader.limits(limits);
    let reader = reader.with_guessed_format().map_err(|error| fault(error.to_string()))?;
    reader.decode().map_err(|error| fault(error.to_string()))
}
