//! Pictures as PNG files.

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

/// The bytes of a PNG; `pixels` are rows of what `color` says, of exactly this size.
pub(crate) fn png(pixels: &[u8], [width, height]: [u32; 2], color: ExtendedColorType) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(pixels, width, height, color)
        .expect("an image of the size that it says fits into memory");
    bytes
}
