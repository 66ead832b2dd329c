//! Rules of the labels that only the whole pipeline can show, by section.

mod scenes;

use nalgebra::{Point3, Vector3};
use occlabel_core::{Box3, ClassId, OccupancyLabels, PointCloud, PointLabel, Pose, Timestamp};
use occlabel_pipeline::Rules;
use scenes::{
    CAR, CONE, Drive, FREE, MANMADE, OCCUPIED, OTHERS, PEDESTRIAN, ROAD, UNOBSERVED, VEGETATION,
    at, header, small, track, upright,
};

const FREE_ID: u8 = 17;
const UNLABELLED: PointLabel = PointLabel::Unlabelled;

fn labelled(class: ClassId) -> PointLabel {
    PointLabel::Class(class)
}

/// Points seen from the middle of voxel (4, 8, 3).
fn seen(points: &[([f64; 3], PointLabel)]) -> PointCloud<PointLabel> {
    let mut cloud = PointCloud::with_origins(vec![Point3::new(0.2, 0.2, 1.0)]);
    points.iter().for_each(|(position, label)| cloud.push(Point3::from(*position), *label, 0));
    cloud
}

/// A drive whose frames are one, with a keyframe at its first sweep.
fn drive_of(sweeps: &[(f64, PointCloud<PointLabel>)]) -> Drive {
    let mut drive = Drive::default();
    for (time, cloud) in sweeps {
        let here = Pose::identity();
        let labelled = cloud.labels.iter().any(|label| *label != UNLABELLED);
        let header = occlabel_core::SweepHeader { labelled, ..header(*time, here, here) };
        drive.add_sweep(header, cloud.clone());
    }
    drive.add_keyframe(0, &[]);
    drive
}

/// The class of the voxel that holds a point, if it is occupied.
fn class_of(labels: &OccupancyLabels, rules: &Rules, p: [f64; 3]) -> Option<ClassId> {
    let voxel = voxel_of(rules, p);
    let is_occupied = *labels.evidence().state.at(voxel) == OCCUPIED;
    is_occupied.then(|| ClassId(*labels.semantics.at(voxel)))
}

fn voxel_of(rules: &Rules, p: [f64; 3]) -> [usize; 3] {
    let flat = rules.spec.flat_of(&p.into()).expect("in the grid");
    rules.spec.voxel_at(flat).0.map(|i| i as usize)
}

fn box_at(place: [f64; 3], yaw_rad: f64) -> Box3 {
    Box3 { world_from_box: upright(place, yaw_rad), size_m: Vector3::new(2.0, 1.0, 1.0) }
}

// ---- Section 5: labels for unlabelled background -----------------------------------------------

const HERE: [f64; 3] = [5.2, 1.2, 1.0];
const THERE: [f64; 3] = [5.2, -1.3, 1.0];

#[test]
fn section_5_without_point_labels_all_background_is_unknown_and_boxes_give_their_class() {
    let mut drive = drive_of(&[(0.0, seen(&[(HERE, UNLABELLED), (THERE, UNLABELLED)]))]);
    drive.scene.tracks = vec![track(1, CAR, vec![(at(0.0), box_at(HERE, 0.0))])];
    for (setting, unknown) in
        [("taxonomy", OTHERS), ("vegetation", VEGETATION), ("manmade", MANMADE)]
    {
        let rules = small(&[&format!("relabel.unknown_class={setting}")]);
        rules.check(&drive.scene).expect("a class for what has none");
        let labels = drive.label(&rules);
        assert_eq!(class_of(&labels, &rules, HERE), Some(CAR));
        assert_eq!(class_of(&labels, &rules, THERE), Some(unknown), "{setting}");
    }
}

