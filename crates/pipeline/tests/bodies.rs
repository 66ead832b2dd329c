//! Bodies that are known by their surface (labels.md section 9a), in scenes small enough to draw.

mod scenes;

use nalgebra::{Point3, Vector3};
use occlabel_core::{
    Box3, LoggedMesh, OccupancyLabels, PointCloud, PointLabel, Pose, TrackId, TriangleMesh,
};
use occlabel_pipeline::{
    Fit, KeyframeMeshes, LabelOptions, Lenses, MeshFit, Rules, embody, label_keyframe, mesh_tracks,
};
use scenes::{
    Drive, MANMADE, OCCUPIED, PEDESTRIAN, at, camera, class_at, header, looking_ahead, small, track,
};

/// Where the lidar and the camera stand.
const EYE: [f64; 3] = [0.2, 0.2, 0.6];

/// A wall at x = 6.2 m, as the lidar sees it, and more points of the same label.
fn cloud(more: &[[f64; 3]]) -> PointCloud<PointLabel> {
    let mut cloud = PointCloud::with_origins(vec![Point3::from(EYE)]);
    let places = (0..28).flat_map(|y| (0..10).map(move |z| (f64::from(y), f64::from(z))));
    let wall = places.map(|(y, z)| [6.2, 0.25 * y - 3.4, 0.25 * z - 0.3]);
    for point in wall.chain(more.iter().copied()) {
        cloud.push(Point3::from(point), PointLabel::Class(MANMADE), 0);
    }
    cloud
}

/// A drive of sweeps half a second apart, a keyframe and an exposure at each.
fn drive(clouds: &[PointCloud<PointLabel>]) -> Drive {
    let mut drive = Drive::default();
    drive.scene.cameras.push(camera("CAM", 60, 0.7));
    let eye = Pose::translation(EYE[0], EYE[1], EYE[2]);
    for (number, cloud) in clouds.iter().enumerate() {
        let here = Pose::identity();
        drive.add_sweep(header(0.5 * number as f64, here, here), cloud.clone());
        drive.add_keyframe(number, &[looking_ahead(&eye)]);
    }
    drive
}

/// An upright block as a body: its lower corner and its sides.
fn block([x, y, z]: [f64; 3], [dx, dy, dz]: [f64; 3]) -> TriangleMesh {
    let corner = |n: u32| {
        let side = |bit: u32, low: f64, size: f64| low + f64::from(n >> bit & 1) * size;
        Point3::new(side(0, x, dx), side(1, y, dy), side(2, z, dz))
    };
    let faces = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    TriangleMesh::new((0..8).map(corner).collect(), faces).unwrap()
}

fn person_at(x: f64, y: f64) -> TriangleMesh {
    block([x, y, 0.02], [0.3, 0.8, 1.5])
}

/// The labels of all keyframes where each has these meshes, and what became of the meshes.
fn label(
    drive: &Drive,
    meshes: &[Vec<(&str, TriangleMesh)>],
    rules: &Rules,
) -> (Vec<OccupancyLabels>, Vec<MeshFit>) {
    let scene = &drive.scene;
    let logged = |(track, mesh): &(&str, TriangleMesh)| LoggedMesh {
        track: (*track).to_owned(),
        mesh: mesh.clone(),
    };
    let keyframes = scene.keyframes.iter().zip(meshes).map(|(keyframe, meshes)| KeyframeMeshes {
        keyframe,
        meshes: meshes.iter().map(logged).collect(),
    });
    let names = meshes.iter().flatten().map(|(track, _)| (*track).to_owned()).collect();
    let tracks = mesh_tracks(scene, &names, rules).unwrap();
    let mut aggregated = drive.aggregate(rules, |_| true);
    let fits = embody(scene, &mut aggregated, keyframes.collect(), &tracks, rules);
    let (options, lenses) = (LabelOptions::with_evidence(1), Lenses::default());
    let label = |keyframe| {
        label_keyframe(scene, &aggregated, &lenses, keyframe, rules, &options, |_| ()).labels
    };
    (scene.keyframes.iter().map(label).collect(), fits)
}

