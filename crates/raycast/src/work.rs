//! The rays of an instant, as pieces of work.

use std::ops::Range;

use occlabel_core::{BackgroundSweep, ClassId, GridSpec, Instant, PlacedObject, Pose, RigidMap};

use crate::caster::Caster;
use crate::cells::Cell;
use crate::object_rays::ObjectRays;
use crate::sweep_rays::SweepRays;
use crate::{ObjectRays as Which, RayRules};

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
    pub(crate) fn of(instant: &'a Instant<'a>, object_rays: Which) -> Vec<Self> {
        let background = instant.background.iter().map(|sweep| Kind::Background(sweep));
        let objects = instant.objects.iter().flat_map(|placed| {
            let now = placed.grid_from_box;
            let (first, second) = match object_rays {
                Which::Own => {
                    (now.map(|pose| Kind::ObjectPart(placed, pose)), Some(Kind::WorldPart(placed)))
                }
                Which::Current => (now.map(|pose| Kind::Current(placed, pose)), None),
                Which::Hits => (now.map(|pose| Kind::Hits(placed, pose)), None),
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
        time.is_some_and(|time| time.seconds_apart(instant.time) > same_time_s)
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
                ObjectRays::new(placed, &pose, spec, rules).cast_object_parts(points, caster);
            }
            Kind::WorldPart(placed) => {
                let pose = placed.grid_from_seen_box;
                ObjectRays::new(placed, &pose, spec, rules).cast_world_parts(points, caster);
            }
            Kind::Current(placed, pose) => {
                let (rays, lidar) =
                    (ObjectRays::new(placed, &pose, spec, rules), &instant.reference_lidar);
                points.for_each(|i| caster.cast(&rays.whole(i, lidar)));
            }
            Kind::Hits(placed, pose) => {
                let rays = ObjectRays::new(placed, &pose, spec, rules);
                points.for_each(|i| caster.hit(rays.end(i).voxel()));
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
