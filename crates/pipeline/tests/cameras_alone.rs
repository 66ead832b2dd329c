//! Clouds of no time, and cameras that alone tell what is free (labels.md sections 4, 6, 8, 9).

mod scenes;

use nalgebra::Point3;
use occlabel_core::{
    Box3, OccupancyLabels, PointCloud, PointLabel, PointsOf, Pose, SweepHeader, TrackId,
};
use occlabel_pipeline::Rules;
use occlabel_testkit::draw;
use scenes::{CAR, Drive, MANMADE, camera, class_at, header, looking_ahead, rules, track};

const BY_CAMERA: [&str; 4] = [
    "raycast.source=camera",
    "occlusion.rays=occupied-centers",
    "grid.voxel_size_m=1.0",
    "occlusion.depth_max_m=50",
];

/// 9 x 7 x 1 voxels of a metre, the camera in the middle of the lower edge, which looks up in drawings.
fn flat_rules(more: &[&str]) -> Rules {
    let grid = ["grid.min_m=[-0.5, -3.5, -0.5]", "grid.max_m=[8.5, 3.5, 0.5]"];
    rules(&[&BY_CAMERA[..], &grid, more].concat())
}

fn points(places: &[[f64; 2]]) -> PointCloud<PointLabel> {
    let positions: Vec<_> = places.iter().map(|[x, y]| Point3::new(*x, *y, 0.0)).collect();
    let labels = vec![PointLabel::Class(MANMADE); positions.len()];
    PointCloud::from_one_origin(Point3::origin(), positions, labels)
}

/// A pose at time 0 with a camera that sees 45 degrees to each side, and a cloud of the world.
fn drive(world: &[[f64; 2]]) -> Drive {
    let mut drive = Drive::default();
    let still =
        |points_of| SweepHeader { points_of, ..header(0.0, Pose::identity(), Pose::identity()) };
    drive.add_sweep(still(PointsOf::Nothing), points(&[]));
    drive.add_sweep(still(PointsOf::World), points(world));
    drive.scene.cameras = vec![camera("FRONT", 100, 0.786)];
    drive.add_keyframe(0, &[looking_ahead(&Pose::identity())]);
    drive
}

fn drawn(labels: &OccupancyLabels) -> String {
    draw([9, 7, 1], |voxel| class_at(labels, voxel), 0)
}

/// A wall of three voxels, two thick, and a post behind it to the side.
const WALL: [[f64; 2]; 7] =
    [[4.0, -1.0], [4.0, 0.0], [4.0, 1.0], [5.0, -1.0], [5.0, 0.0], [5.0, 1.0], [7.0, 0.0]];

#[test]
fn section_9_what_no_camera_ray_reaches_is_unobserved_occupied_or_not() {
    let labels = drive(&WALL).label(&flat_rules(&[]));
    // Free is what a ray to the centre of an occupied voxel crosses; the wall's far side and the post
    // are hidden, and what no ray crosses is not known to be free.
    let expected = "\
???????
???????
???????
???????
??###??
??...??
??...??
???.???
???.???
";
    assert_eq!(drawn(&labels), expected, "{}", drawn(&labels));
    assert_eq!(labels.mask_lidar, labels.mask_camera, "what is observed was seen");
    assert_eq!(labels.evidence().hits.at([5, 3, 0]), &1, "what is hidden was hit all the same");
}

#[test]
fn section_9_a_voxel_needs_its_hits_before_it_blocks() {
    let labels = drive(&WALL).label(&flat_rules(&["states.occupied_min_hits=2"]));
    assert!(
        drawn(&labels).chars().all(|voxel| voxel == '?' || voxel == '\n'),
        "{}",
        drawn(&labels)
    );
}

#[test]
fn section_6_a_track_of_no_time_stands_where_its_box_stands() {
    let mut drive = drive(&[[8.0, 0.0]]);
    let boxed = |x: f64| Box3 {
        world_from_box: Pose::translation(x, 1.0, 0.0),
        size_m: [1.0, 1.0, 1.0].into(),
    };
    let boxes = vec![(scenes::at(0.0), boxed(3.0)), (scenes::at(1.0), boxed(6.0))];
    drive.scene.tracks = vec![track(1, CAR, boxes)];
    let of_car = SweepHeader {
        points_of: PointsOf::Track(TrackId(1)),
        ..header(1.0, Pose::identity(), Pose::identity())
    };
    drive.add_sweep(of_car, points(&[[0.0, 0.0]]));
    let rules = flat_rules(&["aggregate.window_s=0.0", "aggregate.deformable_window_s=0.0"]);
    let labels = drive.label(&rules);
    assert_eq!(class_at(&labels, [3, 4, 0]), 'c', "{}", drawn(&labels));
    assert_eq!(class_at(&labels, [8, 3, 0]), '#', "the world's points are of no time either");
    assert_eq!(labels.evidence().instances.at([3, 4, 0]), &1);
}

#[test]
fn section_6_points_beyond_the_radius_do_not_serve() {
    let labels = |radius: &str| {
        drive(&[[4.0, -2.0], [8.0, 1.0]])
            .label(&flat_rules(&[&format!("aggregate.radius_m={radius}")]))
    };
    let is_there = |radius| class_at(&labels(radius), [8, 4, 0]) == '#';
    assert_eq!([is_there("8.0"), is_there("8.1"), is_there("none")], [false, true, true]);
}

#[test]
fn points_that_no_lidar_measured_need_the_cameras_rays() {
    let drive = drive(&WALL);
    let lidar = rules(&[]).check(&drive.scene).unwrap_err();
    assert_eq!(lidar.rule, "no-rays");
    assert!(lidar.hint.is_some_and(|hint| hint.contains("gs-occ3d")));
    assert!(flat_rules(&[]).check(&drive.scene).is_ok());
}