fn voxel(rules: &Rules, p: [f64; 3]) -> [usize; 3] {
    let flat = rules.spec.flat_of(&p.into()).expect("in the grid");
    rules.spec.voxel_at(flat).0.map(|i| i as usize)
}

/// Layer by the camera: what it sees in capitals, and `#` as `M`.
fn layer(labels: &OccupancyLabels, rules: &Rules) -> String {
    let z = voxel(rules, EYE)[2];
    let get = |[x, y, _]: [usize; 3]| {
        let class = class_at(labels, [x, y, z]);
        match (*labels.mask_camera.at([x, y, z]), class) {
            (0, class) => class,
            (_, '.') => 'o',
            (_, '#') => 'M',
            (_, class) => class.to_ascii_uppercase(),
        }
    };
    occlabel_testkit::draw(rules.spec.shape(), get, 0)
}

#[test]
fn section_9a_somebody_whom_no_ray_met_stands_before_the_wall_and_hides_it_from_the_camera() {
    let (rules, drive) = (small(&[]), drive(&[cloud(&[])]));
    let meshes = [vec![("somebody", person_at(3.1, -0.4))]];
    let (labels, fits) = label(&drive, &meshes, &rules);
    let labels = &labels[0];
    assert_eq!(fits[0].fit, Fit::AsGiven);
    let body = voxel(&rules, [3.2, 0.1, 0.6]);
    assert_eq!(*labels.semantics.at(body), PEDESTRIAN.0);
    let evidence = labels.evidence();
    assert_eq!((*evidence.instances.at(body), *evidence.state.at(body)), (1, OCCUPIED));
    assert_eq!((*evidence.hits.at(body), *labels.mask_lidar.at(body)), (0, 1));
    assert!(evidence.flow.at(body)[0].is_nan(), "nothing tells how they move");

    let without = drive.label(&rules);
    let mask = |labels: &OccupancyLabels, y| *labels.mask_camera.at(voxel(&rules, [6.2, y, 0.6]));
    assert_eq!((mask(labels, 0.1), mask(&without, 0.1)), (0, 1), "behind them");
    assert_eq!((mask(labels, -2.2), mask(&without, -2.2)), (1, 1), "beside them");
    let drawn =
        format!("with the body\n{}without\n{}", layer(labels, &rules), layer(&without, &rules));
    occlabel_testkit::assert_golden("bodies/before_the_wall.txt", &drawn);
}

/// Somebody's front, as the lidar sees it when they stand at x.
fn front(x: f64) -> Vec<[f64; 3]> {
    let places = (0..7).flat_map(|y| (0..7).map(move |z| (f64::from(y), f64::from(z))));
    places.map(|(y, z)| [x, 0.1 * y - 0.3, 0.2 * z + 0.15]).collect()
}

fn box_around(x: f64) -> Box3 {
    let world_from_box = Pose::translation(x + 0.15, 0.0, 0.77);
    Box3 { world_from_box, size_m: Vector3::new(0.7, 1.0, 1.6) }
}

/// Somebody who walks away from x = 3.1 m at 1 m/s, boxed and seen at three keyframes.
fn walk() -> Drive {
    let xs = [3.1, 3.6, 4.1];
    let mut drive = drive(&xs.map(|x| cloud(&front(x))));
    let boxes = xs.iter().enumerate().map(|(n, x)| (at(0.5 * n as f64), box_around(*x)));
    drive.scene.tracks.push(track(1, PEDESTRIAN, boxes.collect()));
    drive
}

