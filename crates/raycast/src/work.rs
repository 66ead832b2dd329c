//! The rays of an instant, as pieces of work.

use std::ops::Range;

use occlabel_core::{
    BackgroundSweep, ClassId, GridSpec, Instant, LatticePoint, PlacedObject, Pose, RigidMap,
};

use crate::caster::{Caster, Ray};
use crate::cells::Cell;
use crate::near::RayEnds;
use crate::sweep_rays::SweepRays;
use crate::{ObjectRays, RayRules};

/// Points of a piece of work: enough to repay a thread, few enough to share out evenly.
const POINTS_A_PIECE: usize = 4096;

/// Some rays of one kind.
#[derive(Clone, Debug)]
pub(crate) struct Work<'a> {
    kind: Kind<'a>,
    points: Range<usize>,
}

#[derive(Clone, Copy, Debug)]
enum Kind<'a> {
    /// Rays of background points, from their own origins.
    Background(&'a BackgroundSweep<ClassId>),
    /// From point to entry, where the track stands now.
    ObjectPart(&'a PlacedObject<'a>, Pose),
    /// From entry to origin, where it was seen.
    WorldPart(&'a PlacedObject<'a>),
    /// From the point, where the track stands now, to the reference lidar.
    Current(&'a PlacedObject<'a>, Pose),
    /// The point alone, where the track stands now.
    Hits(&'a PlacedObject<'a>, Pose),
}

impl<'a> Work<'a> {
    /// All rays of an instant.
    pub(crate) fn of(instant: &'a Instant<'a>, object_rays: ObjectRays) -> Vec<Self> {
        let background = instant.background.iter().map(|sweep| Kind::Background(sweep));
        let objects = instant.objects.iter().flat_map(|placed| {
            let now = placed.grid_from_box;
            let (first, second) = match object_rays {
                ObjectRays::Own => {
                    (now.map(|pose| Kind::ObjectPart(placed, pose)), Some(Kind::WorldPart(placed)))
                }
                ObjectRays::Current => (now.map(|pose| Kind::Current(placed, pose)), None),
                ObjectRays::Hits => (now.map(|pose| Kind::Hits(placed, pose)), None),
            };
            first.into_iter().chain(second)
        });
        background.chain(objects).flat_map(Kind::pieces).collect()
    }

    /// Whether these rays saw the air of another time: see [`crate::RaySettings::same_time_s`].
    pub(crate) fn is_of_another_time(&self, instant: &Instant, same_time_s: f64) -> bool {
        let time = match self.kind {
            Kind::Background(sweep) => sweep.time,
            Kind::WorldPart(placed) => placed.object.time,
            Kind::ObjectPart(..) | Kind::Current(..) | Kind::Hits(..) => return false,
        };
        time.seconds_apart(instant.time) > same_time_s
    }

    /// Casts the rays.
    pub(crate) fn cast<C: Cell>(
        &self,
        instant: &Instant,
        spec: &GridSpec,
        rules: &RayRules,
        caster: &mut Caster<C>,
    ) {
        let points = self.points.clone();
        match self.kind {
            Kind::Background(sweep) => {
                let place = RigidMap::from(&instant.grid_from_world);
                SweepRays { sweep, place, spec, flat: rules.flat }.cast(points, caster);
            }
            Kind::ObjectPart(placed, pose) => {
                let place = RigidMap::from(&pose);
                points.for_each(|i| caster.cast(&object_part(placed, i, &place, spec, rules)));
            }
            Kind::WorldPart(placed) => {
                let place = RigidMap::from(&placed.grid_from_seen_box);
                points
                    .filter_map(|i| world_part(placed, i, &place, spec, rules))
                    .for_each(|ray| caster.cast(&ray));
            }
            Kind::Current(placed, pose) => {
                let (place, lidar) = (RigidMap::from(&pose), spec.snap(&instant.reference_lidar));
                points
                    .for_each(|i| caster.cast(&current_ray(placed, i, &place, lidar, spec, rules)));
            }
            Kind::Hits(placed, pose) => {
                let place = RigidMap::from(&pose);
                points.for_each(|i| caster.hit(snapped_point(placed, i, &place, spec).voxel()));
            }
        }
    }
}

impl<'a> Kind<'a> {
    fn len(&self) -> usize {
        match self {
            Kind::Background(sweep) => sweep.cloud.len(),
            Kind::WorldPart(placed)
            | Kind::ObjectPart(placed, _)
            | Kind::Current(placed, _)
            | Kind::Hits(placed, _) => placed.object.cloud.len(),
        }
    }

    fn pieces(self) -> impl Iterator<Item = Work<'a>> {
        let len = self.len();
        (0..len)
            .step_by(POINTS_A_PIECE)
            .map(move |start| Work { kind: self, points: start..len.min(start + POINTS_A_PIECE) })
    }
}

fn snapped_point(
    placed: &PlacedObject,
    i: usize,
    place: &RigidMap,
    spec: &GridSpec,
) -> LatticePoint {
    spec.snap(&place.apply(&placed.object.cloud.positions[i]))
}

fn current_ray(
    placed: &PlacedObject,
    i: usize,
    place: &RigidMap,
    lidar: LatticePoint,
    spec: &GridSpec,
    rules: &RayRules,
) -> Ray {
    let is_flat = rules.flat.contains(placed.object.cloud.labels[i]);
    Ray::whole(snapped_point(placed, i, place, spec), lidar, is_flat)
}

/// `origin ----- world part ----- entry --- object part --- point`: the part after the entry.
fn object_part(
    placed: &PlacedObject,
    i: usize,
    place: &RigidMap,
    spec: &GridSpec,
    rules: &RayRules,
) -> Ray {
    let (point, origin) = (placed.object.cloud.positions[i], placed.object.origin(i));
    let entry = placed.seen.entry(&origin, &point);
    let end = spec.snap(&place.apply(&point));
    Ray {
        end,
        origin: spec.snap(&place.apply(&entry)),
        hits: true,
        ends: RayEnds {
            point: end.voxel(),
            origin: spec.snap(&place.apply(&origin)).voxel(),
            is_flat: rules.flat.contains(placed.object.cloud.labels[i]),
        },
    }
}

/// The part before the entry; none if the origin is inside the box.
fn world_part(
    placed: &PlacedObject,
    i: usize,
    place: &RigidMap,
    spec: &GridSpec,
    rules: &RayRules,
) -> Option<Ray> {
    let (point, origin) = (placed.object.cloud.positions[i], placed.object.origin(i));
    if placed.seen.contains(&origin) {
        return None;
    }
    let entry = placed.seen.entry(&origin, &point);
    let snapped_origin = spec.snap(&place.apply(&origin));
    Some(Ray {
        end: spec.snap(&place.apply(&entry)),
        origin: snapped_origin,
        hits: false,
        ends: RayEnds {
            point: spec.snap(&place.apply(&point)).voxel(),
            origin: snapped_origin.voxel(),
            is_flat: rules.flat.contains(placed.object.cloud.labels[i]),
        },
    })
}