#[test]
fn section_5_without_point_labels_drop_is_an_error_with_a_hint() {
    let unlabelled = drive_of(&[(0.0, seen(&[(HERE, UNLABELLED)]))]);
    let some_labelled =
        drive_of(&[(0.0, seen(&[(HERE, UNLABELLED)])), (0.1, seen(&[(THERE, labelled(ROAD))]))]);
    let drop = small(&["relabel.unknown_class=drop"]);
    let fault = drop.check(&unlabelled.scene).expect_err("nothing would be left");
    let said = fault.to_string();
    assert!(said.contains("relabel.unknown_class"), "{said}");
    assert!(drop.check(&some_labelled.scene).is_ok());
    let no_unknown = small(&["taxonomy.file=panommocc"]);
    assert!(no_unknown.check(&unlabelled.scene).is_err(), "its `unknown` is drop");
}

#[test]
fn section_5_dropped_points_leave_no_ray() {
    let drive = drive_of(&[(0.0, seen(&[(HERE, UNLABELLED), (THERE, labelled(ROAD))]))]);
    let labels = drive.label(&small(&["relabel.unknown_class=drop"]));
    let kept_alone = drive_of(&[(0.0, seen(&[(THERE, labelled(ROAD))]))]).label(&small(&[]));
    scenes::same_arrays(&labels, &kept_alone, "the dropped point was never there");
}

#[test]
fn section_5_the_class_of_a_neighbour_comes_from_any_sweep_and_never_from_a_track() {
    let beside = HERE.map(|c| c + 0.1);
    let near_box = [THERE[0] + 1.15, THERE[1], THERE[2]];
    let mut drive = drive_of(&[
        (0.0, seen(&[(HERE, UNLABELLED), (near_box, UNLABELLED)])),
        (9.0, seen(&[(beside, labelled(VEGETATION)), (THERE, UNLABELLED)])),
    ]);
    drive.scene.tracks = vec![track(1, CAR, vec![(at(9.0), box_at(THERE, 0.0))])];
    let rules = small(&["aggregate.window_s=1.0"]);
    let labels = drive.label(&rules);
    assert_eq!(class_of(&labels, &rules, HERE), Some(VEGETATION), "relabelling knows no window");
    assert_eq!(class_of(&labels, &rules, near_box), Some(OTHERS), "a car's point is no candidate");
    let hits: u32 = labels.evidence().hits.values().iter().map(|&hits| u32::from(hits)).sum();
    assert_eq!(hits, 2, "the window keeps the sweep that told it out of the grid");
}

#[test]
fn section_5_ghosts_are_dropped_only_in_a_scene_with_a_track() {
    let ghosts = seen(&[(HERE, labelled(CAR)), (THERE, labelled(MANMADE))]);
    let alone = drive_of(&[(0.0, ghosts)]);
    let mut with_track = alone.clone();
    with_track.scene.tracks = vec![track(1, PEDESTRIAN, vec![(at(50.0), box_at([9.0; 3], 0.0))])];
    for (setting, is_kept) in [("movers", false), ("things", false), ("none", true)] {
        let rules = small(&[&format!("relabel.drop_ghosts={setting}")]);
        let ghost = |drive: &Drive| class_of(&drive.label(&rules), &rules, HERE).is_some();
        assert!(ghost(&alone), "{setting}: no track, no ghost");
        assert_eq!(ghost(&with_track), is_kept, "{setting}");
        assert!(
            class_of(&with_track.label(&rules), &rules, THERE).is_some(),
            "a house is no ghost"
        );
    }
}

#[test]
fn section_5_only_classes_that_are_boxed_are_ghosts() {
    // Occ3D-nuScenes boxes cones; Occ3D-Waymo boxes vehicles (1), but no cones (7).
    let survives = |taxonomy: &str, class: ClassId, setting: &str| {
        let mut drive = drive_of(&[(0.0, seen(&[(HERE, labelled(class))]))]);
        drive.scene.tracks = vec![track(1, ClassId(2), vec![(at(50.0), box_at([9.0; 3], 0.0))])];
        let settings =
            [format!("taxonomy.file={taxonomy}"), format!("relabel.drop_ghosts={setting}")];
        let rules = small(&[&settings[0], &settings[1]]);
        class_of(&drive.label(&rules), &rules, HERE).is_some()
    };
    assert!(!survives("occ3d-nuscenes", CONE, "things"), "a boxed thing");
    assert!(survives("occ3d-nuscenes", CONE, "movers"), "a thing that does not move");
    assert!(!survives("occ3d-waymo", ClassId(1), "things"), "a boxed thing");
    assert!(survives("occ3d-waymo", ClassId(7), "things"), "a thing without boxes");
}

