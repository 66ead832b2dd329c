//! Classes from the pixels that points fall on (labels.md section 5).

use std::collections::BTreeMap;

use nalgebra::Point3;
use occlabel_core::{
    BackgroundSweep, Brush, Camera, ClassId, ClassMask, ObjectSweep, Pose, TrackId,
};
use serde::{Deserialize, Serialize};

use crate::depth_buffer::DepthBuffer;

/// Which pixels may give a point its class.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PaintSettings {
    /// An exposure paints the sweeps that are at most so far from it in time, seconds.
    pub max_dt_s: f64,
    /// A point farther than this behind the nearest return of its pixel is hidden, metres.
    pub occlusion_m: f64,
    /// A return hides what is behind it in so many pixels to each side of its own.
    pub splat_px: u32,
}

/// An exposure with its mask.
#[derive(Clone, Debug)]
pub struct View<'a> {
    /// The camera's optics.
    pub camera: &'a Camera,
    /// Where it was exposed.
    pub camera_from_world: Pose,
    /// What its pixels show.
    pub mask: &'a ClassMask,
    /// Where the tracks stood when it was exposed; one that is not listed is taken as the sweep saw it.
    pub world_from_box: BTreeMap<TrackId, Pose>,
}

/// What a camera says of a point.
#[derive(Clone, Copy, Debug)]
struct Vote {
    point: u32,
    class: ClassId,
    brush: Brush,
    /// From the camera to the point, metres.
    distance_m: f32,
}

/// Gives unlabelled background points the classes that cameras see there.
///
/// A camera votes for a point with the class of the pixel that the point falls on, if no return of
/// the sweep is nearer there; `objects` are the sweep's points of tracks, which hide what is behind
/// them where they stood when the camera was exposed. Most votes win, ties go to the camera that is
/// nearest to the point, then to the first. At most one view of each camera. (MobileOcc.)
pub fn paint(
    mut background: BackgroundSweep<Option<ClassId>>,
    objects: &[&ObjectSweep],
    views: &[View],
    settings: &PaintSettings,
) -> BackgroundSweep<Option<ClassId>> {
    let look = |view: &View| view.votes(&background, objects, settings);
    let mut votes: Vec<Vote> = views.iter().flat_map(look).collect();
    // A stable sort: of one point, the votes stay in order of cameras.
    votes.sort_by_key(|vote| vote.point);
    for of_point in votes.chunk_by(|a, b| a.point == b.point) {
        let won = winner(of_point);
        background.brushes.resize(background.cloud.len(), Brush::NONE);
        background.cloud.labels[won.point as usize] = Some(won.class);
        background.brushes[won.point as usize] = won.brush;
    }
    background
}

/// Of the votes for one point the nearest camera's for the class that has most; ties by distance.
fn winner(votes: &[Vote]) -> &Vote {
    let count = |class| votes.iter().filter(|vote| vote.class == class).count();
    let better = |best: &'_ Vote, vote: &'_ Vote| {
        let (best_count, vote_count) = (count(best.class), count(vote.class));
        vote_count > best_count || vote_count == best_count && vote.distance_m < best.distance_m
    };
    let first = votes.first().expect("a point with a vote");
    votes.iter().fold(first, |best, vote| if better(best, vote) { vote } else { best })
}

