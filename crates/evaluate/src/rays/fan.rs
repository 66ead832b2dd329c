//! All rays of one azimuth at once.
//!
//! Rays of one azimuth climb with the same level line. Where the occupied heights of a column and the
//! heights of the rays in it have nothing in common, no ray ends there.

use nalgebra::Point3;
use occlabel_core::GridSpec;

use super::grid::RayGrid;
use super::hit::{RayHit, first_hit};
use super::path::{Crossing, trace};
use super::ray::{Axis, axes};
use super::set::{MOST_PITCHES, RaySet};

/// How far a height may be off by rounding, bits of a column; it is below 1e-9 inside any grid.
const UNSURE: f64 = 1e-6;

/// What the rays of a fan hit, pitch by pitch.
pub(super) type FanHits = [Option<RayHit>; MOST_PITCHES];

/// The rays from one origin that have one azimuth.
pub(super) struct Fan<'a> {
    spec: &'a GridSpec,
    rays: &'a RaySet,
    origin: &'a Point3<f64>,
    azimuth: usize,
    /// The origin in voxels.
    start: [f64; 3],
    /// The columns on the way.
    path: Vec<Crossing>,
    /// Whether all rays take that way. Else they are cast one by one.
    is_sure: bool,
}

impl<'a> Fan<'a> {
    /// A fan that has yet to [`Self::turn`].
    pub(super) fn new(spec: &'a GridSpec, rays: &'a RaySet, origin: &'a Point3<f64>) -> Self {
        let start = spec.to_voxel_units(origin).into();
        Self { spec, rays, origin, azimuth: 0, start, path: vec![], is_sure: false }
    }

    /// Turns to an azimuth.
    pub(super) fn turn(&mut self, azimuth: usize) {
        let ([y, x], size_m) = (self.rays.azimuths()[azimuth], self.spec.size_m());
        let line = [Axis::new(self.start[0], size_m.x, x), Axis::new(self.start[1], size_m.y, y)];
        let [nx, ny, _] = self.spec.shape();
        self.azimuth = azimuth;
        self.is_sure =
            self.spec.flat_of(self.origin).is_some() && trace(line, [nx, ny], &mut self.path);
    }

    /// What the `wanted` rays hit, a bit a pitch.
    pub(super) fn cast(&self, grid: &RayGrid, wanted: u64) -> FanHits {
        let mut hits = [None; MOST_PITCHES];
        if self.is_sure {
            Sweep::new(self, grid).run(wanted, &mut hits);
            return hits;
        }
        for pitch in ones(wanted) {
            let direction = self.rays.direction(pitch, self.azimuth);
            hits[pitch] = first_hit(grid, self.origin, &direction).hit();
        }
        hits
    }
}

/// A fan on its way through a grid.
struct Sweep<'a> {
    fan: &'a Fan<'a>,
    grid: &'a RayGrid<'a>,
    /// The origin's height and that of the grid, bits.
    start: f64,
    top: f64,
    /// Bits that rays climb a metre of the level line, ascending.
    slopes: [f64; MOST_PITCHES],
}

/// The heights of a ray, or of a fan, in a column: from, to.
type Heights = [f64; 2];

impl<'a> Sweep<'a> {
    fn new(fan: &'a Fan, grid: &'a RayGrid) -> Self {
        let bits_per_voxel = grid.columns.bits_per_voxel();
        let bits_per_m = bits_per_voxel / fan.spec.size_m().z;
        let mut slopes = [0.0; MOST_PITCHES];
        for (slope, [up, level]) in slopes.iter_mut().zip(fan.rays.pitches()) {
            *slope = up / level * bits_per_m;
        }
        let top = fan.spec.shape()[2] as f64 * bits_per_voxel;
        Self { fan, grid, start: fan.start[2] * bits_per_voxel, top, slopes }
    }

    fn run(&self, wanted: u64, hits: &mut FanHits) {
        let (mut left, mut in_m) = (wanted, 0.0);
        let ny = self.fan.spec.shape()[1];
        for crossing in &self.fan.path {
            if left == 0 {
                return;
            }
            let word = self.grid.columns.word(crossing.x as usize * ny + crossing.y as usize);
            let span_m = [in_m, crossing.out_m];
            let (lowest, highest) = (left.trailing_zeros(), left.ilog2());
            let [low, _] = self.heights(lowest as usize, span_m);
            let [high_in, high] = self.heights(highest as usize, span_m);
            if word & bits([low, high]) != 0 {
                left &= !self.stop(left, word, crossing, span_m, hits);
            }
            if high_in > self.top + UNSURE {
                left &= !(1 << highest);
            }
            in_m = crossing.out_m;
        }
    }

    /// Ends the rays that are stopped in a column; returns them.
    #[inline(never)]
    fn stop(
        &self,
        left: u64,
        word: u64,
        crossing: &Crossing,
        span_m: [f64; 2],
        hits: &mut FanHits,
    ) -> u64 {
        let (mut stopped, above) = (0, f64::from(word.ilog2() + 1) + UNSURE);
        for pitch in ones(left) {
            let heights = self.heights(pitch, span_m);
            if heights[0] > above {
                break;
            }
            if word & bits(heights) != 0 {
                hits[pitch] = self.hit_in(pitch, crossing);
                stopped |= u64::from(hits[pitch].is_some()) << pitch;
            }
        }
        stopped
    }

    #[inline(always)]
    fn heights(&self, pitch: usize, [in_m, out_m]: [f64; 2]) -> Heights {
        let slope = self.slopes[pitch];
        let [in_, out] = [self.start + slope * in_m, self.start + slope * out_m];
        [in_.min(out), in_.max(out)]
    }

    /// What a ray hits in a column, exactly.
    fn hit_in(&self, pitch: usize, crossing: &Crossing) -> Option<RayHit> {
        let Fan { spec, rays, origin, azimuth, .. } = *self.fan;
        let [x, y, z] = axes(spec, origin, &rays.direction(pitch, azimuth));
        let column = [i64::from(crossing.x), i64::from(crossing.y)];
        let [_, ny, nz] = spec.shape();
        let base = (crossing.x as usize * ny + crossing.y as usize) * nz;
        let entry = |axis: &Axis, at: i64| (at != axis.first).then(|| axis.enters_m(at));
        let mut voxel =
            match entry(&x, column[0]).into_iter().chain(entry(&y, column[1])).reduce(f64::max) {
                Some(in_m) => z.voxel_at(in_m, |met_m| met_m <= in_m),
                None => z.first,
            };
        let out_m = x.leaves_m(column[0]).min(y.leaves_m(column[1]));
        while (0..nz as i64).contains(&voxel) {
            let (flat, up_m) = (base + voxel as usize, z.leaves_m(voxel));
            if self.grid.is_occupied(flat) {
                return Some(RayHit { flat: flat as u32, depth_m: up_m.min(out_m) });
            }
            if out_m < up_m {
                return None;
            }
            voxel += z.step;
        }
        None
    }
}

/// The bits of a column that heights may touch.
#[inline(always)]
fn bits([from, to]: Heights) -> u64 {
    let (from, to) = (from - UNSURE, to + UNSURE);
    if to < 0.0 || from >= 64.0 {
        return 0;
    }
    let (from, to) = (from.max(0.0) as u32, to.min(63.0) as u32);
    (!0 << from) & (!0 >> (63 - to))
}

/// The places of the ones in a word, ascending.
pub(super) fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (word != 0).then(|| word.trailing_zeros() as usize)?;
        word &= word - 1;
        Some(place)
    })
}
