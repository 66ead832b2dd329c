//! Exact distances between voxel centres.

use occlabel_core::GridSpec;

/// For each asked voxel, in flat order, the squared distance from its centre to the nearest marked
/// voxel's centre, m2; infinite if none is marked.
///
/// Axis by axis (Felzenszwalb & Huttenlocher 2012): along z the nearest marked voxel of each column,
/// then along y and x the lower envelope of a parabola over each voxel.
pub(crate) fn squared_to_nearest(marked: &[bool], asked: &[bool], spec: &GridSpec) -> Vec<f64> {
    let [nx, ny, nz] = spec.shape();
    let size_m = spec.size_m();
    let mut squared = along_z(marked, nz, size_m.z);
    let mut envelope = Envelope::default();
    for slice in squared.chunks_mut(ny * nz) {
        for z in 0..nz {
            envelope.relax(slice, z, nz, size_m.y, |_| true);
        }
    }
    for column in 0..ny * nz {
        if (0..nx).any(|x| asked[x * ny * nz + column]) {
            envelope.relax(&mut squared, column, ny * nz, size_m.x, |at| asked[at]);
        }
    }
    asked.iter().zip(squared).filter(|(asked, _)| **asked).map(|(_, squared)| squared).collect()
}

/// Within columns of `nz` voxels.
fn along_z(marked: &[bool], nz: usize, size_m: f64) -> Vec<f64> {
    let mut squared = vec![f64::INFINITY; marked.len()];
    for (column, marks) in squared.chunks_mut(nz).zip(marked.chunks(nz)) {
        let mut steps = f64::INFINITY;
        for z in 0..nz {
            steps = if marks[z] { 0.0 } else { steps + 1.0 };
            column[z] = steps;
        }
        steps = f64::INFINITY;
        for z in (0..nz).rev() {
            steps = if marks[z] { 0.0 } else { steps + 1.0 };
            let m = column[z].min(steps) * size_m;
            column[z] = m * m;
        }
    }
    squared
}

/// The lower envelope of the parabolas over a line of voxels.
#[derive(Default)]
struct Envelope {
    /// Which voxel's parabola is lowest, from which place on, and how high it stands.
    lowest: Vec<(usize, f64, f64)>,
}

impl Envelope {
    /// Replaces each value of a line, where asked, by the lowest parabola's value there.
    fn relax(
        &mut self,
        values: &mut [f64],
        first: usize,
        stride: usize,
        size_m: f64,
        is_asked: impl Fn(usize) -> bool,
    ) {
        let weight = size_m * size_m;
        self.lowest.clear();
        for (place, height) in values[first..].iter().step_by(stride).enumerate() {
            if height.is_finite() {
                self.push(place, *height / weight);
            }
        }
        if self.lowest.is_empty() {
            return;
        }
        let mut at = 0;
        for (place, flat) in (first..values.len()).step_by(stride).enumerate() {
            if is_asked(flat) {
                while self.lowest.get(at + 1).is_some_and(|next| next.1 <= place as f64) {
                    at += 1;
                }
                let (under, _, height) = self.lowest[at];
                let steps = place as f64 - under as f64;
                values[flat] = (steps * steps + height) * weight;
            }
        }
    }

    /// Adds the parabola over a place behind all others.
    fn push(&mut self, place: usize, height: f64) {
        let mut from = f64::NEG_INFINITY;
        while let Some(&(under, since, other)) = self.lowest.last() {
            let (p, u) = (place as f64, under as f64);
            from = ((height + p * p) - (other + u * u)) / (2.0 * (p - u));
            if from > since {
                break;
            }
            self.lowest.pop();
            from = f64::NEG_INFINITY;
        }
        self.lowest.push((place, from, height));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use proptest::prelude::*;
    use std::cell::Cell;

    fn by_trying_all(marked: &[bool], asked: &[bool], spec: &GridSpec) -> Vec<f64> {
        let centres: Vec<_> = spec.voxels().map(|voxel| spec.centre(voxel)).collect();
        let of = |set: &[bool]| -> Vec<_> {
            centres.iter().zip(set).filter(|(_, is)| **is).map(|(centre, _)| *centre).collect()
        };
        let (from, to) = (of(asked), of(marked));
        let nearest = |p: &Point3<f64>| {
            to.iter().map(|q| (p - q).norm_squared()).fold(f64::INFINITY, f64::min)
        };
        from.iter().map(nearest).collect()
    }

    #[test]
    fn distances_are_those_of_trying_all() {
        let (finite, endless) = (Cell::new(0), Cell::new(0));
        let sides = (1_usize..9, 1_usize..9, 1_usize..6);
        let shares = prop_oneof![1 => Just(0_u64), 5 => 0_u64..40];
        let seeds = (any::<u64>(), shares, any::<u64>());
        let sizes = prop::array::uniform3(prop_oneof![Just(0.4), Just(0.1), 0.1..2.0_f64]);
        proptest!(|((nx, ny, nz) in sides, (a, share, b) in seeds, size_m in sizes)| {
            let shape = [nx, ny, nz];
            let max_m = std::array::from_fn(|axis| shape[axis] as f64 * size_m[axis]);
            let spec = GridSpec::new([0.0; 3], max_m, size_m).unwrap();
            let drawn = |seed: u64, at: usize, share| {
                let mixed = (seed ^ at as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
                mixed.wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 32 & 63 < share
            };
            let marked: Vec<bool> = (0..spec.len()).map(|at| drawn(a, at, share)).collect();
            let asked: Vec<bool> = (0..spec.len()).map(|at| drawn(b, at, 32)).collect();
            let fast = squared_to_nearest(&marked, &asked, &spec);
            let slow = by_trying_all(&marked, &asked, &spec);
            prop_assert_eq!(fast.len(), slow.len());
            for (fast, slow) in fast.into_iter().zip(slow) {
                if slow.is_finite() {
                    prop_assert!((fast - slow).abs() < 1e-9, "{fast} {slow}");
                    finite.set(finite.get() + 1);
                } else {
                    prop_assert_eq!(fast, slow);
                    endless.set(endless.get() + 1);
                }
            }
        });
        assert!(finite.get() > 5_000, "{} near", finite.get());
        assert!(endless.get() > 100, "{} without any", endless.get());
    }
}
