//! What rays leave in a grid.

use std::ops::ControlFlow;

use nalgebra::Point3;
use occlabel_core::{ClassId, GridSpec, GrownBox, Pose, RigidMap, Timestamp, VoxelGrid, walk};
use rayon::prelude::*;

use crate::truth::rays::{NOT_GROWN, SweepRays, TrueRays};
use crate::truth::{SAME_TIME_S, TruthAt, TruthSettings};
use crate::{Drive, What};

/// Where rays end, and what they pass through on the way.
#[derive(Clone, Debug)]
pub(super) struct Marks {
    pub(super) ends: VoxelGrid<u32>,
    pub(super) crossed: VoxelGrid<bool>,
    /// The class that most ends are of.
    pub(super) hit_class: VoxelGrid<Option<ClassId>>,
}

/// A keyframe's grid, as rays of other times meet it.
pub(super) struct Target<'a> {
    spec: &'a GridSpec,
    time: Timestamp,
    grid_from_world: RigidMap,
    movers: Vec<Stance>,
    settings: &'a TruthSettings,
}

/// A mover as it stands at the keyframe.
struct Stance {
    pose: Pose,
    grid_from_box: RigidMap,
    true_box: GrownBox,
    is_deformable: bool,
    class: Option<ClassId>,
}

/// Marks all rays in a keyframe's grid. Parallel over sweeps.
pub(super) fn mark_rays(
    drive: &Drive,
    rays: &TrueRays,
    at: &TruthAt,
    settings: &TruthSettings,
) -> Marks {
    let target = Target::new(drive, at, settings);
    let within = rays.sweeps.iter().filter(|sweep| target.is_within(sweep, settings.window_s));
    let (now, then): (Vec<_>, Vec<_>) =
        within.partition(|sweep| sweep.time.seconds_apart(target.time) <= SAME_TIME_S);
    let mut marks = target.mark_all(&then, Marks::cross);
    target.forget_air_in_boxes(&mut marks);
    marks.add(&target.mark_all(&now, Marks::cross));
    let all = [then, now].concat();
    marks.add(&target.mark_all(&all, Marks::end));
    marks.hit_class = target.hit_classes(&all);
    marks
}

impl<'a> Target<'a> {
    pub(super) fn new(drive: &Drive, at: &TruthAt<'a>, settings: &'a TruthSettings) -> Self {
        let grid_from_world = at.world_from_grid.inverse();
        let world = drive.world();
        let stance = |(number, mover): (usize, &crate::Mover)| {
            let stands = mover.box_at(drive.mover_time_s(at.keyframe, number), &world.ground);
            let pose = grid_from_world * stands.world_from_box;
            Stance {
                pose,
                grid_from_box: RigidMap::from(&pose),
                true_box: GrownBox::new(&stands.size_m, &NOT_GROWN),
                is_deformable: mover.parts.iter().any(|part| part.pivot.is_some()),
                class: drive.class_of(What::Mover(number)),
            }
        };
        Self {
            spec: at.spec,
            time: at.keyframe.time,
            grid_from_world: RigidMap::from(&grid_from_world),
            movers: world.movers.iter().enumerate().map(stance).collect(),
            settings,
        }
    }

    pub(super) fn is_within(&self, sweep: &SweepRays, window_s: f64) -> bool {
        sweep.time.seconds_apart(self.time) <= window_s
    }

    fn mark_all(
        &self,
        sweeps: &[&SweepRays],
        mark: impl Fn(&mut Marks, &Self, &SweepRays) + Sync,
    ) -> Marks {
        let none = || Marks {
            ends: VoxelGrid::filled(self.spec, 0),
            crossed: VoxelGrid::filled(self.spec, false),
            hit_class: VoxelGrid::filled(self.spec, None),
        };
        let share = sweeps.len().div_ceil(rayon::current_num_threads()).max(1);
        let marked = sweeps.par_chunks(share).map(|sweeps| {
            let mut marks = none();
            sweeps.iter().for_each(|sweep| mark(&mut marks, self, sweep));
            marks
        });
        marked
            .reduce_with(|mut sum, more| {
                sum.add(&more);
                sum
            })
            .unwrap_or_else(none)
    }

