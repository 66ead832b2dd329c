//! Protobuf's wire format, as far as it is written here.
//!
//! Source: protobuf.dev, "Encoding".

/// A message that grows field by field.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wire(Vec<u8>);

const VARINT: u64 = 0;
const FIXED64: u64 = 1;
const LENGTH: u64 = 2;
const FIXED32: u64 = 5;

impl Wire {
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.0
    }

    pub(crate) fn integer(mut self, field: u64, value: u64) -> Self {
        self.tag(field, VARINT);
        self.varint(value);
        self
    }

    pub(crate) fn fixed32(mut self, field: u64, value: u32) -> Self {
        self.tag(field, FIXED32);
        self.0.extend(value.to_le_bytes());
        self
    }

    pub(crate) fn double(mut self, field: u64, value: f64) -> Self {
        self.tag(field, FIXED64);
        self.0.extend(value.to_le_bytes());
        self
    }

    /// A packed list.
    pub(crate) fn doubles(self, field: u64, values: &[f64]) -> Self {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.data(field, &bytes)
    }

    /// A packed list.
    pub(crate) fn floats(self, field: u64, values: &[f32]) -> Self {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.data(field, &bytes)
    }

    /// A packed list; what is below 0 takes 10 bytes.
    pub(crate) fn integers(self, field: u64, values: &[i32]) -> Self {
        let mut packed = Wire::default();
        values.iter().for_each(|&value| packed.varint(i64::from(value) as u64));
        self.data(field, &packed.0)
    }

    pub(crate) fn text(self, field: u64, text: &str) -> Self {
        self.data(field, text.as_bytes())
    }

    pub(crate) fn data(mut self, field: u64, bytes: &[u8]) -> Self {
        self.tag(field, LENGTH);
        self.varint(bytes.len() as u64);
        self.0.extend_from_slice(bytes);
        self
    }

    pub(crate) fn message(self, field: u64, message: &Wire) -> Self {
        self.data(field, &message.0)
    }

    /// A field that is there any number of times.
    pub(crate) fn messages(self, field: u64, messages: impl Iterator<Item = Wire>) -> Self {
        messages.fold(self, |wire, message| wire.message(field, &message))
    }

    fn tag(&mut self, field: u64, kind: u64) {
        self.varint(field << 3 | kind);
    }

    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_encoded_as_the_specification_shows() {
        assert_eq!(Wire::default().integer(1, 150).bytes(), [0x08, 0x96, 0x01]);
        let text = [0x12, 0x07, 0x74, 0x65, 0x73, 0x74, 0x69, 0x6e, 0x67];
        assert_eq!(Wire::default().text(2, "testing").bytes(), text);
        let inner = Wire::default().integer(1, 150);
        assert_eq!(Wire::default().message(3, &inner).bytes(), [0x1a, 0x03, 0x08, 0x96, 0x01]);
        let packed = [0x32, 0x06, 0x03, 0x8e, 0x02, 0x9e, 0xa7, 0x05];
        assert_eq!(Wire::default().integers(6, &[3, 270, 86942]).bytes(), packed);
        let minus_one = [&[0x0a, 0x0a][..], &[0xff; 9], &[0x01]].concat();
        assert_eq!(Wire::default().integers(1, &[-1]).bytes(), minus_one);
        assert_eq!(Wire::default().floats(1, &[1.5]).bytes(), [0x0a, 4, 0, 0, 0xc0, 0x3f]);
    }
}