// ---- Section 6: one instant --------------------------------------------------------------------

#[test]
fn section_6_a_track_is_placed_by_its_box_of_the_keyframe_unscaled() {
    // A point on the front of a car 2 m long, 4 m away at the keyframe, where the car is 3 m long.
    let far = [HERE[0] + 4.0, HERE[1], HERE[2]];
    let front = [far[0] + 0.9, far[1], far[2]];
    let mut drive = drive_of(&[(0.0, seen(&[])), (1.0, seen(&[(front, labelled(CAR))]))]);
    let longer = Box3 { size_m: Vector3::new(3.0, 1.0, 1.0), ..box_at(HERE, 0.0) };
    drive.scene.tracks = vec![track(1, CAR, vec![(at(0.0), longer), (at(1.0), box_at(far, 0.0))])];
    let rules = small(&[]);
    let labels = drive.label(&rules);
    let place = [HERE[0] + 0.9, HERE[1], HERE[2]];
    assert_eq!(class_of(&labels, &rules, place), Some(CAR));
    assert_eq!(labels.evidence().hits.values().iter().map(|&hits| u32::from(hits)).sum::<u32>(), 1);
    assert_eq!(*labels.evidence().instances.at(voxel_of(&rules, place)), 1);
}

#[test]
fn section_6_a_track_turns_with_its_box() {
    // 0.9 m ahead of the centre; a quarter turn later, which is the keyframe, 0.9 m to the left.
    let ahead = [HERE[0] + 0.9, HERE[1], HERE[2]];
    let mut drive = drive_of(&[(0.5, seen(&[])), (0.0, seen(&[(ahead, labelled(CAR))]))]);
    drive.scene.sweeps.reverse();
    drive.scene.keyframes[0].sweep = 1;
    let turned = box_at(HERE, std::f64::consts::FRAC_PI_2);
    drive.scene.tracks = vec![track(1, CAR, vec![(at(0.0), box_at(HERE, 0.0)), (at(0.5), turned)])];
    let rules = small(&[]);
    let labels = drive.label(&rules);
    assert_eq!(class_of(&labels, &rules, [HERE[0], HERE[1] + 0.9, HERE[2]]), Some(CAR));
    assert_eq!(class_of(&labels, &rules, ahead), None);
}

#[test]
fn section_6_a_track_without_a_box_then_is_left_out_of_classes_and_hits() {
    let mut drive = drive_of(&[(0.0, seen(&[])), (0.5, seen(&[(HERE, labelled(CAR))]))]);
    drive.scene.tracks = vec![track(1, CAR, vec![(at(0.3), box_at(HERE, 0.0))])];
    let labels = drive.label(&small(&[]));
    assert!(labels.evidence().hits.values().iter().all(|&hits| hits == 0), "extrapolated only");
    let crossed = labels.evidence().crossings.values().iter().filter(|&&n| n > 0).count();
    assert_eq!(crossed, 9, "its world part stays: 8 faces along x and one along y");
}

// ---- Section 8: rays ---------------------------------------------------------------------------

#[test]
fn section_8_the_ray_of_a_tracks_point_stays_where_it_was_seen_up_to_the_box() {
    // Seen 0.3 s after the keyframe, 6 m ahead; at the keyframe the car is 3 m farther left. Coming
    // or going, it fills the same place.
    for yaw_rad in [0.0, std::f64::consts::PI] {
        let boxes = [(0.0, 3.2), (0.3, 0.2)].map(|(t, y)| (at(t), box_at([6.2, y, 1.0], yaw_rad)));
        let mut drive =
            drive_of(&[(0.0, seen(&[])), (0.3, seen(&[([5.9, 0.2, 1.0], UNLABELLED)]))]);
        drive.scene.tracks = vec![track(1, CAR, boxes.to_vec())];
        // The grown box begins at 5.1 m, in voxel 14; the point is in voxel 15.
        let world_part = (4..14).map(|x| [x, 8, 3]);
        let own: Vec<_> = world_part.chain([[14, 14, 3]]).collect();
        assert_eq!(hit_and_crossed(&drive, "own"), [vec![[15, 14, 3]], own], "{yaw_rad}");
        assert_eq!(hit_and_crossed(&drive, "hits"), [vec![[15, 14, 3]], vec![]], "{yaw_rad}");
    }
}

