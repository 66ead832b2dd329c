//! All rays of one azimuth at once.
//!
//! Rays of one azimuth climb with the same level line. Where the occupied heights of a column and the
//! heights of the rays in it have nothing in common, no ray ends there.

use nalgebra::Point3;
use occlabel_core::GridSpec;

use super::climb::{
    Climb, Climbs,
    Verdict::{Sure, Unsure},
};
use super::columns::Column;
use super::grid::RayGrid;
use super::hit::{RayHit, first_hit};
use super::path::{Crossing, trace};
use super::ray::{Axis, Start};
use super::set::{MOST_PITCHES, RaySet};

/// What the rays of a fan hit, pitch by pitch, where they hit anything.
pub(super) type FanHits = [RayHit; MOST_PITCHES];

/// Room for hits.
pub(super) const NO_HITS: FanHits = [RayHit { flat: 0, depth_m: 0.0 }; MOST_PITCHES];

/// The rays from one origin that have one azimuth.
pub(super) struct Fan<'a> {
    spec: &'a GridSpec,
    rays: &'a RaySet,
    origin: &'a Point3<f64>,
    azimuth: usize,
    start: Start,
    climbs: Climbs,
    /// The columns on the way.
    path: Vec<Crossing>,
    /// Whether all rays take that way. Else they are cast one by one.
    is_sure: bool,
}

impl<'a> Fan<'a> {
    /// A fan that has yet to [`Self::turn`].
    pub(super) fn new(grid: &RayGrid<'a>, rays: &'a RaySet, origin: &'a Point3<f64>) -> Self {
        let (spec, start) = (grid.spec, Start::new(grid.spec, origin));
        let climbs = Climbs::new(grid, rays, &start);
        Self { spec, rays, origin, azimuth: 0, start, climbs, path: vec![], is_sure: false }
    }

    /// Turns to an azimuth.
    pub(super) fn turn(&mut self, azimuth: usize) {
        let [y, x] = self.rays.azimuths()[azimuth];
        let line = [self.start.axis(0, x), self.start.axis(1, y)];
        let [nx, ny, _] = self.spec.shape();
        self.azimuth = azimuth;
        self.is_sure =
            self.spec.flat_of(self.origin).is_some() && trace(line, [nx, ny], &mut self.path);
    }

    /// Casts the `wanted` rays; those that hit something. A bit a pitch.
    pub(super) fn cast(&self, grid: &RayGrid, wanted: u64, hits: &mut FanHits) -> u64 {
        if self.is_sure {
            let mut sweep = Sweep { fan: self, grid, left: wanted, stopped: 0, hits };
            sweep.run();
            return sweep.stopped;
        }
        let mut stopped = 0;
        for pitch in ones(wanted) {
            let direction = self.rays.direction(pitch, self.azimuth);
            if let Some(hit) = first_hit(grid, self.origin, &direction).hit() {
                hits[pitch] = hit;
                stopped |= 1 << pitch;
            }
        }
        stopped
    }
}

/// A fan on its way through a grid.
struct Sweep<'a> {
    fan: &'a Fan<'a>,
    grid: &'a RayGrid<'a>,
    /// Rays on their way, and rays that something has stopped, a bit a pitch.
    left: u64,
    stopped: u64,
    hits: &'a mut FanHits,
}

impl Sweep<'_> {
    fn run(&mut self) {
        let (fan, mut in_m) = (self.fan, 0.0);
        let Some([mut lowest, mut highest]) = self.outermost() else { return };
        for crossing in &fan.path {
            let (column, span_m) = (self.grid.columns.at(crossing.column), [in_m, crossing.out_m]);
            let is_met = fan.climbs.heights(&lowest, span_m).low() <= f64::from(column.to)
                && fan.climbs.heights(&highest, span_m).high() >= f64::from(column.from);
            let is_gone = in_m > highest.top_m;
            if is_met {
                self.stop(&column, crossing, span_m);
            }
            if is_gone {
                self.left &= !(1_u64 << 63 >> self.left.leading_zeros());
            }
            if is_met || is_gone {
                let Some(outermost) = self.outermost() else { return };
                [lowest, highest] = outermost;
            }
            in_m = crossing.out_m;
        }
    }

    /// The lowest and the highest ray that are left.
    #[inline]
    fn outermost(&self) -> Option<[Climb; 2]> {
        let highest = self.left.checked_ilog2()?;
        Some([self.left.trailing_zeros(), highest].map(|pitch| self.fan.climbs.of[pitch as usize]))
    }

    /// Ends the rays that are stopped in a column.
    fn stop(&mut self, column: &Column, crossing: &Crossing, span_m: [f64; 2]) {
        let climbs = &self.fan.climbs;
        for pitch in ones(self.left) {
            let climb = &climbs.of[pitch];
            let heights = climbs.heights(climb, span_m);
            if heights.low() > f64::from(column.to) {
                break;
            }
            if heights.high() < f64::from(column.from) {
                continue;
            }
            let hit = match climbs.hit(climb, heights, column.word, crossing) {
                Sure(hit) => hit,
                Unsure => self.look(pitch, crossing),
            };
            if let Some(hit) = hit {
                self.hits[pitch] = hit;
                self.stopped |= 1 << pitch;
            }
        }
        self.left &= !self.stopped;
    }

    /// What a ray hits in a column, exactly.
    #[cold]
    fn look(&self, pitch: usize, crossing: &Crossing) -> Option<RayHit> {
        let Fan { spec, rays, start, azimuth, .. } = self.fan;
        let [x, y, z] = start.ray(&rays.direction(pitch, *azimuth));
        let [_, ny, nz] = spec.shape();
        let column = crossing.column as usize;
        let at = [column / ny, column % ny].map(|at| at as i64);
        let entry = |axis: &Axis, at: i64| (at != axis.first).then(|| axis.enters_m(at));
        let in_m = entry(&x, at[0]).into_iter().chain(entry(&y, at[1])).reduce(f64::max);
        let mut voxel = in_m.map_or(z.first, |in_m| z.voxel_at(in_m, |met_m| met_m <= in_m));
        let out_m = x.leaves_m(at[0]).min(y.leaves_m(at[1]));
        while (0..nz as i64).contains(&voxel) {
            let (flat, leaves_m) = (column * nz + voxel as usize, z.leaves_m(voxel));
            if self.grid.is_occupied(flat) {
                return Some(RayHit { flat: flat as u32, depth_m: leaves_m.min(out_m) });
            }
            if out_m < leaves_m {
                return None;
            }
            voxel += z.step;
        }
        None
    }
}

/// The places of the ones in a word, ascending.
pub(super) fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (word != 0).then(|| word.trailing_zeros() as usize)?;
        word &= word - 1;
        Some(place)
    })
}
