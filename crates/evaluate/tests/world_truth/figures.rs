//! Every figure by hand, each with a case that tells it from its neighbours.

use crate::support::*;
use occlabel_core::{ClassId, ClassSet, VoxelTruth};

#[test]
fn a1_counts_the_least_touch_of_a_solid() {
    let touched = VoxelTruth { solid: 1e-6, ..surface(WALL) };
    let quality = judge_row(&[
        (occupied(WALL), surface(WALL)),
        (occupied(CAR), touched),
        (occupied(CAR), air()),
        (occupied(CAR), air()),
        (EMPTY, surface(WALL)),
    ]);
    assert_eq!(all(&quality, "occupied_precision"), (Some(0.5), 4));
    let of = |class: u8| &quality.by_class[usize::from(class)].figures;
    assert_eq!(figure(of(CAR), "occupied_precision"), (Some(1.0 / 3.0), 3), "by the label's class");
    assert_eq!(figure(of(WALL), "occupied_precision"), (Some(1.0), 1));
    assert_eq!(figure(of(ROAD), "occupied_precision"), (None, 0));
}

#[test]
fn a1n_allows_what_three_sigma_explain() {
    let beside = |gap: Option<f32>| VoxelTruth { clearance: gap, ..air() };
    let pairs = [Some(0.1), Some(0.14), Some(0.16), None].map(|gap| (occupied(WALL), beside(gap)));
    // Three times 2 cm are 0.15 voxels of 0.4 m.
    let mut scale = row(4);
    scale.noise_sigma_m = 0.02;
    let noisy = tally("row", &pairs, &scale).quality();
    assert_eq!(all(&noisy, "occupied_precision_noise"), (Some(0.5), 4));
    assert_eq!(all(&noisy, "occupied_precision"), (Some(0.0), 4));
    let exact = judge_row(&pairs);
    assert_eq!(all(&exact, "occupied_precision_noise"), (None, 0), "only asked under noise");
}

#[test]
fn a2_asks_of_voxels_with_five_ends() {
    let seen = |ends: u32, dense_ends: u32| VoxelTruth { ends, dense_ends, ..surface(WALL) };
    let hollow = VoxelTruth { ends: 9, dense_ends: 9, ..air() };
    let quality = judge_row(&[
        (occupied(CAR), seen(5, 20)),
        (EMPTY, seen(5, 20)),
        (UNOBSERVED, seen(6, 24)),
        (EMPTY, seen(4, 5)),
        (EMPTY, seen(0, 4)),
        (EMPTY, hollow),
    ]);
    assert_eq!(all(&quality, "surface_recall"), (Some(1.0 / 3.0), 3));
    assert_eq!(all(&quality, "surface_recall_dense"), (Some(0.25), 4));
    let wall = &quality.by_class[usize::from(WALL)].figures;
    assert_eq!(figure(wall, "surface_recall"), (Some(1.0 / 3.0), 3), "by the true class");
}

#[test]
fn a3_allows_a_twentieth_of_solid_in_free_and_a3s_none() {
    let filled = |solid: f32| VoxelTruth { solid, ..surface(WALL) };
    let quality = judge_row(&[
        (EMPTY, air()),
        (EMPTY, filled(0.049)),
        (EMPTY, filled(0.05)),
        (EMPTY, filled(1.0)),
        (UNOBSERVED, filled(1.0)),
        (occupied(WALL), filled(1.0)),
    ]);
    assert_eq!(all(&quality, "free_purity"), (Some(0.5), 4));
    assert_eq!(all(&quality, "free_purity_strict"), (Some(0.25), 4));
}

#[test]
fn a4_asks_of_crossed_and_empty_voxels() {
    let unseen = VoxelTruth { crossed: false, ..air() };
    let grazed = VoxelTruth { crossed: true, solid: 0.01, ..surface(WALL) };
    let quality = judge_row(&[
        (EMPTY, air()),
        (UNOBSERVED, air()),
        (occupied(CAR), air()),
        (EMPTY, unseen),
        (occupied(WALL), grazed),
    ]);
    assert_eq!(all(&quality, "free_recall"), (Some(1.0 / 3.0), 3));
}

