//! From which state to which: occupied, free, unobserved.

use std::ops::AddAssign;

use serde::Serialize;

use super::comparer::ComparedLabels;

/// Voxels by their state in the first set (rows) and in the second: unobserved, free, occupied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StateCounts([[u64; 3]; 3]);

/// Voxels by state in both sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct StateChanges {
    /// Of the same state in both.
    pub same: u64,
    /// Occupied in the first, free in the second; the others alike.
    pub occupied_to_free: u64,
    /// See `occupied_to_free`.
    pub occupied_to_unobserved: u64,
    /// See `occupied_to_free`.
    pub free_to_occupied: u64,
    /// See `occupied_to_free`.
    pub free_to_unobserved: u64,
    /// See `occupied_to_free`.
    pub unobserved_to_occupied: u64,
    /// See `occupied_to_free`.
    pub unobserved_to_free: u64,
}

impl StateCounts {
    /// The states of two keyframes, if both tell what was observed. A class makes a voxel occupied
    /// whatever the mask says; voxels without a label in one of them are left out.
    pub(crate) fn of(a: &ComparedLabels, b: &ComparedLabels, free: u8) -> Option<Self> {
        let states = |labels: &ComparedLabels| {
            let mask = labels.mask_lidar?.values().iter();
            let ids = labels.semantics.values().iter();
            let states = ids.zip(mask).map(|(&id, &seen)| state(id, seen, free));
            Some(states.collect::<Vec<_>>())
        };
        let mut counts = Self::default();
        for (a, b) in states(a)?.into_iter().zip(states(b)?) {
            if let (Some(a), Some(b)) = (a, b) {
                counts.0[a][b] += 1;
            }
        }
        Some(counts)
    }

    /// By name.
    pub fn changes(&self) -> StateChanges {
        let [unobserved, free, occupied] = self.0;
        StateChanges {
            same: unobserved[0] + free[1] + occupied[2],
            occupied_to_free: occupied[1],
            occupied_to_unobserved: occupied[0],
            free_to_occupied: free[2],
            free_to_unobserved: free[0],
            unobserved_to_occupied: unobserved[2],
            unobserved_to_free: unobserved[1],
        }
    }
}

fn state(id: u8, seen: u8, free: u8) -> Option<usize> {
    match (id.cmp(&free), seen) {
        (std::cmp::Ordering::Less, _) => Some(2),
        (std::cmp::Ordering::Equal, 0) => Some(0),
        (std::cmp::Ordering::Equal, _) => Some(1),
        (std::cmp::Ordering::Greater, _) => None,
    }
}

impl AddAssign<&StateCounts> for StateCounts {
    fn add_assign(&mut self, other: &Self) {
        let pairs = self.0.iter_mut().flatten().zip(other.0.iter().flatten());
        pairs.for_each(|(sum, count)| *sum += count);
    }
}
