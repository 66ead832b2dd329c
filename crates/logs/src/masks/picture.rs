//! The pixels of a PNG as it has them: numbers stay numbers, those of a palette too.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

/// The pixels of an image, by rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Picture {
    /// Grey values or places in a palette.
    Numbers(Vec<u16>),
    /// Red, green and blue.
    Colours(Vec<[u8; 3]>),
}

impl Picture {
    /// The pixels of a PNG of this width and height.
    ///
    /// # Errors
    /// What was found instead.
    pub(super) fn decode(bytes: &[u8], [width, height]: [u32; 2]) -> Result<Self, String> {
        let pixels = width as usize * height as usize;
        let limits = Limits { bytes: 8 * pixels + (1 << 20) };
        let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
        decoder.set_transformations(Transformations::IDENTITY);
        let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
        let info = reader.info();
        if (info.width, info.height) != (width, height) {
            return Err(format!("{} x {} pixels", info.width, info.height));
        }
        let mut data = vec![0; reader.output_buffer_size().ok_or("an image too large")?];
        let frame = reader.next_frame(&mut data).map_err(|error| error.to_string())?;
        let rows = data.chunks_exact(frame.line_size).take(height as usize);
        let row = |row: &[u8]| unpack(row, frame.bit_depth as usize, width as usize);
        match (frame.color_type, frame.bit_depth) {
            (ColorType::Grayscale | ColorType::Indexed, BitDepth::Sixteen) => {
                Ok(Self::Numbers(rows.flat_map(wide).collect()))
            }
            (ColorType::Grayscale | ColorType::Indexed, _) => {
                Ok(Self::Numbers(rows.flat_map(row).collect()))
            }
            (ColorType::Rgb, BitDepth::Eight) => {
                Ok(Self::Colours(rows.flat_map(colours::<3>).collect()))
            }
            (ColorType::Rgba, BitDepth::Eight) => {
                Ok(Self::Colours(rows.flat_map(colours::<4>).collect()))
            }
            (color, depth) => Err(format!("{color:?} of {} bits", depth as u8)),
        }
    }

    /// The numbers; `None` of colours.
    pub(super) fn into_numbers(self) -> Option<Vec<u16>> {
        match self {
            Self::Numbers(numbers) => Some(numbers),
            Self::Colours(_) => None,
        }
    }
}

/// Numbers of 1, 2, 4 or 8 bits, the highest bits of a byte first.
fn unpack(row: &[u8], bits: usize, width: usize) -> Vec<u16> {
    let a_byte = 8 / bits;
    let mask = (1_u16 << bits) - 1;
    let number = |at: usize| {
        let shift = 8 - bits * (at % a_byte + 1);
        u16::from(row[at / a_byte]) >> shift & mask
    };
    (0..width).map(number).collect()
}

fn wide(row: &[u8]) -> Vec<u16> {
    row.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect()
}

fn colours<const N: usize>(row: &[u8]) -> Vec<[u8; 3]> {
    row.chunks_exact(N).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PNG of these bytes a row.
    fn png(color: ColorType, depth: BitDepth, [width, height]: [u32; 2], data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![9; 3 * 16]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    fn decoded(color: ColorType, depth: BitDepth, data: &[u8]) -> Result<Picture, String> {
        Picture::decode(&png(color, depth, [3, 2], data), [3, 2])
    }

    #[test]
    fn numbers_stay_as_they_are_those_of_a_palette_too() {
        let bytes = [0, 7, 255, 3, 3, 1];
        let numbers = Ok(Picture::Numbers(bytes.map(u16::from).to_vec()));
        assert_eq!(decoded(ColorType::Grayscale, BitDepth::Eight, &bytes), numbers);
        let packed = [0x12, 0x30, 0xf0, 0x50];
        let numbers = Ok(Picture::Numbers(vec![1, 2, 3, 15, 0, 5]));
        assert_eq!(decoded(ColorType::Indexed, BitDepth::Four, &packed), numbers);
        let bits = [0b1010_0000, 0b0110_0000];
        let numbers = Ok(Picture::Numbers(vec![1, 0, 1, 0, 1, 1]));
        assert_eq!(decoded(ColorType::Grayscale, BitDepth::One, &bits), numbers);
        let wide = [0, 1, 1, 0, 255, 255, 0, 0, 0, 2, 3, 4];
        let numbers = Ok(Picture::Numbers(vec![1, 256, 65535, 0, 2, 772]));
        assert_eq!(decoded(ColorType::Grayscale, BitDepth::Sixteen, &wide), numbers);
    }

    #[test]
    fn colours_are_red_green_blue() {
        let bytes: Vec<u8> = (0..18).collect();
        let Ok(Picture::Colours(colours)) = decoded(ColorType::Rgb, BitDepth::Eight, &bytes) else {
            panic!("colours")
        };
        assert_eq!((colours.len(), colours[0], colours[5]), (6, [0, 1, 2], [15, 16, 17]));
        let bytes: Vec<u8> = (0..24).collect();
        let Ok(Picture::Colours(colours)) = decoded(ColorType::Rgba, BitDepth::Eight, &bytes)
        else {
            panic!("colours")
        };
        assert_eq!(colours[5], [20, 21, 22]);
    }

    #[test]
    fn fault_34_other_sizes_and_broken_files_are_refused() {
        let small = png(ColorType::Grayscale, BitDepth::Eight, [3, 2], &[0; 6]);
        assert_eq!(Picture::decode(&small, [2, 3]), Err("3 x 2 pixels".into()));
        let mut giant = small.clone();
        giant[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        assert!(Picture::decode(&giant, [3, 2]).is_err());
        for length in 0..small.len() - 12 {
            assert!(Picture::decode(&small[..length], [3, 2]).is_err(), "{length} bytes");
        }
        assert!(decoded(ColorType::Rgb, BitDepth::Sixteen, &[0; 36]).is_err());
    }
}
