//! One pass of held-out rays through labels.

use std::ops::ControlFlow;

use nalgebra::Vector3;
use occlabel_core::{VoxelGrid, VoxelIndex, walk};
use rayon::prelude::*;

use super::kind::{Kind, around};
use super::slab::{voxel_distance_m, voxel_entry_m};
use super::{HeldOutRay, Labels, Tally, Verdict};

/// So many rays through an occupied voxel, and none into it, contradict it.
const CONTRADICTING_CROSSINGS: u8 = 3;

/// Where held-out rays ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Returns {
    /// More than one voxel away, along some axis.
    Far,
    /// In one of the 26 voxels around.
    Near,
    /// Here.
    Here,
}

/// What rays say of labels. Parallel over rays; integer sums, so the order does not show.
pub(super) fn pass(
    labels: &Labels,
    rays: &[HeldOutRay],
    kinds: &[Kind],
    tolerance_m: f64,
) -> Tally {
    let returns = mark_returns(labels, rays);
    let pairs: Vec<_> = rays.iter().zip(kinds).collect();
    let share = pairs.len().div_ceil(rayon::current_num_threads()).max(1);
    let hear = |share: &[(&HeldOutRay, &Kind)]| {
        let mut court = Court::new(labels, &returns, tolerance_m);
        share.iter().for_each(|(ray, kind)| court.hear(ray, **kind));
        court
    };
    let heard = pairs.par_chunks(share).map(hear).reduce_with(Court::joined);
    heard.map_or_else(Tally::default, Court::close)
}

fn mark_returns(labels: &Labels, rays: &[HeldOutRay]) -> VoxelGrid<Returns> {
    let spec = labels.spec;
    let mut marks = VoxelGrid::filled(spec, Returns::Far);
    for ray in rays {
        let end = spec.snap(&ray.point).voxel();
        for flat in around(end).filter_map(|voxel| spec.flat(voxel)) {
            let mark = &mut marks.values_mut()[flat];
            if *mark == Returns::Far {
                *mark = Returns::Near;
            }
        }
        if let Some(flat) = spec.flat(end) {
            marks.values_mut()[flat] = Returns::Here;
        }
    }
    marks
}

/// Hears rays, one after the other.
struct Court<'a> {
    labels: &'a Labels<'a>,
    returns: &'a VoxelGrid<Returns>,
    tolerance_m: f64,
    /// Rays through each voxel, saturating.
    crossings: VoxelGrid<u8>,
    tally: Tally,
}

impl<'a> Court<'a> {
    fn new(labels: &'a Labels, returns: &'a VoxelGrid<Returns>, tolerance_m: f64) -> Self {
        let crossings = VoxelGrid::filled(labels.spec, 0);
        Self { labels, returns, tolerance_m, crossings, tally: Tally::default() }
    }

    fn hear(&mut self, ray: &HeldOutRay, kind: Kind) {
        let spec = self.labels.spec;
        let met_before = self.cross(ray, kind);
        let end = spec.snap(&ray.point).voxel();
        let Some(flat) = spec.flat(end) else { return };
        if self.is_cut(ray, flat) {
            self.tally.covered += 1;
            return;
        }
        self.end(ray, kind, flat);
        let met_here = self.labels.is_occupied(flat).then_some(end);
        let met = met_before.or(met_here).or_else(|| self.meet_beyond(ray));
        self.judge_depth(ray, kind, met);
    }

    /// Counts the voxels between return and origin; gives the occupied one nearest to the origin.
    fn cross(&mut self, ray: &HeldOutRay, kind: Kind) -> Option<VoxelIndex> {
        let spec = self.labels.spec;
        let (from, to) = (spec.snap(&ray.point), spec.snap(&ray.origin));
        let end = spec.flat(from.voxel());
        let mut met = None;
        walk(spec, from, to, |flat, voxel| {
            if Some(flat) != end && !self.is_cut(ray, flat) {
                self.count(kind, flat);
                if self.labels.is_occupied(flat) {
                    met = Some(VoxelIndex(voxel));
                }
            }
            ControlFlow::Continue(())
        });
        met
    }

