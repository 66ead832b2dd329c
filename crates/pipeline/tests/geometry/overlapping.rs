//! Boxes that overlap.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};
use occlabel_core::OccupancyLabels;
use occlabel_pipeline::Rules;
use occlabel_testkit::assert_golden;

use crate::scenes::{
    Body, CAR, PEDESTRIAN, Stage, class_at, directions, from_above, look, slab, small, upright,
};
use crate::{SHAPE, one_look, picture, road_with};

#[test]
fn section_4_of_two_overlapping_boxes_the_smaller_takes_the_points() {
    let boxes = [
        slab(CAR, [3.1, -1.4, 0.2], [6.9, 0.6, 1.5]).tracked(1),
        slab(PEDESTRIAN, [2.6, -0.8, 0.2], [3.7, 0.2, 1.9]).tracked(2),
        slab(CAR, [4.1, 2.2, 0.2], [5.3, 3.4, 1.4]).tracked(3),
        slab(CAR, [4.7, 1.8, 0.2], [5.9, 3.0, 1.4]).tracked(4),
    ];
    let world = |_| road_with(&boxes);
    let annotated: &[f64] = &[0.0];
    let annotated_s = &[annotated; 4];
    let stage = Stage { annotated_s, ..one_look(&world) };
    let rules = small(&[]);
    let labels = stage.drive(&[0.0]).label(&rules);

    instances_are_the_owners(&labels, &owners_of_voxels(&stage, &boxes, &rules));
    let instance = |voxel| match *labels.evidence().instances.at(voxel) {
        0 => class_at(&labels, voxel),
        track => char::from(b'0' + track as u8),
    };
    let title = "A person's box in a car's, and two boxes of one size. Digits are tracks.";
    let views = [from_above(SHAPE, 2, instance), from_above(SHAPE, 4, instance)];
    assert_golden("geometry/overlapping-boxes.txt", &picture(title, &views));
}

/// Voxels whose points belong to one box alone have its instance.
#[track_caller]
fn instances_are_the_owners(
    labels: &OccupancyLabels,
    owners: &BTreeMap<[usize; 3], BTreeSet<u16>>,
) {
    let mut judged = [0; 5];
    for (voxel, owners) in owners.iter().filter(|(_, owners)| owners.len() == 1) {
        let owner = *owners.first().expect("one owner");
        assert_eq!(*labels.evidence().instances.at(*voxel), owner, "{voxel:?}");
        judged[usize::from(owner)] += 1;
    }
    assert!(
        judged.iter().all(|&count| count > 3),
        "{judged:?} voxels of 0 (none) and tracks 1 to 4"
    );
}

/// For every voxel that was hit: the tracks of its points, 0 for none, by the words of the rule.
fn owners_of_voxels(
    stage: &Stage,
    boxes: &[Body],
    rules: &Rules,
) -> BTreeMap<[usize; 3], BTreeSet<u16>> {
    let margin = Vector3::new(0.1, 0.1, 0.05);
    let grown = |body: &Body| {
        // 10 cm on every face but the bottom's: the middle rises by half as much as the height grows.
        let up = upright([0.0, 0.0, 0.05], 0.0);
        Body {
            map_from_body: body.map_from_body * up,
            half_m: body.half_m + margin,
            ..body.clone()
        }
    };
    let volume = |body: &Body| body.half_m.x * body.half_m.y * body.half_m.z;
    let owner = |p: &Point3<f64>| {
        let inside = boxes.iter().filter(|body| grown(body).contains(p));
        inside.min_by(|a, b| volume(a).total_cmp(&volume(b)).then(a.track.cmp(&b.track)))
    };
    let map_from_lidar = stage.map_from_lidar(0.0);
    let mut owners = BTreeMap::new();
    for p in &look(&(stage.world)(0.0), &map_from_lidar, &directions(stage.step_deg)).positions {
        let p = map_from_lidar * p;
        if let Some(flat) = rules.spec.flat_of(&p) {
            let voxel = rules.spec.voxel_at(flat).0.map(|i| i as usize);
            let tracks: &mut BTreeSet<u16> = owners.entry(voxel).or_default();
            tracks.insert(owner(&p).and_then(|body| body.track).unwrap_or(0));
        }
    }
    owners
}