#[test]
fn section_9a_a_body_is_put_onto_the_points_of_its_track_and_moves_with_its_neighbours() {
    let (rules, drive) = (small(&[]), walk());
    // As fitted: too far, too near, and right.
    let meshes = [3.18, 3.5, 4.1].map(|x| vec![("track-1", person_at(x, -0.4))]);
    let (labels, fits) = label(&drive, &meshes, &rules);
    for fit in &fits {
        let Fit::Aligned(residual_m) = fit.fit else { panic!("{fit:?}") };
        assert!(residual_m < 0.01 && fit.points == 49, "{fit:?}");
    }
    for (number, labels) in labels.iter().enumerate() {
        let body = voxel(&rules, [3.2 + 0.5 * number as f64, 0.1, 0.6]);
        let [x, y, _] = *labels.evidence().flow.at(body);
        assert!((x - 1.0).abs() < 0.05 && y.abs() < 0.05, "{number}: {x} {y}");
        assert_eq!(*labels.evidence().instances.at(body), TrackId(1).0);
    }
    let gap = small(&["boxes.max_gap_s=0.4"]);
    let (labels, _) = label(&drive, &meshes, &gap);
    let body = voxel(&gap, [3.2, 0.1, 0.6]);
    assert!(labels[0].evidence().flow.at(body)[0].is_nan(), "nobody within the gap");
}

#[test]
fn section_9a_points_of_a_track_whose_body_stands_have_no_vote() {
    let (rules, drive) = (small(&["meshes.align=false"]), walk());
    // One voxel beside the points.
    let meshes = [3.1, 3.6, 4.1].map(|x| vec![("track-1", person_at(x + 0.5, -0.4))]);
    let (labels, fits) = label(&drive, &meshes, &rules);
    assert!(fits.iter().all(|fit| fit.fit == Fit::AsGiven), "{fits:?}");
    let (points, body) = (voxel(&rules, [3.1, 0.1, 0.6]), voxel(&rules, [3.7, 0.1, 0.6]));
    let semantics = &labels[0].semantics;
    assert_eq!(*semantics.at(body), PEDESTRIAN.0);
    assert_ne!(*semantics.at(points), PEDESTRIAN.0, "the points say where the body is not");
    assert!(*labels[0].evidence().hits.at(points) > 0, "but they were seen");
    assert_eq!(*drive.labels(&rules)[0].semantics.at(points), PEDESTRIAN.0);
}

#[test]
fn section_9a_a_mesh_too_far_off_its_points_is_refused_and_the_points_label() {
    let (rules, drive) = (small(&[]), walk());
    let meshes = [3.1, 3.6, 4.1].map(|x| vec![("track-1", person_at(x + 1.5, -0.4))]);
    let (labels, fits) = label(&drive, &meshes, &rules);
    assert!(fits.iter().all(|fit| matches!(fit.fit, Fit::Refused(_))), "{fits:?}");
    let plain = drive.labels(&rules);
    for (refused, plain) in labels.iter().zip(&plain) {
        scenes::same_arrays(refused, plain, "as without meshes");
    }
}

#[test]
fn section_9a_few_points_do_not_move_a_mesh() {
    let (rules, drive) = (small(&["meshes.min_points=50"]), walk());
    let meshes = [3.1, 3.6, 4.1].map(|x| vec![("track-1", person_at(x, -0.4))]);
    let (_, fits) = label(&drive, &meshes, &rules);
    assert!(fits.iter().all(|fit| fit.fit == Fit::AsGiven && fit.points == 49), "{fits:?}");
}

#[test]
fn section_9a_meshes_may_stand_in_the_frame_of_the_lidar() {
    let rules = small(&["meshes.frame=lidar", "meshes.align=false"]);
    let mut drive = drive(&[cloud(&[])]);
    drive.scene.sweeps[0].ego_from_lidar = Pose::translation(1.0, 0.0, 0.0);
    let (labels, _) = label(&drive, &[vec![("somebody", person_at(2.1, -0.4))]], &rules);
    assert_eq!(*labels[0].semantics.at(voxel(&rules, [3.2, 0.1, 0.6])), PEDESTRIAN.0);
}
