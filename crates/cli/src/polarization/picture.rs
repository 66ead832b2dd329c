//! Grey pictures, and what four of them tell of light.

use std::io::Cursor;

use image::{DynamicImage, ImageBuffer, ImageFormat, Luma};
use occlabel_core::Fault;
use occlabel_polarize::{Channels, Polarized, polarize};

use crate::decoded_image::decode_image;

/// What a step of 8 bits is in 16: white is white in both.
const STEP_OF_8_BITS: u16 = 257;

/// A grey picture of 16 bits.
pub(crate) struct Grey {
    place: String,
    size: (u32, u32),
    pixels: Vec<u16>,
}

impl Grey {
    /// A picture of 8 or 16 bits from its file; `place` names it in faults.
    ///
    /// # Errors
    /// If it is no picture, or not grey.
    pub(crate) fn decode(bytes: &[u8], place: &str) -> Result<Self, Fault> {
        let picture = decode_image(bytes, place)?;
        let size = (picture.width(), picture.height());
        let pixels = match picture {
            DynamicImage::ImageLuma8(grey) => {
                grey.into_raw().into_iter().map(|value| u16::from(value) * STEP_OF_8_BITS).collect()
            }
            DynamicImage::ImageLuma16(grey) => grey.into_raw(),
            other => {
                let found = format!("{:?}", other.color());
                return Err(Fault::new("image", place, "a grey picture of 8 or 16 bits", found));
            }
        };
        Ok(Self { place: place.to_owned(), size, pixels })
    }
}

/// How light is polarized in a picture.
pub(crate) struct PolarizedPicture {
    size: (u32, u32),
    pub(crate) light: Polarized,
}

impl PolarizedPicture {
    /// From pictures behind polarizers at 0, 45, 90 and 135 degrees.
    ///
    /// # Errors
    /// If they are not of one size.
    pub(crate) fn of(channels: &[Grey]) -> Result<Self, Fault> {
        let size = channels[0].size;
        if let Some(other) = channels.iter().find(|channel| channel.size != size) {
            let expected = format!("{} x {} pixels, as {}", size.0, size.1, channels[0].place);
            let found = format!("{} x {}", other.size.0, other.size.1);
            return Err(Fault::new("image-size", &other.place, expected, found));
        }
        let pixels = [0, 1, 2, 3].map(|at| &channels[at].pixels[..]);
        let channels = Channels::new(pixels).expect("four pictures of one size");
        Ok(Self { size, light: polarize(&channels) })
    }

    /// PNG files of 16 bits, by how their names end.
    pub(crate) fn files(&self) -> [(&'static str, Vec<u8>); 2] {
        [("dolp", &self.light.degree), ("aolp", &self.light.angle)]
            .map(|(ending, values)| (ending, png(values, self.size)))
    }
}

fn png(values: &[u16], (width, height): (u32, u32)) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let picture = ImageBuffer::<Luma<u16>, _>::from_raw(width, height, values);
    let picture = picture.expect("as many values as pixels");
    picture.write_to(&mut bytes, ImageFormat::Png).expect("a picture, written to memory");
    bytes.into_inner()
}
