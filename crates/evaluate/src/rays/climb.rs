//! How rays climb with their level line.

use super::columns::UNSURE;
use super::grid::RayGrid;
use super::hit::RayHit;
use super::path::Crossing;
use super::ray::Start;
use super::set::RaySet;

/// How the rays from an origin climb, whatever their azimuth.
pub(super) struct Climbs {
    /// Ray by ray, the lowest first.
    pub(super) of: Vec<Climb>,
    /// The origin's height, bits.
    start: f64,
    /// Whether a bit is one voxel.
    is_fine: bool,
    /// Voxels of a column.
    nz: u32,
}

/// How a ray climbs.
#[derive(Clone, Copy)]
pub(super) struct Climb {
    /// Bits a metre of the level line.
    slope: f64,
    /// Metres of the ray a metre of the level line, and a bit.
    level_m: f64,
    bit_m: f64,
    /// Where it is above the grid for sure, metres of the level line.
    pub(super) top_m: f64,
}

/// The heights at which a ray comes into a column and leaves it, bits.
#[derive(Clone, Copy)]
pub(super) struct Heights([f64; 2]);

/// What a ray hits in a column, if rounding leaves no doubt.
pub(super) enum Verdict {
    Sure(Option<RayHit>),
    Unsure,
}

use Verdict::{Sure, Unsure};

impl Climbs {
    pub(super) fn new(grid: &RayGrid, rays: &RaySet, start: &Start) -> Self {
        let ([.., nz], voxels_per_bit) = (grid.spec.shape(), grid.columns.voxels_per_bit());
        let (bit_m, start) =
            (grid.spec.size_m().z * voxels_per_bit, start.voxels[2] / voxels_per_bit);
        let left = nz as f64 / voxels_per_bit + UNSURE - start;
        let climb = |[up, level]: &[f64; 2]| Climb {
            slope: up / level / bit_m,
            level_m: 1.0 / level,
            bit_m: bit_m / up,
            top_m: if *up > 0.0 { left * bit_m * level / up } else { f64::INFINITY },
        };
        let of = rays.pitches().iter().map(climb).collect();
        Self { of, start, is_fine: voxels_per_bit == 1.0, nz: nz as u32 }
    }

    #[inline(always)]
    pub(super) fn heights(&self, climb: &Climb, [in_m, out_m]: [f64; 2]) -> Heights {
        Heights([self.start + climb.slope * in_m, self.start + climb.slope * out_m])
    }

    /// What a ray hits in a column of occupied bits.
    #[inline(always)]
    pub(super) fn hit(
        &self,
        climb: &Climb,
        heights: Heights,
        word: u64,
        crossing: &Crossing,
    ) -> Verdict {
        let (low, high) = (heights.low(), heights.high());
        let (from, to) = (low.max(0.0) as u32, high.min(63.0) as u32);
        let is_sure = |height: f64, bit: u32| {
            let over = height - f64::from(bit);
            (over > UNSURE) & (over < 1.0 - UNSURE)
        };
        if !(self.is_fine && is_sure(low, from) && is_sure(high, to)) {
            return Unsure;
        }
        let met = word >> from << from << (63 - to) >> (63 - to);
        if met == 0 {
            return Sure(None);
        }
        let (z, last, face) = match climb.slope < 0.0 {
            true => (met.ilog2(), from, met.ilog2()),
            false => (met.trailing_zeros(), to, met.trailing_zeros() + 1),
        };
        let depth_m = match z == last {
            true => crossing.out_m * climb.level_m,
            false => (f64::from(face) - self.start) * climb.bit_m,
        };
        Sure(Some(RayHit { flat: crossing.column * self.nz + z, depth_m }))
    }
}

impl Heights {
    #[inline(always)]
    pub(super) fn low(self) -> f64 {
        let Self([in_, out]) = self;
        if in_ < out { in_ } else { out }
    }

    #[inline(always)]
    pub(super) fn high(self) -> f64 {
        let Self([in_, out]) = self;
        if in_ > out { in_ } else { out }
    }
}
