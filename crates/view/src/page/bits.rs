//! Bits in a row.

/// Bits in a row, the first in the lowest place of the first byte.
#[derive(Default)]
pub(crate) struct BitWriter {
    bytes: Vec<u8>,
    /// Bits that do not fill a byte yet, and how many.
    open: (u64, u32),
}

impl BitWriter {
    /// Adds the lowest `count` bits of `value`, at most 32.
    pub(crate) fn push(&mut self, value: u32, count: u32) {
        let (open, held) = &mut self.open;
        *open |= (u64::from(value) & ((1 << count) - 1)) << *held;
        *held += count;
        while *held >= 8 {
            self.bytes.push(*open as u8);
            *open >>= 8;
            *held -= 8;
        }
    }

    /// All bits, the last byte filled up with zeros.
    pub(crate) fn bytes(mut self) -> Vec<u8> {
        if self.open.1 > 0 {
            self.bytes.push(self.open.0 as u8);
        }
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_stand_in_a_row() {
        let mut bits = BitWriter::default();
        for (value, count) in [(1, 1), (0b10, 2), (0xfff, 0), (0b1_0000_0001, 9), (0b11, 2)] {
            bits.push(value, count);
        }
        assert_eq!(bits.bytes(), [0b0000_1101, 0b0011_1000]);
    }
}