    fn count(&mut self, kind: Kind, flat: usize) {
        let crossings = &mut self.crossings.values_mut()[flat];
        *crossings = crossings.saturating_add(1);
        if self.returns.values()[flat] != Returns::Far {
            return;
        }
        let verdict = self.labels.verdicts.values()[flat];
        let tally = self.tally.of_mut(kind);
        tally.crossings += 1;
        match verdict {
            Verdict::Occupied(_) => tally.crossings_of_occupied += 1,
            Verdict::Unobserved => tally.crossings_of_unobserved += 1,
            Verdict::Free => {}
        }
    }

    /// Whether what the ray saw there is no longer so: a track came to stand there.
    fn is_cut(&self, ray: &HeldOutRay, flat: usize) -> bool {
        ray.is_of_another_time && self.labels.is_standing(flat)
    }

    fn end(&mut self, ray: &HeldOutRay, kind: Kind, flat: usize) {
        let (spec, reach) = (self.labels.spec, self.tolerance_m);
        let is_near = |voxel: &VoxelIndex| voxel_distance_m(spec, *voxel, &ray.point) <= reach;
        let near = spec.voxels_near(&ray.point, reach).filter(is_near);
        let is_hit = self.labels.is_occupied(flat)
            || near.filter_map(|voxel| spec.flat(voxel)).any(|at| self.labels.is_occupied(at));
        let is_unobserved = self.labels.verdicts.values()[flat] == Verdict::Unobserved;
        let tally = self.tally.of_mut(kind);
        tally.returns += 1;
        tally.hits += u64::from(is_hit);
        tally.in_unobserved += u64::from(is_unobserved);
    }

    /// The first occupied voxel behind the return.
    fn meet_beyond(&self, ray: &HeldOutRay) -> Option<VoxelIndex> {
        let spec = self.labels.spec;
        let way = (spec.max_m() - spec.min_m()).norm();
        let far = ray.point + direction(ray) * way;
        let mut met = None;
        walk(spec, spec.snap(&ray.point), spec.snap(&far), |flat, voxel| {
            if self.labels.is_occupied(flat) && !self.is_cut(ray, flat) {
                met = Some(VoxelIndex(voxel));
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        met
    }

    fn judge_depth(&mut self, ray: &HeldOutRay, kind: Kind, met: Option<VoxelIndex>) {
        let spec = self.labels.spec;
        let tally = self.tally.of_mut(kind);
        match met {
            Some(voxel) => {
                let entry_m = voxel_entry_m(spec, voxel, &ray.origin, &direction(ray));
                let range_m = (ray.point - ray.origin).norm();
                tally.depth.add((range_m - entry_m).abs());
            }
            None => tally.meet_nothing += 1,
        }
    }

    fn joined(mut self, other: Self) -> Self {
        self.tally += &other.tally;
        let pairs = self.crossings.values_mut().iter_mut().zip(other.crossings.values());
        pairs.for_each(|(sum, more)| *sum = sum.saturating_add(*more));
        self
    }

    /// Judges the voxels that all rays together have something to say about.
    fn close(mut self) -> Tally {
        for flat in 0..self.labels.spec.len() {
            let is_hit = self.returns.values()[flat] == Returns::Here;
            let is_crossed = self.crossings.values()[flat] >= CONTRADICTING_CROSSINGS;
            if self.labels.is_occupied(flat) && (is_hit || is_crossed) {
                self.tally.occupied_asked += 1;
                self.tally.contradicted += u64::from(!is_hit);
            }
        }
        self.tally
    }
}

/// The way of a ray, of length 1; zero for one without length.
fn direction(ray: &HeldOutRay) -> Vector3<f64> {
    (ray.point - ray.origin).try_normalize(0.0).unwrap_or_else(Vector3::zeros)
}