/// The voxels that were hit, and those that were crossed, each once.
fn hit_and_crossed(drive: &Drive, object_rays: &str) -> [Vec<[usize; 3]>; 2] {
    let rules = small(&[&format!("raycast.object_rays={object_rays}")]);
    let evidence = drive.label(&rules).evidence.unwrap();
    [&evidence.hits, &evidence.crossings].map(|counts| {
        let once = rules.spec.voxels().zip(counts.values()).filter(|(_, count)| **count > 0);
        once.map(|(voxel, count)| {
            assert_eq!(*count, 1, "{voxel:?}");
            voxel.0.map(|i| i as usize)
        })
        .collect()
    })
}

// ---- Section 11: what is written ---------------------------------------------------------------

/// The flow of the voxels of a track that moves from one box to the next within some seconds, with
/// points all along it.
fn flow_of(
    now: Box3,
    next: Option<(Timestamp, Box3)>,
    settings: &[&str],
) -> Vec<([f64; 3], [f32; 3])> {
    let places = (0..40).map(|i| (f64::from(i % 10) * 0.2 - 0.9, f64::from(i / 10) * 0.25 - 0.375));
    let points: Vec<_> = places
        .map(|(x, y)| ((now.world_from_box * Point3::new(x, y, 0.1)).coords.into(), UNLABELLED))
        .chain([(THERE, labelled(ROAD))])
        .collect();
    let mut drive = drive_of(&[(0.0, seen(&points))]);
    drive.scene.tracks = vec![track(1, CAR, [(at(0.0), now)].into_iter().chain(next).collect())];
    let rules = small(settings);
    let labels = drive.label(&rules);
    let of_track = rules.spec.voxels().map(|voxel| (voxel, voxel.0.map(|i| i as usize)));
    let (boxed, other): (Vec<_>, Vec<_>) =
        of_track.partition(|(_, at)| *labels.evidence().instances.at(*at) == 1);
    assert!(boxed.len() > 5, "{} voxels of the track", boxed.len());
    assert!(
        other.iter().all(|(_, at)| *labels.evidence().flow.at(*at) == [0.0; 3]),
        "background, air"
    );
    boxed
        .into_iter()
        .map(|(voxel, at)| (rules.spec.centre(voxel).coords.into(), *labels.evidence().flow.at(at)))
        .collect()
}

#[track_caller]
fn assert_velocity(found: [f32; 3], expected: [f64; 3]) {
    let near = (0..3).all(|axis| (f64::from(found[axis]) - expected[axis]).abs() < 1e-3);
    assert!(near, "expected {expected:?} m/s to 1 mm/s, found {found:?}");
}

#[test]
fn section_11_flow_of_a_track_that_moves_straight_is_its_velocity() {
    let next = (at(0.5), box_at([HERE[0] + 4.0, HERE[1] - 1.5, HERE[2] + 0.1], 0.3));
    for (_, velocity) in flow_of(box_at(HERE, 0.3), Some(next), &[]) {
        assert_velocity(velocity, [8.0, -3.0, 0.2]);
    }
}

#[test]
fn section_11_flow_of_a_track_that_turns_is_the_chord_over_the_time() {
    let (turn_rad, seconds, shift) = (0.8_f64, 0.4, [0.7, 0.2]);
    let next = box_at([HERE[0] + shift[0], HERE[1] + shift[1], HERE[2]], 0.5 + turn_rad);
    for (centre, velocity) in flow_of(box_at(HERE, 0.5), Some((at(seconds), next)), &[]) {
        // A point at (x, y) from the middle goes to (x cos - y sin, x sin + y cos), and on.
        let (x, y) = (centre[0] - HERE[0], centre[1] - HERE[1]);
        let (sine, cosine) = libm::sincos(turn_rad);
        let dx = x * cosine - y * sine - x + shift[0];
        let dy = x * sine + y * cosine - y + shift[1];
        assert_velocity(velocity, [dx / seconds, dy / seconds, 0.0]);
    }
}

