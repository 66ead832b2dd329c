//! Rays from one camera that lie close together, bounded.

use std::ops::Range;

use nalgebra::Vector3;
use occlabel_core::{LATTICE, LatticePoint};

/// By how much a bound on a place is taken as unsure, voxels: far above the rounding of f64.
const UNSURE: f64 = 1e-6;

/// Steeper rays than this, against the main axis, are not worth bounding.
const STEEP: f64 = 4.0;

/// Rays from one start, each of which moves along the main axis; along the other two its place is
/// bounded by slopes, voxels for each voxel along the main one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    /// The main axis.
    pub(crate) axis: usize,
    /// The other two.
    pub(crate) others: [usize; 2],
    /// Whether the rays run up along the main axis.
    pub(crate) is_up: bool,
    /// Along the main axis none runs farther, voxels.
    pub(crate) far: f64,
    /// Bounds along the other two.
    pub(crate) slopes: [Slopes; 2],
}

/// Bounds of a beam's rays along an axis.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Slopes {
    /// Where all rays start, voxels.
    start: f64,
    low: f64,
    high: f64,
}

impl Beam {
    /// A beam of rays whose ways, in voxels, are `way` give or take `spread` along each axis.
    ///
    /// `None` if they may be too steep against the main axis: `axis`, or the longest one.
    pub(crate) fn new(
        start: &Vector3<f64>,
        way: &Vector3<f64>,
        spread: &Vector3<f64>,
        axis: Option<usize>,
    ) -> Option<Self> {
        let axis = axis.unwrap_or_else(|| way.abs().imax());
        let (near, far) = (way[axis].abs() - spread[axis], way[axis].abs() + spread[axis]);
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let slopes = others.map(|other| {
            let (low, high) = (way[other] - spread[other], way[other] + spread[other]);
            let low = low / if low > 0.0 { far } else { near };
            let high = high / if high > 0.0 { near } else { far };
            Slopes { start: start[other], low, high }
        });
        let is_bounded = near > 0.0 && slopes.iter().all(|s| s.low >= -STEEP && s.high <= STEEP);
        is_bounded.then_some(Self { axis, others, is_up: way[axis] > 0.0, far, slopes })
    }

    /// A beam of rays to known ends, at least one, all of which run along an axis.
    pub(crate) fn to_ends<'a>(
        start: &LatticePoint,
        ends: impl Iterator<Item = &'a LatticePoint>,
        axis: usize,
    ) -> Option<Self> {
        let voxels = |q: &LatticePoint| Vector3::from(q.0.map(|q| q as f64 / LATTICE as f64));
        let from = voxels(start);
        let ray = |end| Self::new(&from, &(voxels(end) - from), &Vector3::zeros(), Some(axis));
        ends.map(ray).reduce(|all, ray| Some(all?.join(&ray?))).flatten()
    }

    fn join(mut self, other: &Self) -> Self {
        self.far = self.far.max(other.far);
        for (slopes, others) in self.slopes.iter_mut().zip(&other.slopes) {
            slopes.low = slopes.low.min(others.low);
            slopes.high = slopes.high.max(others.high);
        }
        self
    }

    /// Those of its rays that keep to other bounds too; `None` if no ray can.
    pub(crate) fn within(mut self, bounds: &[Slopes; 2]) -> Option<Self> {
        for (slopes, bounds) in self.slopes.iter_mut().zip(bounds) {
            slopes.low = slopes.low.max(bounds.low);
            slopes.high = slopes.high.min(bounds.high);
        }
        self.slopes.iter().all(|slopes| slopes.low <= slopes.high).then_some(self)
    }
}

impl Slopes {
    /// The voxels that rays may be in on a part of the main axis; `None` if all are outside `0..n`.
    #[inline]
    pub(crate) fn voxels(&self, part: &Range<f64>, n: usize) -> Option<Range<usize>> {
        let low = self.low * if self.low < 0.0 { part.end } else { part.start };
        let high = self.high * if self.high < 0.0 { part.start } else { part.end };
        let (low, high) = (self.start + low - UNSURE, self.start + high + UNSURE);
        if high < 0.0 {
            return None;
        }
        let (low, high) = (low.max(0.0) as i32 as usize, high as i32 as usize);
        (low < n).then(|| low..high.min(n - 1) + 1)
    }

    /// Keeps rays that are above a face on a part of the main axis; tells whether there are any.
    pub(crate) fn keep_above(&mut self, face: usize, part: &Range<f64>) -> bool {
        let gap = face as f64 - UNSURE - self.start;
        self.low = self.low.max(gap / if gap > 0.0 { part.start } else { part.end });
        self.low <= self.high
    }

    /// Keeps rays that are below a face on a part of the main axis; tells whether there are any.
    pub(crate) fn keep_below(&mut self, face: usize, part: &Range<f64>) -> bool {
        let gap = face as f64 + UNSURE - self.start;
        self.high = self.high.min(gap / if gap < 0.0 { part.start } else { part.end });
        self.low <= self.high
    }
}
