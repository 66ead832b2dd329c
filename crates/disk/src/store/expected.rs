//! Objects that are fetched before they are asked for.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use futures_util::FutureExt;
use futures_util::future::BoxFuture;
use object_store::path::Path as Key;
use object_store::{Error, Result as StoreResult};
use tokio::task::JoinHandle;

use super::connection::{Connection, begin};
use super::ranged_file::Piece;

/// How many of the next objects are fetched ahead of each that is read.
const AHEAD: usize = 16;

/// Larger objects are read by ranges.
pub(crate) const MAX_OBJECT_BYTES: u64 = 8 << 20;

/// All that is fetched ahead, and not yet read, has at most so many bytes.
pub(crate) const MAX_AHEAD_BYTES: u64 = 64 << 20;

/// The order in which objects will be read, and those that are on their way.
///
/// Whoever reads one has the next ones of the order fetched: so several who read in several places of the
/// order each find theirs.
#[derive(Debug, Default)]
pub(crate) struct Expected {
    order: Vec<(Key, u64)>,
    /// Places in the order of those that were not read yet.
    places: HashMap<Key, usize>,
    fetched: BTreeMap<usize, Fetched>,
    bytes: u64,
}

#[derive(Debug)]
struct Fetched {
    bytes: u64,
    piece: JoinHandle<StoreResult<Piece>>,
}

impl Expected {
    /// Expects these, with their sizes, in place of others.
    pub(crate) fn replace(&mut self, order: Vec<(Key, u64)>) {
        let mut fetched = BTreeMap::new();
        let places: HashMap<Key, usize> =
            order.iter().enumerate().map(|(at, (key, _))| (key.clone(), at)).collect();
        for (at, one) in std::mem::take(&mut self.fetched) {
            match places.get(&self.order[at].0) {
                Some(&now) => drop(fetched.insert(now, one)),
                None => one.piece.abort(),
            }
        }
        self.bytes = fetched.values().map(|one| one.bytes).sum();
        (self.order, self.places, self.fetched) = (order, places, fetched);
    }

    /// The object, if it is on its way; the next ones are sent for.
    pub(crate) fn take(
        &mut self,
        from: &Arc<Connection>,
        key: &Key,
    ) -> Option<BoxFuture<'static, StoreResult<Piece>>> {
        let at = self.places.remove(key)?;
        let taken = self.fetched.remove(&at);
        self.bytes -= taken.as_ref().map_or(0, |one| one.bytes);
        for next in at + 1..self.order.len().min(at + 1 + AHEAD) {
            self.fetch(from, next);
        }
        Some(taken?.piece.map(|piece| piece.unwrap_or_else(|error| Err(lost(error)))).boxed())
    }

    /// How many are on their way, or here.
    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.fetched.len()
    }

    /// Their bytes.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    fn fetch(&mut self, from: &Arc<Connection>, at: usize) {
        let (key, bytes) = self.order[at].clone();
        let is_wanted = self.places.contains_key(&key) && !self.fetched.contains_key(&at);
        let is_small = bytes <= MAX_OBJECT_BYTES && self.bytes + bytes <= MAX_AHEAD_BYTES;
        if !is_wanted || !is_small {
            return;
        }
        self.bytes += bytes;
        let from = from.clone();
        // An object without bytes has no range to ask for.
        let piece = begin(async move { from.piece(&key, 0, bytes.max(1), None).await });
        self.fetched.insert(at, Fetched { bytes, piece });
    }
}

fn lost(error: tokio::task::JoinError) -> Error {
    Error::JoinError { source: error }
}
