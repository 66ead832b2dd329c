//! The background rays of a sweep, a bundle at a time.

use std::ops::Range;

use nalgebra::Point3;
use occlabel_core::{
    BUNDLE, BackgroundSweep, ClassId, ClassSet, GridSpec, Kernel, LatticePoint, RigidMap,
};

use crate::caster::{Caster, Ray};
use crate::cells::Cell;
use crate::ways::{Batch, LANES, any};

/// A sweep and where it belongs now.
#[derive(Clone, Copy)]
pub(crate) struct SweepRays<'a> {
    pub(crate) sweep: &'a BackgroundSweep<ClassId>,
    /// Grid from world.
    pub(crate) place: RigidMap,
    pub(crate) spec: &'a GridSpec,
    pub(crate) flat: &'a ClassSet,
}

impl SweepRays<'_> {
    /// Casts the rays of some points; the first of them begins a bundle.
    pub(crate) fn cast<C: Cell>(&self, points: Range<usize>, caster: &mut Caster<C>) {
        if !self.sweep.bundles.whole_reach(self.spec, &self.place).meets(self.spec) {
            return;
        }
        if caster.takes_batches() {
            caster.level().run(CastBundles { rays: *self, points, caster });
        } else {
            points.for_each(|i| caster.cast(&self.ray(i)));
        }
    }

    fn ray(&self, i: usize) -> Ray {
        let cloud = &self.sweep.cloud;
        let end = self.spec.snap(&self.place.apply(&cloud.positions[i]));
        let origin = self.spec.snap(&self.place.apply(&cloud.origin(i)));
        Ray::whole(end, origin, self.flat.contains(cloud.labels[i]))
    }
}

/// Casts bundles.
struct CastBundles<'r, 'a, 'c, C> {
    rays: SweepRays<'a>,
    points: Range<usize>,
    caster: &'r mut Caster<'c, C>,
}

impl<C: Cell> Kernel for CastBundles<'_, '_, '_, C> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let mut origin = None;
        for start in self.points.clone().step_by(BUNDLE) {
            let bundle = start..self.points.end.min(start + BUNDLE);
            if self.may_tell(&bundle) {
                self.cast_bundle(bundle, &mut origin);
            }
        }
    }
}

/// An origin by its number in the cloud, and where it stands on the lattice.
type KnownOrigin = Option<(u32, LatticePoint)>;

impl<C: Cell> CastBundles<'_, '_, '_, C> {
    /// Whether the way of some ray of a bundle may lie in the grid.
    #[inline(always)]
    fn may_tell(&self, bundle: &Range<usize>) -> bool {
        let SweepRays { sweep, place, spec, .. } = &self.rays;
        let mut reach = sweep.bundles.reach(bundle.start, spec, place);
        let mut last = None;
        for of in &sweep.cloud.origin_of[bundle.clone()] {
            if self.caster.clips() && last != Some(of) {
                last = Some(of);
                reach = reach.with(&place.apply(&sweep.cloud.origins[*of as usize]), spec);
            }
        }
        reach.meets(spec)
    }

    #[inline(always)]
    fn cast_bundle(&mut self, bundle: Range<usize>, known: &mut KnownOrigin) {
        let mut batch = self.snap_ends(&bundle);
        let cloud = &self.rays.sweep.cloud;
        let of = &cloud.origin_of[bundle.clone()];
        if of.iter().all(|other| *other == of[0]) {
            batch.share_origin(self.origin(bundle.start, known));
        } else {
            bundle.clone().enumerate().for_each(|(lane, i)| {
                batch.put_origin(lane, self.origin(i, known));
            });
        }
        if self.caster.asks_for_ground() {
            for (lane, class) in cloud.labels[bundle.clone()].iter().enumerate() {
                batch.flat[lane] = -i32::from(self.rays.flat.contains(*class));
            }
        }
        (bundle.len()..LANES).for_each(|lane| batch.remove(lane));
        self.cast_misfits(&mut batch, bundle.start);
        self.caster.cast_batch(&mut batch);
    }

    #[inline(always)]
    fn snap_ends(&self, bundle: &Range<usize>) -> Batch {
        let SweepRays { sweep, place, spec, .. } = &self.rays;
        let mut points = [Point3::origin(); LANES];
        points[..bundle.len()].copy_from_slice(&sweep.cloud.positions[bundle.clone()]);
        Batch { end: spec.snap_lanes(place, &points), ..Batch::empty() }
    }

    #[inline(always)]
    fn origin(&self, i: usize, known: &mut KnownOrigin) -> LatticePoint {
        let SweepRays { sweep, place, spec, .. } = &self.rays;
        let of = sweep.cloud.origin_of[i];
        match *known {
            Some((last, origin)) if last == of => origin,
            _ => {
                let origin = spec.snap(&place.apply(&sweep.cloud.origins[of as usize]));
                *known = Some((of, origin));
                origin
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
            self.caster.cast(&self.rays.ray(start + lane));
        }
    }
}
