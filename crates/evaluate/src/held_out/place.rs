//! Bringing held-out sweeps to a keyframe (labels.md sections 6 and 8).

use nalgebra::Point3;
use occlabel_core::{
    AggregatedScene, BackgroundSweep, BoxGrowth, ClassId, ClassSet, GrownBox, ObjectSweep, Pose,
    RigidMap, StandingBox, Timestamp,
};

/// A ray of a held-out sweep and its return. Grid frame, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOutRay {
    /// Where it starts to be asked: the lidar, or for a track where it enters the track's box.
    pub origin: Point3<f64>,
    /// Its return.
    pub point: Point3<f64>,
    /// What returned it.
    pub source: Source,
    /// Whether it saw the air of a time at which tracks stood elsewhere.
    pub is_of_another_time: bool,
}

/// What returned a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Something outside every box, with its own label if it has one.
    Background(Option<ClassId>),
    /// A track, whose box carried the ray to the keyframe.
    Track,
}

/// The keyframe that is judged.
#[derive(Clone, Debug)]
pub struct JudgedMoment<'a> {
    /// Its time.
    pub time: Timestamp,
    /// Where its grid stands.
    pub grid_from_world: Pose,
    /// Tracks that stand then.
    pub standing: &'a [StandingBox],
    /// How boxes were grown when the sweeps were sorted.
    pub growth: BoxGrowth,
    /// Rays of background at most so far from the keyframe saw its own air, seconds.
    pub same_time_s: f64,
    /// Points of deformable tracks at most so far from the keyframe are comparable, seconds.
    pub deformable_window_s: f64,
    /// Classes whose shape changes.
    pub deformable: ClassSet,
}

/// The rays of those held-out sweeps whose time `is_asked`, brought to a keyframe.
///
/// Background stays in the world. A track that stands at the keyframe carries its points and the
/// part of their rays inside its grown box; the part before it stays unasked, as does a track that
/// is absent, or whose shape has changed.
pub fn place(
    held: &AggregatedScene<Option<ClassId>>,
    moment: &JudgedMoment,
    is_asked: impl Fn(Timestamp) -> bool,
) -> Vec<HeldOutRay> {
    let background = held.background.iter().filter(|sweep| sweep.time.is_some_and(&is_asked));
    let objects = held.objects.iter().filter(|object| object.time.is_some_and(&is_asked));
    let mut rays: Vec<_> = background.flat_map(|sweep| background_rays(sweep, moment)).collect();
    rays.extend(objects.flat_map(|object| track_rays(object, moment)));
    rays
}

fn background_rays(
    sweep: &BackgroundSweep<Option<ClassId>>,
    moment: &JudgedMoment,
) -> impl Iterator<Item = HeldOutRay> {
    let place = RigidMap::from(&moment.grid_from_world);
    let is_of_another_time =
        sweep.time.is_some_and(|time| time.seconds_apart(moment.time) > moment.same_time_s);
    let cloud = &sweep.cloud;
    (0..cloud.len()).map(move |i| HeldOutRay {
        origin: place.apply(&cloud.origin(i)),
        point: place.apply(&cloud.positions[i]),
        source: Source::Background(cloud.labels[i]),
        is_of_another_time,
    })
}

fn track_rays(object: &ObjectSweep, moment: &JudgedMoment) -> impl Iterator<Item = HeldOutRay> {
    let standing = moment.standing.iter().find(|boxed| boxed.track == object.track);
    let place = standing
        .filter(|_| keeps_shape(object, moment))
        .map(|boxed| RigidMap::from(&boxed.grid_from_box));
    let grown = GrownBox::new(&object.boxed.size_m, &moment.growth);
    place.into_iter().flat_map(move |place| {
        (0..object.cloud.len()).map(move |i| {
            let point = object.cloud.positions[i];
            HeldOutRay {
                origin: place.apply(&grown.entry(&object.origin(i), &point)),
                point: place.apply(&point),
                source: Source::Track,
                is_of_another_time: false,
            }
        })
    })
}

