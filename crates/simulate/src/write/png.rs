//! Pictures as PNG files.

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use occlabel_core::camera::BodyMask;

/// The bytes of a PNG; `pixels` are rows of what `color` says, of exactly this size.
pub(crate) fn png(pixels: &[u8], [width, height]: [u32; 2], color: ExtendedColorType) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(pixels, width, height, color)
        .expect("an image of the size that it says fits into memory");
    bytes
}

/// A mask as an 8-bit PNG: 255 on the vehicle's own body.
pub(crate) fn mask_png(mask: &BodyMask) -> Vec<u8> {
    let (width, height) = (mask.width(), mask.height());
    let row = |row| (0..width).map(move |column| 255 * u8::from(mask.covers(column, row)));
    let pixels: Vec<u8> = (0..height).flat_map(row).collect();
    png(&pixels, [width, height], ExtendedColorType::L8)
}