#[test]
fn a5_asks_of_true_positives_and_a5p_forgives_a_class_that_passes() {
    let kerb =
        VoxelTruth { classes: [ROAD, WALL].map(ClassId).into_iter().collect(), ..surface(WALL) };
    let unnamed = VoxelTruth { class: None, classes: ClassSet::default(), ..surface(WALL) };
    let quality = judge_row(&[
        (occupied(WALL), surface(WALL)),
        (occupied(ROAD), kerb),
        (occupied(CAR), kerb),
        (occupied(ROAD), surface(ROAD)),
        (occupied(ROAD), unnamed),
        (occupied(ROAD), air()),
        (EMPTY, surface(CAR)),
    ]);
    assert_eq!(all(&quality, "class_accuracy"), (Some(0.5), 4));
    assert_eq!(all(&quality, "class_present"), (Some(0.75), 4));
    // The wall's is a third, the road's is 1, the car is not asked of.
    assert_eq!(all(&quality, "class_accuracy_mean"), (Some((1.0 / 3.0 + 1.0) / 2.0), 2));
}

#[test]
fn a6_is_the_overlap_of_what_is_observed_and_what_rays_see() {
    let ended = VoxelTruth { ends: 1, ..VoxelTruth::default() };
    let quality = judge_row(&[
        (EMPTY, air()),
        (occupied(WALL), ended),
        (EMPTY, VoxelTruth::default()),
        (UNOBSERVED, air()),
        (UNOBSERVED, VoxelTruth::default()),
    ]);
    assert_eq!(all(&quality, "mask_lidar_iou"), (Some(0.5), 4));
    assert_eq!(all(&quality, "mask_camera_iou"), (None, 0), "there is no camera");
    assert_eq!(all(&quality, "mask_camera_sight_iou"), (None, 0));
}

#[test]
fn a7_sets_occupied_voxels_beside_the_true_surface() {
    let at = |surface_distance: f32| VoxelTruth { surface_distance, ..surface(WALL) };
    let far = VoxelTruth { surface_distance: 1.5, ..air() };
    let quality = judge_row(&[
        (occupied(WALL), at(0.25)),
        (occupied(CAR), far),
        (UNOBSERVED, at(0.5)),
        (EMPTY, at(0.0)),
        (EMPTY, far),
    ]);
    assert_eq!(all(&quality, "occupied_distance_voxels"), (Some(0.875), 2));
    assert_eq!(all(&quality, "occupied_distance_p95_voxels"), (Some(1.5), 2));
    assert_eq!(all(&quality, "surface_distance_voxels"), (Some(0.25), 3));
    assert_eq!(all(&quality, "surface_distance_p95_voxels"), (Some(0.5), 3));
    assert_eq!(all(&quality, "occupied_distance_excess_voxels"), (Some(0.625), 2));
}

#[test]
fn a8_asks_of_swept_air_only() {
    let swept = VoxelTruth { swept: true, ..air() };
    let quality = judge_row(&[
        (occupied(CAR), swept),
        (EMPTY, swept),
        (UNOBSERVED, swept),
        (EMPTY, swept),
        (occupied(CAR), air()),
    ]);
    assert_eq!(all(&quality, "trail_rate"), (Some(0.25), 4));
}

#[test]
fn a9_weighs_objects_alike_and_names_the_worst() {
    let unseen = VoxelTruth { ends: 0, ..mover(3, [0.0; 3]) };
    let glimpsed = VoxelTruth { ends: 1, ..mover(3, [0.0; 3]) };
    let mut pairs = vec![(occupied(CAR), mover(1, [0.0; 3])); 8];
    pairs.extend([(EMPTY, glimpsed), (occupied(WALL), glimpsed), (EMPTY, unseen)]);
    pairs.push((EMPTY, surface(WALL)));
    let quality = judge_row(&pairs);
    assert_eq!(all(&quality, "object_completeness"), (Some(0.75), 2));
    assert_eq!(all(&quality, "object_completeness_worst"), (Some(0.5), 2));
    let worst = quality.worst_object.unwrap();
    assert_eq!((worst.scene.as_str(), worst.track, worst.voxels), ("row", 3, 2));
    assert_eq!((worst.class.as_deref(), worst.completeness), (Some("car"), 0.5));
}

#[test]
fn flow_is_asked_of_movers_that_are_labelled_occupied() {
    let (right, off) = ([3.0, 4.0, 0.0], [3.0, 4.5, 0.0]);
    let quality = judge_row(&[
        (moving(CAR, right), mover(1, right)),
        (moving(WALL, off), mover(1, right)),
        (moving(CAR, [0.0; 3]), mover(1, right)),
        (moving(CAR, [f32::NAN; 3]), mover(1, right)),
        (moving(CAR, right), mover(1, [f32::NAN; 3])),
        (moving(CAR, right), air()),
        (EMPTY, mover(1, right)),
        (moving(WALL, off), surface(WALL)),
        (occupied(WALL), surface(WALL)),
    ]);
    assert_eq!(all(&quality, "flow_error_mps"), (Some(5.5 / 3.0), 3));
    assert_eq!(all(&quality, "flow_error_p95_mps"), (Some(5.0), 3));
    assert_eq!(all(&quality, "flow_error_right_class_mps"), (Some(2.5), 2));
    assert_eq!(all(&quality, "flow_missing"), (Some(0.25), 4));
    assert_eq!(all(&quality, "static_flow"), (Some(0.5), 2));
}

