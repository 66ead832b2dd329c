//! Blocks of large objects that readers jumped to: the next reader jumps there too.

use std::collections::{HashMap, VecDeque};

use object_store::path::Path as Key;

use super::ranged_file::{BLOCK_BYTES, Piece};

/// How many blocks are kept.
const COUNT: usize = 512;

/// The memory that these take at most.
pub(crate) const RECENT_BYTES: u64 = COUNT as u64 * BLOCK_BYTES;

/// The blocks that were fetched last, of objects that do not change.
#[derive(Debug, Default)]
pub(crate) struct Recent {
    blocks: HashMap<(Key, u64), Piece>,
    /// The oldest first.
    order: VecDeque<(Key, u64)>,
}

impl Recent {
    /// The block of an object that begins there.
    pub(crate) fn block(&self, key: &Key, from: u64) -> Option<Piece> {
        self.blocks.get(&(key.clone(), from)).cloned()
    }

    /// Keeps a block, in place of the oldest.
    pub(crate) fn keep(&mut self, key: &Key, block: &Piece) {
        let name = (key.clone(), block.from);
        if self.blocks.insert(name.clone(), block.clone()).is_none() {
            self.order.push_back(name);
        }
        if self.order.len() > COUNT
            && let Some(oldest) = self.order.pop_front()
        {
            self.blocks.remove(&oldest);
        }
    }
}
