//! An object that is read by ranges.

use std::io::{self, ErrorKind, Read, Seek, SeekFrom};

use bytes::Bytes;
use object_store::Result as StoreResult;
use tokio::task::JoinHandle;

use super::connection::{begin, locked, wait_for};
use super::errors::io_error;
use super::object::Object;
use crate::storage::StoredFile;

/// What is asked for when a file is opened: most sweeps and labels are shorter.
pub(crate) const FIRST_BYTES: u64 = 1 << 20;

/// What is asked for at least where a reader jumps to, who may jump on: of a large object, the block that
/// begins at a multiple of this.
pub(crate) const BLOCK_BYTES: u64 = 64 << 10;

/// What is asked for at most, of one who reads on and on.
const MAX_BYTES: u64 = 4 << 20;

/// What a reader holds at most: a window, and the next one.
pub(crate) const READER_BYTES: u64 = 2 * MAX_BYTES;

/// A part of an object.
#[derive(Clone, Debug, Default)]
pub(crate) struct Piece {
    /// Where it begins.
    pub(crate) from: u64,
    pub(crate) bytes: Bytes,
    /// Of the whole object.
    pub(crate) all_bytes: u64,
    pub(crate) version: Option<String>,
}

/// An object, of which a window is held, and the next one may be on its way.
#[derive(Debug)]
pub(crate) struct RangedFile {
    object: Object,
    /// Nothing of it is held before it is read.
    window: Piece,
    next: Option<Next>,
    /// How much was asked for last.
    asked_bytes: u64,
    at: u64,
}

#[derive(Debug)]
struct Next {
    from: u64,
    answer: JoinHandle<StoreResult<Piece>>,
}

impl RangedFile {
    /// Opens it by its beginning.
    pub(crate) fn open(object: Object) -> StoreResult<Self> {
        let piece = wait_for(object.connection.piece(&object.key, 0, FIRST_BYTES, None))?;
        Ok(Self::of(object, piece))
    }

    /// An object of which the beginning is here.
    pub(crate) fn of(object: Object, window: Piece) -> Self {
        Self { object, window, next: None, asked_bytes: FIRST_BYTES, at: 0 }
    }

    /// An object that is there, of so many bytes.
    pub(crate) fn unread(object: Object, all_bytes: u64) -> Self {
        Self::of(object, Piece { all_bytes, ..Piece::default() })
    }

    /// The bytes from here on that the window holds.
    fn held(&self) -> &[u8] {
        let Some(skipped) = self.at.checked_sub(self.window.from) else { return &[] };
        self.window.bytes.get(skipped as usize..).unwrap_or_default()
    }

    /// Moves the window here, for a reader who wants so many bytes.
    fn fill(&mut self, wanted: u64) -> io::Result<()> {
        let reads_on = self.at > 0 && self.at == self.window.end();
        let piece = match self.next.take() {
            Some(next) if next.from == self.at => wait_for(next.answer)?,
            unwanted => {
                unwanted.inspect(|next| next.answer.abort());
                self.fetch(reads_on, wanted)
            }
        };
        let piece = piece.map_err(io_error)?;
        if piece.all_bytes != self.len() || piece.end() <= self.at {
            return Err(io::Error::new(ErrorKind::UnexpectedEof, "another length than before"));
        }
        self.window = piece;
        let end = self.window.end();
        if reads_on && end < self.len() {
            self.asked_bytes = MAX_BYTES.min(2 * self.asked_bytes);
            self.next = Some(Next { from: end, answer: begin(self.request(end)) });
        }
        Ok(())
    }

    /// More than the last time for who reads on; all of a short object; a block for who jumps.
    fn fetch(&mut self, reads_on: bool, wanted: u64) -> StoreResult<Piece> {
        let is_short = self.len() <= MAX_BYTES;
        self.asked_bytes = match reads_on {
            true => MAX_BYTES.min(2 * self.asked_bytes),
            false if self.at == 0 && is_short => self.len(),
            false => BLOCK_BYTES,
        };
        if !reads_on && !is_short && wanted < BLOCK_BYTES {
            return self.block();
        }
        self.asked_bytes = self.asked_bytes.max(wanted.min(MAX_BYTES));
        wait_for(self.request(self.at))
    }

    /// The block that is here, which may have been fetched before.
    fn block(&self) -> StoreResult<Piece> {
        let Object { connection, key } = &self.object;
        let from = self.at - self.at % BLOCK_BYTES;
        let known = locked(&connection.recent).block(key, from);
        if let Some(block) = known.filter(|block| block.is_of(&self.window)) {
            return Ok(block);
        }
        let block = wait_for(self.request(from))?;
        locked(&connection.recent).keep(key, &block);
        Ok(block)
    }

    /// The next window from there, of the version that was opened.
    fn request(&self, from: u64) -> impl Future<Output = StoreResult<Piece>> + Send + 'static {
        let Object { connection, key } = self.object.clone();
        let (to, version) = (from + self.asked_bytes, self.window.version.clone());
        async move { connection.piece(&key, from, to, version).await }
    }
}

impl Piece {
    /// Whether two pieces are of the same object and version, as far as one of nothing tells.
    fn is_of(&self, other: &Self) -> bool {
        other.version.as_ref().is_none_or(|version| self.version.as_ref() == Some(version))
    }

    fn end(&self) -> u64 {
        self.from + self.bytes.len() as u64
    }
}

impl Drop for RangedFile {
    fn drop(&mut self) {
        self.next.take().inspect(|next| next.answer.abort());
    }
}

impl StoredFile for RangedFile {
    fn len(&self) -> u64 {
        self.window.all_bytes
    }

    fn version(&self) -> Option<&str> {
        self.window.version.as_deref()
    }
}

impl Read for RangedFile {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if bytes.is_empty() || self.at >= self.len() {
            return Ok(0);
        }
        if self.held().is_empty() {
            self.fill(bytes.len() as u64)?;
        }
        let held = self.held();
        let count = held.len().min(bytes.len());
        bytes[..count].copy_from_slice(&held[..count]);
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for RangedFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let at = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::End(by) => self.len().checked_add_signed(by),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
        };
        self.at = at.ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "before the file"))?;
        Ok(self.at)
    }
}