#[test]
fn a5h_asks_for_the_class_that_rays_met_whatever_has_most_surface() {
    let met = |class: u8| VoxelTruth { hit_class: Some(ClassId(class)), ..surface(ROAD) };
    let unmet = VoxelTruth { hit_class: None, ..surface(ROAD) };
    let quality = judge_row(&[
        (occupied(WALL), met(WALL)),
        (occupied(ROAD), met(WALL)),
        (occupied(ROAD), met(ROAD)),
        (occupied(ROAD), unmet),
    ]);
    assert_eq!(all(&quality, "class_hit"), (Some(2.0 / 3.0), 3));
    assert_eq!(all(&quality, "class_accuracy"), (Some(0.75), 4));
}

#[test]
fn rings_part_the_grid_by_distance() {
    // Centres stand at 0.2 + 0.4 i metres: 25 below 10 m, 25 below 20 m, 10 beyond.
    let mut pairs = vec![(occupied(WALL), surface(WALL)); 60];
    pairs[24].1 = air();
    pairs[25].1 = air();
    pairs[59].1 = air();
    let quality = judge_row(&pairs);
    let rings: Vec<_> =
        quality.by_ring.iter().map(|ring| figure(&ring.figures, "occupied_precision")).collect();
    assert_eq!(rings, [(Some(0.96), 25), (Some(0.96), 25), (Some(0.9), 10)]);
    assert_eq!(all(&quality, "occupied_precision"), (Some(0.95), 60));
    let limits: Vec<_> = quality.by_ring.iter().map(|ring| (ring.from_m, ring.to_m)).collect();
    assert_eq!(limits, [(0.0, Some(10.0)), (10.0, Some(20.0)), (20.0, None)]);
}

#[test]
fn a_mover_of_several_classes_counts_once() {
    let rider = VoxelTruth { class: Some(ClassId(WALL)), ..mover(4, [0.0; 3]) };
    let quality = judge_row(&[(EMPTY, rider), (occupied(CAR), mover(4, [0.0; 3]))]);
    assert_eq!(all(&quality, "object_completeness"), (Some(0.5), 1));
    let of = |class: u8| &quality.by_class[usize::from(class)].figures;
    assert_eq!(figure(of(CAR), "object_completeness"), (Some(0.5), 1));
    assert_eq!(figure(of(WALL), "object_completeness"), (None, 0));
}

#[test]
fn pi_overlaps_people_seen_or_not_and_where_they_share_a_voxel() {
    let shared = VoxelTruth {
        classes: [ClassId(ROAD), ClassId(CAR)].into_iter().collect(),
        ..surface(ROAD)
    };
    let unseen = VoxelTruth { ends: 0, ..surface(CAR) };
    let quality = judge_row(&[
        (occupied(CAR), surface(CAR)),
        (occupied(CAR), shared),
        (occupied(CAR), surface(ROAD)),
        (occupied(ROAD), surface(CAR)),
        (UNOBSERVED, unseen),
        (occupied(ROAD), surface(ROAD)),
        (EMPTY, air()),
    ]);
    assert_eq!(all(&quality, "people_iou"), (Some(0.4), 5), "CAR stands for people here");
    assert_eq!(all(&judge_row(&[(EMPTY, air())]), "people_iou"), (None, 0));
}

#[test]
fn pv_is_the_mean_of_each_person_before_the_mean_over_people() {
    let nan = [f32::NAN; 3];
    let quality = judge_row(&[
        (moving(CAR, [1.5, 0.0, 9.0]), mover(1, [1.0, 0.0, 0.0])),
        (moving(CAR, [0.5, 0.0, 0.0]), mover(1, [1.0, 0.0, 0.0])),
        (moving(CAR, [0.0, 0.3, 0.0]), mover(2, [0.0, 0.0, 0.0])),
        (moving(CAR, nan), mover(2, [0.0, 0.0, 0.0])),
        (moving(CAR, [9.0; 3]), mover(3, nan)),
        (moving(WALL, [9.0; 3]), mover(1, [1.0, 0.0, 0.0])),
        (moving(CAR, [9.0; 3]), air()),
    ]);
    let (mean, count) = all(&quality, "people_speed_error_mps");
    assert!((mean.unwrap() - 0.15).abs() < 1e-6 && count == 2, "{mean:?} {count}");
}
