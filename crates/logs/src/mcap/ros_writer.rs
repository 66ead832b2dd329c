//! ROS messages, written as their definitions say.

use super::ros::Layout;

/// A message that grows.
pub(super) struct Writer {
    pub(super) layout: Layout,
    bytes: Vec<u8>,
}

impl Writer {
    pub(super) fn new(layout: Layout) -> Self {
        Self { layout, bytes: Vec::new() }
    }

    pub(super) fn number<const N: usize>(&mut self, bytes: [u8; N]) -> &mut Self {
        if self.layout == Layout::Cdr {
            self.bytes.resize(self.bytes.len().next_multiple_of(N), 0);
        }
        self.bytes.extend(bytes);
        self
    }

    pub(super) fn u8(&mut self, value: u8) -> &mut Self {
        self.number([value])
    }

    pub(super) fn u32(&mut self, value: u32) -> &mut Self {
        self.number(value.to_le_bytes())
    }

    pub(super) fn f64s(&mut self, values: &[f64]) -> &mut Self {
        values.iter().for_each(|value| {
            self.number(value.to_le_bytes());
        });
        self
    }

    pub(super) fn text(&mut self, text: &str) -> &mut Self {
        let zero = usize::from(self.layout == Layout::Cdr);
        self.u32((text.len() + zero) as u32).bytes.extend(text.bytes());
        self.bytes.resize(self.bytes.len() + zero, 0);
        self
    }

    pub(super) fn blob(&mut self, bytes: &[u8]) -> &mut Self {
        self.u32(bytes.len() as u32).bytes.extend(bytes);
        self
    }

    pub(super) fn header(&mut self, frame: &str) -> &mut Self {
        self.header_at(12_000_000_034, frame)
    }

    pub(super) fn header_at(&mut self, time_ns: i64, frame: &str) -> &mut Self {
        if self.layout == Layout::Ros1 {
            self.u32(77);
        }
        self.u32((time_ns / 1_000_000_000) as u32).u32((time_ns % 1_000_000_000) as u32).text(frame)
    }

    pub(super) fn finish(&self) -> Vec<u8> {
        let head: &[u8] = if self.layout == Layout::Cdr { &[0, 1, 0, 0] } else { &[] };
        [head, &self.bytes].concat()
    }
}
