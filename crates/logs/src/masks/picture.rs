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