fn keeps_shape(object: &ObjectSweep, moment: &JudgedMoment) -> bool {
    let class = object.cloud.labels.first();
    !class.is_some_and(|class| moment.deformable.contains(*class))
        || (object.time)
            .is_none_or(|time| time.seconds_apart(moment.time) <= moment.deformable_window_s)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use occlabel_core::{Box3, PointCloud, TrackId};

    use super::*;

    const CAR: ClassId = ClassId(4);
    const PERSON: ClassId = ClassId(7);
    const GROWTH: BoxGrowth = BoxGrowth { scale: 1.0, margin_m: 0.0 };

    fn standing(track: u16, x: f64) -> StandingBox {
        let size_m = Vector3::new(2.0, 2.0, 2.0);
        let world_from_box = Pose::translation(x, 0.0, 0.0);
        StandingBox {
            track: TrackId(track),
            boxed: Box3 { world_from_box, size_m },
            grown: GrownBox::new(&size_m, &GROWTH),
            grid_from_box: Pose::translation(x - 100.0, 0.0, 0.0),
        }
    }

    fn object(track: u16, class: ClassId) -> ObjectSweep {
        let boxed = standing(track, 10.0).boxed;
        let (origin, point) = (Point3::new(-10.0, 0.0, 0.0), Point3::new(0.5, 0.0, 0.0));
        let cloud = PointCloud::from_one_origin(origin, vec![point], vec![class]);
        ObjectSweep { track: TrackId(track), time: Some(Timestamp(400_000_000)), boxed, cloud }
    }

    fn held(objects: Vec<ObjectSweep>) -> AggregatedScene<Option<ClassId>> {
        let point = vec![Point3::new(7.0, 0.0, 0.0)];
        let cloud = PointCloud::from_one_origin(Point3::origin(), point, vec![None]);
        let background = vec![BackgroundSweep::new(Timestamp(400_000_000), cloud)];
        AggregatedScene::new(background, objects)
    }

    fn moment(standing: &[StandingBox]) -> JudgedMoment<'_> {
        JudgedMoment {
            time: Timestamp(0),
            grid_from_world: Pose::translation(-100.0, 0.0, 0.0),
            standing,
            growth: GROWTH,
            same_time_s: 0.05,
            deformable_window_s: 0.25,
            deformable: [PERSON].into_iter().collect(),
        }
    }

    #[test]
    fn background_stays_in_the_world_and_knows_its_time() {
        let rays = place(&held(vec![]), &moment(&[]), |_| true);
        assert_eq!(rays.len(), 1);
        assert_eq!((rays[0].origin.x, rays[0].point.x), (-100.0, -93.0));
        assert!(rays[0].is_of_another_time);
        let now = JudgedMoment { time: Timestamp(370_000_000), ..moment(&[]) };
        assert!(!place(&held(vec![]), &now, |_| true)[0].is_of_another_time);
        assert!(place(&held(vec![]), &now, |_| false).is_empty());
    }

    #[test]
    fn a_track_carries_its_points_from_the_face_of_its_box_on() {
        let standing = [standing(3, 20.0)];
        let rays = place(&held(vec![object(3, CAR)]), &moment(&standing), |_| true);
        let carried = rays.last().unwrap();
        assert_eq!((carried.origin.x, carried.point.x), (-81.0, -79.5));
        assert_eq!((carried.source, carried.is_of_another_time), (Source::Track, false));
    }

    #[test]
    fn an_absent_track_and_one_that_changed_its_shape_are_not_asked() {
        let standing = [standing(3, 20.0)];
        let rays = |object| place(&held(vec![object]), &moment(&standing), |_| true).len();
        assert_eq!(
            [rays(object(3, CAR)), rays(object(4, CAR)), rays(object(3, PERSON))],
            [2, 1, 1]
        );
    }
}