impl View<'_> {
    fn votes(
        &self,
        background: &BackgroundSweep<Option<ClassId>>,
        objects: &[&ObjectSweep],
        settings: &PaintSettings,
    ) -> Vec<Vote> {
        let seen: Vec<_> = (0..)
            .zip(&background.cloud.positions)
            .filter_map(|(point, position)| {
                let (pixel, distance_m) = self.look_at(&(self.camera_from_world * position))?;
                Some((point, pixel, distance_m))
            })
            .collect();
        let mut buffer = DepthBuffer::new(self.camera.width, self.camera.height);
        seen.iter().for_each(|(_, pixel, far_m)| buffer.splat(*pixel, *far_m, settings.splat_px));
        objects.iter().for_each(|object| self.splat_object(object, &mut buffer, settings.splat_px));
        let is_hidden = |pixel, distance_m: f32| {
            f64::from(distance_m) > f64::from(buffer.nearest_m(pixel)) + settings.occlusion_m
        };
        let vote = |(point, pixel, distance_m): (u32, (u32, u32), f32)| {
            let is_open = background.cloud.labels[point as usize].is_none();
            let (class, brush) = self.mask.at(pixel.0, pixel.1).filter(|_| is_open)?;
            (!is_hidden(pixel, distance_m)).then_some(Vote { point, class, brush, distance_m })
        };
        seen.into_iter().filter_map(vote).collect()
    }

    /// The points of a track, where it stood when the camera was exposed.
    fn splat_object(&self, object: &ObjectSweep, buffer: &mut DepthBuffer, splat_px: u32) {
        let world_from_box = self.world_from_box.get(&object.track);
        let world_from_box = world_from_box.unwrap_or(&object.boxed.world_from_box);
        let camera_from_box = self.camera_from_world * world_from_box;
        let seen =
            object.cloud.positions.iter().filter_map(|p| self.look_at(&(camera_from_box * p)));
        seen.for_each(|(pixel, distance_m)| buffer.splat(pixel, distance_m, splat_px));
    }

    /// The pixel that sees a point of the camera frame, and how far the point is, metres.
    fn look_at(&self, in_camera: &Point3<f64>) -> Option<((u32, u32), f32)> {
        Some((self.camera.pixel_of(in_camera)?, in_camera.coords.norm() as f32))
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use nalgebra::Vector3;
    use occlabel_core::camera::{CameraModel, Intrinsics, Pinhole};
    use occlabel_core::{Box3, PointCloud, Timestamp};
    use proptest::prelude::*;

    use super::*;

    const ROAD: ClassId = ClassId(0);
    const CAR: ClassId = ClassId(1);
    const SETTINGS: PaintSettings = PaintSettings { max_dt_s: 0.1, occlusion_m: 0.5, splat_px: 1 };

    /// 8 x 4 pixels, one for each metre at 4 m of distance; the optical axis is the world's z.
    fn camera() -> Camera {
        let k = [[4.0, 0.0, 4.0], [0.0, 4.0, 2.0], [0.0, 0.0, 1.0]];
        Camera {
            model: CameraModel::Pinhole(Pinhole::new(Intrinsics::from_matrix(&k).unwrap())),
            width: 8,
            height: 4,
            body_mask: None,
            rolling_shutter: None,
        }
    }

    /// Where the pixel's ray is so many metres along the optical axis.
    fn at(column: u32, row: u32, depth_m: f64) -> Point3<f64> {
        let offset = |pixel: u32, centre: f64| (f64::from(pixel) + 0.5 - centre) / 4.0 * depth_m;
        Point3::new(offset(column, 4.0), offset(row, 2.0), depth_m)
    }

    /// The left half shows road, the right half a car, the upmost row nothing.
    fn halves() -> ClassMask {
        let classes = (0..32).map(|place| match (place / 8, place % 8) {
            (0, _) => None,
            (_, 0..4) => Some(ROAD),
            _ => Some(CAR),
        });
        ClassMask::new(8, 4, classes)
    }

    fn view<'a>(camera: &'a Camera, mask: &'a ClassMask, x_m: f64) -> View<'a> {
        let camera_from_world = Pose::translation(-x_m, 0.0, 0.0);
        View { camera, camera_from_world, mask, world_from_box: BTreeMap::new() }
    }

    fn sweep(points: &[(Point3<f64>, Option<ClassId>)]) -> BackgroundSweep<Option<ClassId>> {
        let (positions, labels) = points.iter().copied().unzip();
        let cloud = PointCloud::from_one_origin(Point3::origin(), positions, labels);
        BackgroundSweep::new(Timestamp(0), cloud)
    }

    fn painted(
        points: &[(Point3<f64>, Option<ClassId>)],
        objects: &[&ObjectSweep],
        views: &[View],
    ) -> Vec<Option<ClassId>> {
        paint(sweep(points), objects, views, &SETTINGS).cloud.labels
    }

    #[test]
    fn section_5_a_point_takes_the_class_of_its_pixel_if_it_has_none() {
        let points = [
            (at(1, 2, 4.0), None),
            (at(6, 2, 9.0), None),
            (at(6, 3, 9.0), Some(ROAD)),
            (at(2, 0, 5.0), None),
            (at(9, 2, 4.0), None),
            (Point3::new(0.0, 0.0, -3.0), None),
        ];
        let (camera, mask) = (camera(), halves());
        let labels = painted(&points, &[], &[view(&camera, &mask, 0.0)]);
        assert_eq!(labels, [Some(ROAD), Some(CAR), Some(ROAD), None, None, None]);
    }

    #[test]
    fn section_5_what_is_behind_the_nearest_return_of_its_pixel_is_hidden() {
        let near = at(2, 2, 4.0);
        let behind = |column, depth_m| (at(column, 2, depth_m), None);
        let points = [(near, None), behind(3, 6.0), behind(3, 4.4), behind(5, 6.0)];
        let (camera, mask) = (camera(), halves());
        let labels = painted(&points, &[], &[view(&camera, &mask, 0.0)]);
        assert_eq!(labels, [Some(ROAD), None, Some(ROAD), Some(CAR)]);
    }

    #[test]
    fn section_5_a_track_hides_what_is_behind_it_where_it_stood_at_the_exposure() {
        let boxed = |x_m: f64| Box3 {
            world_from_box: Pose::translation(x_m, 0.0, 0.0),
            size_m: Vector3::repeat(1.0),
        };
        let cloud = PointCloud::from_one_origin(Point3::origin(), vec![at(1, 2, 4.0)], vec![CAR]);
        let (track, time) = (TrackId(3), Some(Timestamp(0)));
        let object = ObjectSweep { track, time, boxed: boxed(0.0), cloud };
        let points = [(at(1, 2, 8.0), None), (at(6, 2, 8.0), None)];
        let (camera, mask) = (camera(), halves());
        let seen = view(&camera, &mask, 0.0);
        assert_eq!(painted(&points, &[&object], std::slice::from_ref(&seen)), [None, Some(CAR)]);
        // By the exposure's time it has moved 5 m, which is 5 pixels at its distance.
        let world_from_box = [(track, boxed(5.0).world_from_box)].into();
        let moved = View { world_from_box, ..seen };
        assert_eq!(painted(&points, &[&object], &[moved]), [Some(ROAD), None]);
    }

    #[test]
    fn section_5_cameras_vote_and_the_nearer_one_wins_a_tie() {
        let (camera, road, car) = (
            camera(),
            ClassMask::new(8, 4, (0..32).map(|_| Some(ROAD))).with_instances(vec![5; 32]),
            ClassMask::new(8, 4, (0..32).map(|_| Some(CAR))),
        );
        let point = [(Point3::new(0.1, 0.1, 9.0), None)];
        let (far, near) = (view(&camera, &road, 3.0), view(&camera, &car, 1.0));
        assert_eq!(painted(&point, &[], &[far.clone(), near.clone()]), [Some(CAR)]);
        let two_far = [far, near, view(&camera, &road, 4.0)];
        let most = paint(sweep(&point), &[], &two_far, &SETTINGS);
        assert_eq!(most.cloud.labels, [Some(ROAD)]);
        assert_eq!(most.brushes, [Brush::of_instance(5)], "of a camera that voted for the class");
    }

    /// The oracle: a return hides another if it is in a pixel near the other's, and clearly nearer.
    fn is_open(points: &[Point3<f64>], place: usize, camera: &Camera) -> bool {
        let pixel = |p: &Point3<f64>| camera.pixel_of(p);
        let Some(own) = pixel(&points[place]) else { return false };
        let is_close = |(c, r): (u32, u32)| c.abs_diff(own.0) <= 1 && r.abs_diff(own.1) <= 1;
        let far_m = |p: &Point3<f64>| f64::from(p.coords.norm() as f32);
        let hides = |p: &&Point3<f64>| {
            pixel(p).is_some_and(is_close)
                && far_m(&points[place]) > far_m(p) + SETTINGS.occlusion_m
        };
        !points.iter().any(|p| hides(&p))
    }

    #[test]
    fn section_5_hidden_is_what_comparing_every_pair_says() {
        let (camera, mask) = (camera(), ClassMask::new(8, 4, (0..32).map(|_| Some(ROAD))));
        let (open, hidden) = (Cell::new(0), Cell::new(0));
        let point = (0_u32..9, 0_u32..5, 2_u32..24);
        proptest!(ProptestConfig::with_cases(300), |(places in prop::collection::vec(point, 1..30))| {
            let points: Vec<_> =
                places.iter().map(|&(c, r, depth)| at(c, r, f64::from(depth) / 2.0)).collect();
            let unlabelled: Vec<_> = points.iter().map(|point| (*point, None)).collect();
            let labels = painted(&unlabelled, &[], &[view(&camera, &mask, 0.0)]);
            for (place, label) in labels.iter().enumerate() {
                let expected = is_open(&points, place, &camera);
                prop_assert_eq!(label.is_some(), expected, "{:?}", points[place]);
                let count = if expected { &open } else { &hidden };
                count.set(count.get() + 1);
            }
        });
        assert!(open.get() > 1000 && hidden.get() > 1000, "{} {}", open.get(), hidden.get());
    }
}
