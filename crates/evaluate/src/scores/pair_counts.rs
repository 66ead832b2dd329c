//! How often each pair of ids occurs: the one loop over all voxels that mIoU needs.

/// Ids that a byte can hold.
const IDS: usize = 256;

/// Counters of a pair: neighbours have the same pair most of the time, and an addition would wait
/// for the one before it.
const LANES: usize = 4;

/// Counts of (truth, prediction), both as the file has them.
pub(crate) struct PairCounts(Vec<[u32; LANES]>);

impl PairCounts {
    pub(crate) fn new() -> Self {
        Self(vec![[0; LANES]; IDS * IDS])
    }

    /// Counts the pairs of voxels where the mask is not 0.
    pub(crate) fn count(&mut self, truth: &[u8], prediction: &[u8], mask: Option<&[u8]>) {
        match mask {
            Some(mask) => self.count_masked(truth, prediction, mask),
            None => self.count_all(truth, prediction),
        }
    }

    /// How often a pair was met.
    pub(crate) fn of(&self, truth: usize, prediction: usize) -> u64 {
        self.0[truth * IDS + prediction].iter().map(|&count| u64::from(count)).sum()
    }

    fn count_all(&mut self, truth: &[u8], prediction: &[u8]) {
        for (at, (&t, &p)) in truth.iter().zip(prediction).enumerate() {
            self.0[usize::from(t) * IDS + usize::from(p)][at % LANES] += 1;
        }
    }

    fn count_masked(&mut self, truth: &[u8], prediction: &[u8], mask: &[u8]) {
        for (at, ((&t, &p), &seen)) in truth.iter().zip(prediction).zip(mask).enumerate() {
            self.0[usize::from(t) * IDS + usize::from(p)][at % LANES] += u32::from(seen != 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn counts_are_those_of_asking_each_pair() {
        let counted = std::cell::Cell::new(0);
        let voxel = (0_u8..5, 250_u8..=255, 0_u8..3);
        proptest!(|(voxels in prop::collection::vec(voxel, 0..200), masked: bool)| {
            let truth: Vec<u8> = voxels.iter().map(|v| v.0).collect();
            let prediction: Vec<u8> = voxels.iter().map(|v| v.1).collect();
            let mask: Vec<u8> = voxels.iter().map(|v| v.2).collect();
            let mut counts = PairCounts::new();
            counts.count(&truth, &prediction, masked.then_some(&mask[..]));
            for t in 0..5 {
                for p in 250..=255 {
                    let is_it = |v: &&(u8, u8, u8)| (v.0, v.1) == (t, p) && (!masked || v.2 != 0);
                    let slow = voxels.iter().filter(is_it).count() as u64;
                    prop_assert_eq!(counts.of(t.into(), p.into()), slow);
                    counted.set(counted.get() + slow);
                }
            }
        });
        assert!(counted.get() > 5_000, "{} voxels", counted.get());
    }
}