#[test]
fn section_11_flow_is_unknown_without_a_next_annotation_within_the_gap() {
    let next = |seconds: f64| Some((at(seconds), box_at([HERE[0] + 1.6, HERE[1], HERE[2]], 0.0)));
    let gap = ["boxes.max_gap_s=1.6"];
    let is_unknown = |next: Option<(Timestamp, Box3)>| {
        let flows = flow_of(box_at(HERE, 0.0), next, &gap);
        let unknown = flows.iter().filter(|(_, v)| v.iter().all(|c| c.is_nan())).count();
        assert!(unknown == 0 || unknown == flows.len(), "{unknown} of {}", flows.len());
        unknown > 0
    };
    assert!(is_unknown(None));
    assert!(is_unknown(next(1.600_000_001)));
    assert!(!is_unknown(next(1.6)), "the gap is closed");
}

#[test]
fn section_11_flow_leaves_out_what_the_ego_does() {
    // The ego drives and turns; the car stands.
    let mut drive = Drive::default();
    let (world_from_ego, later) =
        (upright([30.0, 20.0, 1.0], 2.0), upright([35.0, 20.0, 1.0], 2.5));
    let world_from_box = world_from_ego * upright(HERE, 0.4);
    let boxed = Box3 { world_from_box, size_m: Vector3::new(2.0, 1.0, 1.0) };
    drive.add_sweep(header(0.0, world_from_ego, Pose::identity()), seen(&[(HERE, UNLABELLED)]));
    drive.add_sweep(header(0.5, later, Pose::identity()), seen(&[]));
    drive.add_keyframe(0, &[]);
    drive.scene.tracks = vec![track(1, CAR, vec![(at(0.0), boxed.clone()), (at(0.5), boxed)])];
    let rules = small(&[]);
    let labels = drive.label(&rules);
    assert_eq!(*labels.evidence().instances.at(voxel_of(&rules, HERE)), 1);
    assert_velocity(*labels.evidence().flow.at(voxel_of(&rules, HERE)), [0.0; 3]);
}

#[test]
fn section_11_semantics_is_free_wherever_nothing_is_occupied() {
    let drive = drive_of(&[(0.0, seen(&[(HERE, labelled(CAR)), (THERE, labelled(ROAD))]))]);
    for (taxonomy, free) in [("occ3d-nuscenes", FREE_ID), ("occ3d-waymo", 23), ("mobileocc", 255)] {
        let labels = drive.label(&small(&[&format!("taxonomy.file={taxonomy}")]));
        let states = labels.evidence().state.values();
        let written = labels.semantics.values().iter().zip(labels.mask_lidar.values());
        let mut counts = [0; 3];
        for (&state, (&class, &is_observed)) in states.iter().zip(written) {
            assert_eq!(class == free, state != OCCUPIED, "{taxonomy}: {class} in state {state}");
            assert_eq!(is_observed == 0, state == UNOBSERVED);
            counts[usize::from(state)] += 1;
        }
        assert!(counts[0] > 2000 && counts[usize::from(FREE)] > 10, "{counts:?}");
        assert_eq!(counts[usize::from(OCCUPIED)], 2);
    }
}

