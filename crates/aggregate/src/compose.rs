//! One instant of the scene (labels.md section 6).

use std::borrow::Cow;
use std::collections::BTreeMap;

use nalgebra::Point3;
use occlabel_core::{
    AggregatedScene, BackgroundSweep, BoxGrowth, ClassId, ClassSet, GrownBox, Instant, ObjectSweep,
    PlacedObject, PointCloud, Pose, StandingBox, Timestamp, TrackId,
};

use crate::TrackBox;

/// Which sweeps serve a keyframe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowSettings {
    /// Sweeps at most this far from the keyframe serve it, seconds.
    pub window_s: f64,
    /// The same for points of tracks whose shape changes, seconds.
    pub deformable_window_s: f64,
    /// Background points farther than this from the ego's origin do not serve a keyframe, metres;
    /// `None`: all do.
    pub radius_m: Option<f64>,
    /// Classes whose shape changes.
    pub deformable: ClassSet,
    /// How boxes are grown: as when the sweeps were split.
    pub growth: BoxGrowth,
}

/// The moment to compose.
#[derive(Clone, Debug)]
pub struct Moment<'a> {
    /// The keyframe's time.
    pub time: Timestamp,
    /// Where the grid stands.
    pub grid_from_world: Pose,
    /// Where the ego's origin stands, world.
    pub ego: Point3<f64>,
    /// Where the reference lidar stands, grid frame.
    pub reference_lidar: Point3<f64>,
    /// Boxes of the tracks that stand at that time: annotated or interpolated ones.
    pub standing: &'a [TrackBox],
}

/// Places every point of the window where it belongs at that moment. Nothing is copied unless a radius
/// cuts it.
pub fn compose<'a>(
    scene: &'a AggregatedScene<ClassId>,
    moment: &Moment,
    settings: &WindowSettings,
) -> Instant<'a> {
    let standing: Vec<_> =
        moment.standing.iter().map(|track| stand(track, moment, settings)).collect();
    let placed: BTreeMap<TrackId, Pose> =
        standing.iter().map(|boxed| (boxed.track, boxed.grid_from_box)).collect();
    let is_near = |time| is_within(time, moment.time, settings.window_s);
    Instant {
        time: moment.time,
        grid_from_world: moment.grid_from_world,
        reference_lidar: moment.reference_lidar,
        background: (scene.background.iter())
            .filter(|sweep| is_near(sweep.time))
            .map(|sweep| cut(sweep, moment, settings))
            .collect(),
        objects: (scene.objects.iter())
            .filter(|object| is_near(object.time) && keeps_shape(object, moment.time, settings))
            .map(|object| PlacedObject {
                object,
                grid_from_seen_box: moment.grid_from_world * object.boxed.world_from_box,
                seen: GrownBox::new(&object.boxed.size_m, &settings.growth),
                grid_from_box: placed.get(&object.track).copied(),
            })
            .collect(),
        standing,
    }
}

/// Whether points of a time serve a moment: those of no time always do.
fn is_within(time: Option<Timestamp>, moment: Timestamp, window_s: f64) -> bool {
    time.is_none_or(|time| time.seconds_apart(moment) <= window_s)
}

/// A sweep without what is too far from the ego.
fn cut<'a>(
    sweep: &'a BackgroundSweep<ClassId>,
    moment: &Moment,
    settings: &WindowSettings,
) -> Cow<'a, BackgroundSweep<ClassId>> {
    let Some(radius_m) = settings.radius_m else { return Cow::Borrowed(sweep) };
    let cloud = &sweep.cloud;
    let mut near = PointCloud::with_origins(cloud.origins.clone());
    for (i, position) in cloud.positions.iter().enumerate() {
        if (position - moment.ego).norm() <= radius_m {
            near.push(*position, cloud.labels[i], cloud.origin_of[i]);
        }
    }
    Cow::Owned(BackgroundSweep::new(sweep.time, near))
}

fn stand(track: &TrackBox, moment: &Moment, settings: &WindowSettings) -> StandingBox {
    StandingBox {
        track: track.track,
        boxed: track.boxed.clone(),
        grown: GrownBox::new(&track.boxed.size_m, &settings.growth),
        grid_from_box: moment.grid_from_world * track.boxed.world_from_box,
    }
}

