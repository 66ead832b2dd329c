//! A picture as a file's bytes.

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, RgbImage};

/// The bytes of a PNG file of a picture.
///
/// # Panics
/// If the picture has no pixels, which no PNG can say.
pub fn png(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    let (width, height) = picture.dimensions();
    PngEncoder::new(&mut bytes)
        .write_image(picture, width, height, ExtendedColorType::Rgb8)
        .expect("a picture with pixels, written to memory");
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_reads_back_as_the_picture() {
        let picture = RgbImage::from_fn(7, 3, |x, y| image::Rgb([x as u8, y as u8, 200]));
        let back = image::load_from_memory(&png(&picture)).unwrap().into_rgb8();
        assert_eq!(back, picture);
    }
}