    /// The rays that end on movers which count at the keyframe, each with how its mover stands.
    fn moving<'r>(
        &self,
        sweep: &'r SweepRays,
    ) -> impl Iterator<Item = (&'r super::rays::MoverRay, &Stance)> {
        let lasts = self.is_within(sweep, self.settings.deformable_window_s);
        let rays = sweep.moving.iter().map(|ray| (ray, &self.movers[ray.mover]));
        rays.filter(move |(_, stance)| lasts || !stance.is_deformable)
    }

    /// The voxel in which each ray of the sweep ends, by its place, and the class that it met.
    pub(super) fn ends(&self, sweep: &SweepRays) -> impl Iterator<Item = (usize, Option<ClassId>)> {
        let met = sweep.fixed.positions.iter().zip(&sweep.fixed.labels);
        let fixed = met.map(|(end, class)| (self.grid_from_world.apply(end), *class));
        let moving = self.moving(sweep);
        let moving =
            moving.map(|(ray, stance)| (stance.grid_from_box.apply(&ray.box_end), stance.class));
        fixed.chain(moving).filter_map(|(end, class)| Some((self.spec.flat_of(&end)?, class)))
    }

    /// Of each voxel the class that most ends are of, the lowest on ties.
    fn hit_classes(&self, sweeps: &[&SweepRays]) -> VoxelGrid<Option<ClassId>> {
        let known = |sweep: &&SweepRays| {
            self.ends(sweep).filter_map(|(flat, class)| Some((flat as u32, class?))).collect()
        };
        let ends: Vec<Vec<(u32, ClassId)>> = sweeps.par_iter().map(known).collect();
        let mut ends = ends.concat();
        ends.par_sort_unstable();
        let mut most = VoxelGrid::filled(self.spec, None);
        for voxel in ends.chunk_by(|a, b| a.0 == b.0) {
            let classes = voxel.chunk_by(|a, b| a.1 == b.1);
            let best = classes.rev().max_by_key(|alike| alike.len());
            most.values_mut()[voxel[0].0 as usize] = best.map(|alike| alike[0].1);
        }
        most
    }

    /// Air seen at another time says nothing about where a mover stands now.
    fn forget_air_in_boxes(&self, marks: &mut Marks) {
        let crossed = marks.crossed.values_mut();
        for stance in &self.movers {
            let box_from_grid = stance.pose.inverse();
            let centre: Point3<f64> = stance.pose.translation.vector.into();
            for voxel in self.spec.voxels_near(&centre, stance.true_box.radius()) {
                let is_inside =
                    stance.true_box.contains(&(box_from_grid * self.spec.centre(voxel)));
                if let (true, Some(flat)) = (is_inside, self.spec.flat(voxel)) {
                    crossed[flat] = false;
                }
            }
        }
    }
}

impl Marks {
    /// Marks the air that a sweep saw in the world: up to what stands, or to a mover's box.
    fn cross(&mut self, target: &Target, sweep: &SweepRays) {
        let place = &target.grid_from_world;
        for (at, end) in sweep.fixed.positions.iter().enumerate() {
            self.walk(target.spec, &place.apply(end), &place.apply(&sweep.fixed.origin(at)));
        }
        for (ray, _) in target.moving(sweep) {
            if let Some(entry) = &ray.entry {
                self.walk(target.spec, &place.apply(entry), &place.apply(&ray.origin));
            }
        }
    }

    /// Marks where a sweep's rays end, and the air that it saw within movers' boxes, where those
    /// stand now.
    fn end(&mut self, target: &Target, sweep: &SweepRays) {
        let ends = self.ends.values_mut();
        target.ends(sweep).for_each(|(flat, _)| ends[flat] += 1);
        for (ray, stance) in target.moving(sweep) {
            let place = &stance.grid_from_box;
            self.walk(target.spec, &place.apply(&ray.box_end), &place.apply(&ray.box_entry));
        }
    }

    /// Marks what the way from an end to an origin enters after the end's own voxel.
    #[inline]
    fn walk(&mut self, spec: &GridSpec, end: &Point3<f64>, origin: &Point3<f64>) {
        let crossed = self.crossed.values_mut();
        walk(spec, spec.snap(end), spec.snap(origin), |flat, _| {
            crossed[flat] = true;
            ControlFlow::Continue(())
        });
    }

    fn add(&mut self, more: &Self) {
        let ends = self.ends.values_mut().iter_mut().zip(more.ends.values());
        ends.for_each(|(sum, more)| *sum += more);
        let crossed = self.crossed.values_mut().iter_mut().zip(more.crossed.values());
        crossed.for_each(|(sum, more)| *sum |= more);
    }
}