/// Whether the object still has the shape it had in that sweep: limbs summed over a drive would
/// smear in a rigid box.
fn keeps_shape(object: &ObjectSweep, time: Timestamp, settings: &WindowSettings) -> bool {
    let is_deformable =
        object.cloud.labels.first().is_some_and(|c| settings.deformable.contains(*c));
    !is_deformable || is_within(object.time, time, settings.deformable_window_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use occlabel_core::{BackgroundSweep, Box3, PointCloud};

    const PERSON: ClassId = ClassId(7);
    const CAR: ClassId = ClassId(4);

    fn boxed(x: f64) -> Box3 {
        Box3 { world_from_box: Pose::translation(x, 0.0, 0.0), size_m: Vector3::repeat(2.0) }
    }

    fn scene(times: &[i64], class: ClassId) -> AggregatedScene<ClassId> {
        let cloud =
            || PointCloud::from_one_origin(Point3::origin(), vec![Point3::origin()], vec![class]);
        let background = |&s: &i64| BackgroundSweep::new(seconds(s), cloud());
        let object = |&s: &i64| ObjectSweep {
            track: TrackId(1),
            time: Some(seconds(s)),
            boxed: boxed(s as f64),
            cloud: cloud(),
        };
        let background = times.iter().map(background).collect();
        AggregatedScene::new(background, times.iter().map(object).collect())
    }

    fn seconds(s: i64) -> Timestamp {
        Timestamp(s * 1_000_000_000)
    }

    fn settings() -> WindowSettings {
        WindowSettings {
            window_s: 2.0,
            deformable_window_s: 1.0,
            radius_m: None,
            deformable: [PERSON].into_iter().collect(),
            growth: BoxGrowth { scale: 1.0, margin_m: 0.0 },
        }
    }

    fn moment(standing: &[TrackBox]) -> Moment<'_> {
        Moment {
            time: seconds(3),
            grid_from_world: Pose::translation(-100.0, 0.0, 0.0),
            ego: Point3::new(100.0, 0.0, 0.0),
            reference_lidar: Point3::origin(),
            standing,
        }
    }

    #[test]
    fn section_4_the_window_is_closed_and_tighter_for_what_changes_shape() {
        let standing = [TrackBox { track: TrackId(1), class: Some(CAR), boxed: boxed(9.0) }];
        let times = [0, 1, 2, 3, 4, 5, 6];
        let counts = |class| {
            let scene = scene(&times, class);
            let instant = compose(&scene, &moment(&standing), &settings());
            (instant.background.len(), instant.objects.len())
        };
        assert_eq!(counts(CAR), (5, 5));
        assert_eq!(counts(PERSON), (5, 3));
    }

    #[test]
    fn section_4_points_of_no_time_serve_every_keyframe() {
        let mut scene = scene(&[3], PERSON);
        scene.background[0].time = None;
        scene.objects[0].time = None;
        let long_ago = Moment { time: seconds(-900), ..moment(&[]) };
        let instant = compose(&scene, &long_ago, &settings());
        assert_eq!((instant.background.len(), instant.objects.len()), (1, 1));
    }

    #[test]
    fn section_6_a_radius_cuts_the_background_and_its_limit_is_closed() {
        let places = [[100.0, 3.0, 4.0], [100.0, 3.1, 4.0], [0.0; 3]];
        let positions = places.map(Point3::from).to_vec();
        let cloud = PointCloud::from_one_origin(Point3::origin(), positions, vec![CAR; 3]);
        let scene = AggregatedScene::new(vec![BackgroundSweep::new(seconds(3), cloud)], vec![]);
        let cut = |radius_m| {
            let settings = WindowSettings { radius_m, ..settings() };
            compose(&scene, &moment(&[]), &settings).background[0].cloud.positions.clone()
        };
        assert_eq!(cut(Some(5.0)), [Point3::from(places[0])]);
        assert_eq!(cut(None).len(), 3);
    }

    #[test]
    fn section_6_a_standing_track_is_placed_by_its_box_of_that_time() {
        let standing = [TrackBox { track: TrackId(1), class: Some(CAR), boxed: boxed(9.0) }];
        let scene = scene(&[3], CAR);
        let instant = compose(&scene, &moment(&standing), &settings());
        let x = |pose: Pose| pose.translation.x;
        assert_eq!(instant.objects[0].grid_from_box.map(x), Some(-91.0));
        assert_eq!(x(instant.objects[0].grid_from_seen_box), -97.0);
    }

    #[test]
    fn section_6_a_track_without_a_box_then_is_left_out() {
        let scene = scene(&[3], CAR);
        let instant = compose(&scene, &moment(&[]), &settings());
        assert!(instant.objects[0].grid_from_box.is_none() && instant.standing.is_empty());
    }
}
