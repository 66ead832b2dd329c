//! A file of a store that only grows: objects cannot be appended to.

use std::io::{self, Write};

use crate::storage::{Put, Storage};

/// Shorter files are put again whenever they have grown: a scene's journal is.
const SHORT_BYTES: usize = 256 << 10;

/// Longer ones once they have grown by a 16th: so all that is put is at most 17 times the file.
const GROWTH: usize = 16;

/// A file that is put as a whole, again and again.
#[derive(Debug)]
pub(crate) struct GrowingFile {
    object: Box<dyn Storage>,
    all: Vec<u8>,
    /// How much of it is in the store.
    stored: usize,
}

impl GrowingFile {
    /// Goes on where the object ends, which is there.
    pub(crate) fn open(object: Box<dyn Storage>) -> io::Result<Self> {
        let mut all = Vec::new();
        object.open()?.read_to_end(&mut all)?;
        Ok(Self { object, stored: all.len(), all })
    }

    pub(crate) fn bytes(&self) -> u64 {
        self.all.len() as u64
    }

    /// Leaves the first bytes alone.
    pub(crate) fn cut(&mut self, bytes: u64) -> io::Result<()> {
        self.all.truncate(bytes as usize);
        self.stored = self.stored.min(self.all.len());
        Ok(())
    }

    /// Puts it into the store, if it has grown enough.
    pub(crate) fn put(&mut self) -> io::Result<()> {
        let is_short = self.all.len() <= SHORT_BYTES;
        if !is_short && self.all.len() < self.stored + self.stored / GROWTH {
            return Ok(());
        }
        self.object.put(&mut self.all.as_slice(), self.bytes(), &Put::Over)?;
        self.stored = self.all.len();
        Ok(())
    }
}

impl Write for GrowingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.all.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
