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

#[cfg(test)]
mod tests {
    use image::RgbImage;

    use super::*;

    #[test]
    fn an_image_that_says_it_is_absurdly_large_is_refused() {
        let mut bytes = occlabel_view::png(&RgbImage::new(2, 2));
        bytes[16..20].copy_from_slice(&2_000_000_000_u32.to_be_bytes());
        let crc = crc_of(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        let fault = decode_image(&bytes, "a.png").unwrap_err();
        assert!(fault.to_string().starts_with("a.png: expected a JPEG or PNG of at most 16384"));
        assert!(
            decode_image(&[0xff, 0xd8, 0xff], "b.jpg").is_err()
                && decode_image(b"", "c.jpg").is_err()
        );
    }

    /// That of PNG, bit by bit.
    fn crc_of(bytes: &[u8]) -> u32 {
        let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
    }

    #[test]
    fn a_jpeg_is_read() {
        let mut bytes = Cursor::new(Vec::new());
        let red = RgbImage::from_pixel(16, 8, image::Rgb([200, 20, 10]));
        red.write_to(&mut bytes, image::ImageFormat::Jpeg).unwrap();
        let back = decode_image(bytes.get_ref(), "a.jpg").unwrap().into_rgb8();
        assert_eq!(back.dimensions(), (16, 8));
        assert!(back.pixels().all(|p| p.0[0] > 190 && p.0[1] < 35 && p.0[2] < 25));
    }
}
