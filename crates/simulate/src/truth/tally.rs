//! Whose a voxel is.

use occlabel_core::{ClassId, ClassSet, TrackId};

use crate::{Drive, What};

/// How much of a voxel's surface, or volume, each part of the world has.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally(Vec<(What, f64)>);

impl Tally {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn add(&mut self, what: What, amount: f64) {
        match self.0.iter_mut().find(|(known, _)| *known == what) {
            Some((_, sum)) => *sum += amount,
            None => self.0.push((what, amount)),
        }
    }

    /// The classes of all parts.
    pub(super) fn classes(&self, drive: &Drive) -> ClassSet {
        self.0.iter().filter_map(|&(what, _)| drive.class_of(what)).collect()
    }

    /// The class that has most, the lowest on ties; and the mover that has most of it, if any.
    pub(super) fn winner(&self, drive: &Drive) -> (Option<ClassId>, Option<TrackId>) {
        let by_class = self.0.iter().map(|&(what, amount)| (drive.class_of(what), amount));
        let class = most(by_class);
        let of_class = self.0.iter().filter(|(what, _)| drive.class_of(*what) == class);
        (class, most(of_class.map(|&(what, amount)| (track_of(what), amount))))
    }
}

/// The key with the largest sum, the lowest on ties; `None` is no key.
fn most<K: Ord + Copy>(amounts: impl Iterator<Item = (Option<K>, f64)>) -> Option<K> {
    let mut sums: Vec<(K, f64)> = Vec::new();
    for (key, amount) in amounts {
        let Some(key) = key else { continue };
        match sums.iter_mut().find(|(known, _)| *known == key) {
            Some((_, sum)) => *sum += amount,
            None => sums.push((key, amount)),
        }
    }
    let best = sums.into_iter().reduce(|best, next| {
        let wins = next.1 > best.1 || (next.1 == best.1 && next.0 < best.0);
        if wins { next } else { best }
    });
    best.map(|(key, _)| key)
}

/// Movers are tracks in their order, from 1 on.
fn track_of(what: What) -> Option<TrackId> {
    let What::Mover(at) = what else { return None };
    u16::try_from(at + 1).ok().map(TrackId)
}
