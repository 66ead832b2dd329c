//! The rays of a track's points in one sweep.
//!
//! ```text
//!   origin ----- world part ----- entry --- object part --- point
//!          where it was seen            where the track stands now
//! ```

use std::ops::Range;

use nalgebra::Point3;
use occlabel_core::{GridSpec, Kernel, LatticePoint, PlacedObject, Pose, Reach, RigidMap};

use crate::RayRules;
use crate::caster::{Caster, Ray};
use crate::cells::Cell;
use crate::near::RayEnds;
use crate::ways::{Batch, LANES, any};

/// A track's points in one sweep, placed somewhere.
#[derive(Clone, Copy)]
pub(crate) struct ObjectRays<'a> {
    placed: &'a PlacedObject<'a>,
    /// Grid from box.
    place: RigidMap,
    spec: &'a GridSpec,
    rules: &'a RayRules<'a>,
}

impl<'a> ObjectRays<'a> {
    pub(crate) fn new(
        placed: &'a PlacedObject<'a>,
        grid_from_box: &Pose,
        spec: &'a GridSpec,
        rules: &'a RayRules<'a>,
    ) -> Self {
        Self { placed, place: RigidMap::from(grid_from_box), spec, rules }
    }

    /// Where point `i` ends.
    pub(crate) fn end(&self, i: usize) -> LatticePoint {
        self.snap(&self.placed.object.cloud.positions[i])
    }

    /// The whole ray of point `i` from a lidar, grid frame.
    pub(crate) fn whole(&self, i: usize, lidar: &Point3<f64>) -> Ray {
        Ray::whole(self.end(i), self.spec.snap(lidar), self.is_flat(i))
    }

    /// Casts the parts after the entry.
    pub(crate) fn cast_object_parts<C: Cell>(&self, points: Range<usize>, caster: &mut Caster<C>) {
        if !self.reach().meets(self.spec) {
            return;
        }
        self.cast_parts(points, caster, true);
    }

    /// Casts the parts before the entry; those whose origin is inside the box have none.
    pub(crate) fn cast_world_parts<C: Cell>(&self, points: Range<usize>, caster: &mut Caster<C>) {
        let origins = &self.placed.object.cloud.origins;
        let reach = |reach: Reach, origin| reach.with(&self.place.apply(origin), self.spec);
        if origins.iter().fold(self.reach(), reach).meets(self.spec) {
            self.cast_parts(points, caster, false);
        }
    }

    fn cast_parts<C: Cell>(&self, points: Range<usize>, caster: &mut Caster<C>, of_object: bool) {
        if caster.takes_parts() {
            return caster.level().run(CastParts { rays: *self, points, caster, of_object });
        }
        points.filter_map(|i| self.part(i, of_object)).for_each(|ray| caster.cast(&ray));
    }

    /// Where the box may be.
    fn reach(&self) -> Reach {
        let (low, high) = self.placed.seen.corners();
        Reach::of_box(&low, &high, self.spec, &self.place)
    }

    fn part(&self, i: usize, of_object: bool) -> Option<Ray> {
        let (point, origin) = (self.placed.object.cloud.positions[i], self.placed.object.origin(i));
        if !of_object && self.placed.seen.contains(&origin) {
            return None;
        }
        let entry = self.placed.seen.entry(&origin, &point);
        let [point, entry, origin] = [point, entry, origin].map(|p| self.snap(&p));
        let (end, start) = if of_object { (point, entry) } else { (entry, origin) };
        let ends =
            RayEnds { point: point.voxel(), origin: origin.voxel(), is_flat: self.is_flat(i) };
        Some(Ray { end, origin: start, hits: of_object, ends })
    }

    /// An origin by its number; none if it is inside the box.
    fn origin_outside(&self, of: u32) -> Option<LatticePoint> {
        let origin = &self.placed.object.cloud.origins[of as usize];
        (!self.placed.seen.contains(origin)).then(|| self.snap(origin))
    }

    #[inline(always)]
    fn snap(&self, p: &Point3<f64>) -> LatticePoint {
        self.spec.snap(&self.place.apply(p))
    }

    fn is_flat(&self, i: usize) -> bool {
        self.rules.flat.contains(self.placed.object.cloud.labels[i])
    }
}

/// Casts parts, many at a time.
struct CastParts<'r, 'a, 'c, C> {
    rays: ObjectRays<'a>,
    points: Range<usize>,
    caster: &'r mut Caster<'c, C>,
    of_object: bool,
}

impl<C: Cell> Kernel for CastParts<'_, '_, '_, C> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        for start in self.points.clone().step_by(LANES) {
            let batch = start..self.points.end.min(start + LANES);
            self.cast_batch(batch);
        }
    }
}

impl<C: Cell> CastParts<'_, '_, '_, C> {
    #[inline(always)]
    fn cast_batch(&mut self, points: Range<usize>) {
        let ObjectRays { placed, place, spec, .. } = self.rays;
        let cloud = &placed.object.cloud;
        let (mut ends, mut entries) = ([Point3::origin(); LANES], [Point3::origin(); LANES]);
        ends[..points.len()].copy_from_slice(&cloud.positions[points.clone()]);
        for (lane, i) in points.clone().enumerate() {
            entries[lane] = placed.seen.entry(&cloud.origin(i), &ends[lane]);
        }
        let (ends, entries) = (spec.snap_lanes(&place, &ends), spec.snap_lanes(&place, &entries));
        let mut batch = Batch { end: ends, origin: entries, ..Batch::empty() };
        let inside = batch.ends_inside(self.caster.shape());
        (points.len()..LANES).for_each(|lane| batch.remove(lane));
        if !self.of_object {
            self.lead_to_origins(&mut batch, &points);
        }
        self.cast_misfits(&mut batch, points.start);
        if !self.caster.clips() {
            (0..LANES).filter(|lane| inside[*lane] == 0).for_each(|lane| batch.remove(lane));
        }
        if self.of_object {
            self.caster.hit_batch(&batch);
        }
        self.caster.cast_anywhere(&batch);
    }

    /// From the entries, which are the origins so far, to the true origins outside the box.
    #[inline(always)]
    fn lead_to_origins(&self, batch: &mut Batch, points: &Range<usize>) {
        let ObjectRays { placed, .. } = self.rays;
        batch.end = batch.origin;
        let mut known = None;
        for (lane, i) in points.clone().enumerate() {
            let of = placed.object.cloud.origin_of[i];
            if known.is_none_or(|(last, _)| last != of) {
                known = Some((of, self.rays.origin_outside(of)));
            }
            match known.and_then(|(_, origin)| origin) {
                None => batch.remove(lane),
                Some(origin) => batch.put_origin(lane, origin),
            }
        }
    }

    /// Takes out of a batch what is too far or too long for it, and casts it alone.
    #[inline(always)]
    fn cast_misfits(&mut self, batch: &mut Batch, start: usize) {
        let misfits = batch.misfits();
        if !any(&misfits) {
            return;
        }
        for lane in (0..LANES).filter(|lane| misfits[*lane] != 0) {
            batch.remove(lane);
            if let Some(ray) = self.rays.part(start + lane, self.of_object) {
                self.caster.cast(&ray);
            }
        }
    }
}
