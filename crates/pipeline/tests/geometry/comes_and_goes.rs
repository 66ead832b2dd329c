//! A track between its annotations, and beyond them.

use occlabel_core::OccupancyLabels;
use occlabel_pipeline::Rules;
use occlabel_testkit::assert_golden;

use crate::scenes::{Body, CAR, Drive, Stage, overlap, small, upright};
use crate::{STILL, above, instances_above_ground, picture, road_with};

#[test]
fn section_3_a_track_that_comes_and_goes_stands_only_between_its_annotations() {
    let body = |time: f64| {
        let place = upright([2.5 + time, 1.9, 0.85], 0.0);
        Body::new(CAR, place, [1.0, 0.75, 0.65].into()).tracked(1)
    };
    let world = |time: f64| road_with(&[body(time)]);
    let stage = Stage {
        world: &world,
        map_from_ego: STILL,
        sweeps_s: &[0.2, 0.5, 1.0, 1.25, 1.5, 2.4, 4.0, 4.5, 5.0, 5.2],
        annotated_s: &[&[1.0, 1.5, 4.0, 4.5]],
        step_deg: 2.0,
    };
    let (absent_s, keyframes_s) = ([0.2, 2.4, 5.2], [0.5, 1.25, 2.4, 4.0, 5.0]);
    let drive = stage.drive(&keyframes_s);

    let rules = small(&[]);
    boxed_at(&drive, &rules, &[0.5, 1.0, 1.25, 1.5, 4.0, 4.5, 5.0]);
    let smeared = drive.labels(&small(&["relabel.drop_ghosts=none"]));
    let mut views = Vec::new();
    for ((time, sharp), smeared) in keyframes_s.into_iter().zip(drive.labels(&rules)).zip(&smeared)
    {
        stands_or_leaves_nothing(&stage, &sharp, time, [1.25, 4.0].contains(&time));
        smears_where_it_was(&stage, smeared, &absent_s);
        views.push(format!("\nkeyframe at {time} s{}", above(&sharp, 3)));
    }
    let last = format!("\nthe same at 5 s, ghosts kept{}", above(&smeared[4], 3));
    let title = "A car at 1 m/s, annotated at 1.0, 1.5, 4.0 and 4.5 s.";
    assert_golden("geometry/comes-and-goes.txt", &picture(title, &[views.concat(), last]));
}

/// A box holds the track at these sweeps: carried 0.6 s on, not over a gap.
#[track_caller]
fn boxed_at(drive: &Drive, rules: &Rules, expected_s: &[f64]) {
    let aggregated = drive.aggregate(rules, |_| true);
    let boxed_s: Vec<f64> =
        aggregated.objects.iter().map(|o| o.time.unwrap().0 as f64 / 1e9).collect();
    assert_eq!(boxed_s, expected_s);
    assert!(aggregated.dropped.ghost > 100, "{} ghosts", aggregated.dropped.ghost);
}

/// The track stands in the labels of a keyframe without a trail, or no voxel is a car.
#[track_caller]
fn stands_or_leaves_nothing(stage: &Stage, labels: &OccupancyLabels, time: f64, stands: bool) {
    let boxed = instances_above_ground(labels, 1).len();
    assert_eq!(boxed > 20, stands, "{boxed} voxels of the track at {time} s");
    if stands {
        stage.check_no_trail(labels, &small(&[]), time);
    }
    let cars = labels.semantics.values().iter().filter(|class| **class == CAR.0).count();
    assert_eq!(cars > 0, stands, "ghosts at {time} s: {cars}");
}

/// Car voxels without an instance lie where the car was in the sweeps in which no box held it.
#[track_caller]
fn smears_where_it_was(stage: &Stage, labels: &OccupancyLabels, absent_s: &[f64]) {
    let was: Vec<Body> = absent_s.iter().filter_map(|&time| (stage.world)(time).pop()).collect();
    let mut smears = vec![0; was.len()];
    for (voxel, body) in stage.voxels(&small(&[]), 0.0) {
        let is_car = *labels.semantics.at(voxel) == CAR.0;
        if is_car && *labels.evidence().instances.at(voxel) == 0 {
            let held: Vec<bool> = was.iter().map(|was| overlap(&body, &was.grown(0.001))).collect();
            assert!(held.contains(&true), "{voxel:?} is a trail");
            smears.iter_mut().zip(held).for_each(|(count, held)| *count += usize::from(held));
        }
    }
    assert!(smears.iter().all(|&count| count > 5), "{smears:?} voxels at {absent_s:?}");
}