#[test]
fn section_11_counts_saturate_where_they_are_written_and_not_before() {
    let points = vec![(HERE, labelled(MANMADE)); 70_000];
    let count_at = |labels: &OccupancyLabels, rules: &Rules| {
        let evidence = labels.evidence();
        let before = [HERE[0] - 0.5, HERE[1], HERE[2]];
        let (hit, crossed) = (voxel_of(rules, HERE), voxel_of(rules, before));
        [
            *evidence.hits.at(hit),
            *evidence.crossings.at(crossed),
            u16::from(*evidence.state.at(hit)),
        ]
    };
    let counted = |points: &[_], settings: &[&str]| {
        let rules = small(settings);
        count_at(&drive_of(&[(0.0, seen(points))]).label(&rules), &rules)
    };
    let occupied = u16::from(OCCUPIED);
    assert_eq!(counted(&points[..65_535], &[]), [65_535, 65_535, occupied]);
    assert_eq!(counted(&points, &[]), [65_535, 65_535, occupied]);
    assert_eq!(counted(&points[..1_234], &[]), [1_234, 1_234, occupied]);
    let more = ["states.occupied_min_hits=70000"];
    assert_eq!(counted(&points, &more), [65_535, 65_535, occupied], "judged in full");
    assert_eq!(counted(&points[1..], &more), [65_535, 65_535, u16::from(UNOBSERVED)]);
}

// ---- Section 13: where the grid stands ---------------------------------------------------------

#[test]
fn section_13_the_grid_stands_in_the_ego_or_in_the_lidar_pitch_included() {
    // The ego looks 0.2 rad down, the lidar on it 0.2 rad up.
    let world_from_ego = Pose::new([50.0, -20.0, 3.0].into(), [0.0, 0.2, 0.0].into());
    let ego_from_lidar = Pose::new([0.5, 0.1, 0.4].into(), [0.0, -0.2, 0.0].into());
    let p_lidar = Point3::new(5.0, 0.6, 0.3);
    let cloud =
        PointCloud::from_one_origin(Point3::origin(), vec![p_lidar], vec![labelled(MANMADE)]);
    let mut drive = Drive::default();
    drive.add_sweep(header(0.0, world_from_ego, ego_from_lidar), cloud);
    drive.add_keyframe(0, &[]);

    let (sine, cosine) = libm::sincos(0.2);
    let p_ego = [0.5 + 5.0 * cosine - 0.3 * sine, 0.7, 0.4 + 5.0 * sine + 0.3 * cosine];
    for (frame, expected) in [("ego", p_ego), ("lidar", [5.0, 0.6, 0.3])] {
        let rules = small(&[&format!("grid.frame={frame}")]);
        let labels = drive.label(&rules);
        assert_eq!(class_of(&labels, &rules, expected), Some(MANMADE), "{frame}: {expected:?}");
        let occupied = labels.evidence().state.values().iter().filter(|s| **s == OCCUPIED).count();
        assert_eq!(occupied, 1, "{frame}");
        let origin = if frame == "ego" { [0.5, 0.1, 0.4] } else { [0.0; 3] };
        assert_eq!(
            *labels.evidence().crossings.at(voxel_of(&rules, origin)),
            1,
            "the ray's origin"
        );
    }
    let voxels = [p_ego, [5.0, 0.6, 0.3]].map(|p| voxel_of(&small(&[]), p));
    assert_ne!(voxels[0], voxels[1], "the frames are told apart");
}

#[test]
fn section_13_a_pitched_ego_pitches_its_grid() {
    // Level ground ahead, seen by an ego that looks 0.2 rad down: it rises in the grid.
    let world_from_ego = Pose::new([7.0, 8.0, 1.0].into(), [0.0, 0.2, 0.0].into());
    let (x_m, below_m) = (6.0_f64, 1.0_f64);
    let in_world = Point3::new(7.0 + x_m, 8.0, 1.0 - below_m);
    let p_ego = world_from_ego.inverse() * in_world;
    let cloud = PointCloud::from_one_origin(Point3::origin(), vec![p_ego], vec![labelled(ROAD)]);
    let mut drive = Drive::default();
    drive.add_sweep(header(0.0, world_from_ego, Pose::identity()), cloud);
    drive.add_keyframe(0, &[]);
    let rules = small(&[]);
    let (sine, cosine) = libm::sincos(0.2);
    let expected = [x_m * cosine + below_m * sine, 0.0, x_m * sine - below_m * cosine];
    assert_eq!(class_of(&drive.label(&rules), &rules, expected), Some(ROAD), "{expected:?}");
    assert!(expected[2] > 0.0, "1 m below the ego, yet above its plane: {}", expected[2]);
}
