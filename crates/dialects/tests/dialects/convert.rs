//! From any dialect to any other and back.

use std::collections::BTreeSet;

use occlabel_dialects::{ClassMap, Dialect, Holds, IGNORED, KeyframeLabels, Note};

use crate::round_trip::{Random, labels, read_back_noting};

/// Labels as they are after a way through another dialect's files, and what its writer noted.
fn through(labels: &KeyframeLabels, [from, to]: [&Dialect; 2]) -> (KeyframeLabels, BTreeSet<Note>) {
    let there = ClassMap::between(&from.classes, &to.classes, &[]).unwrap();
    let back = ClassMap::between(&to.classes, &from.classes, &[]).unwrap();
    let mut labels = labels.clone();
    there.apply(labels.semantics.values_mut());
    let (mut labels, notes) = read_back_noting(to, &labels);
    back.apply(labels.semantics.values_mut());
    (labels, notes)
}

/// What survives of labels in another dialect, by what its class map and its writer say.
fn surviving(labels: &KeyframeLabels, [from, to]: [&Dialect; 2]) -> KeyframeLabels {
    let mut kept = labels.clone();
    let holds = |array: Holds| to.can_say(&array);
    kept.mask_lidar = kept.mask_lidar.filter(|_| holds(Holds::MaskLidar));
    kept.mask_camera = kept.mask_camera.filter(|_| holds(Holds::MaskCamera));
    kept.instances = kept.instances.filter(|_| holds(Holds::Instances));
    kept.flow = kept.flow.filter(|_| holds(Holds::Flow));
    kept.extras.retain(|name, _| to.can_say(&Holds::Extra(name.clone())));
    let map = ClassMap::between(&from.classes, &to.classes, &[]).unwrap();
    let lost: BTreeSet<&String> = map.remarks().iter().flat_map(|remark| &remark.lost).collect();
    let names = from.classes.names();
    let is_lost = |index: u8| names.get(usize::from(index)).is_some_and(|name| lost.contains(name));
    let keeps_no_label =
        map.table()[usize::from(IGNORED)] != IGNORED || to.classes.no_label.is_some();
    for index in kept.semantics.values_mut() {
        if is_lost(*index) || (*index == IGNORED && !keeps_no_label) {
            *index = from.classes.free_index();
        }
    }
    kept
}

/// The arrays that a writer said it assumed or left out do not count: their numbers are no one's.
fn without_unknown(mut read: KeyframeLabels, kept: &KeyframeLabels) -> KeyframeLabels {
    read.mask_lidar = read.mask_lidar.filter(|_| kept.mask_lidar.is_some());
    read.mask_camera = read.mask_camera.filter(|_| kept.mask_camera.is_some());
    read.instances = read.instances.filter(|_| kept.instances.is_some());
    read.flow = read.flow.filter(|_| kept.flow.is_some());
    read.extras.retain(|name, _| kept.extras.contains_key(name));
    read
}

#[test]
fn what_both_dialects_hold_survives_the_way_there_and_back() {
    let (mut random, mut pairs, mut voxels) = (Random(7), 0, 0);
    for from in &Dialect::all() {
        for to in &Dialect::all() {
            let all = labels(from, &mut random);
            let kept = flat_flow(surviving(&all, [from, to]), [from, to]);
            let (read, _) = through(&kept, [from, to]);
            assert_eq!(without_unknown(read, &kept), kept, "{} to {}", from.name, to.name);
            let is_class = |index: &&u8| **index < from.classes.free_index();
            voxels += kept.semantics.values().iter().filter(is_class).count();
            pairs += 1;
        }
    }
    assert_eq!(pairs, 14 * 14);
    assert!(voxels > 500, "{voxels}");
}

/// Flow as a dialect of fewer components, or of listed voxels, can say it.
fn flat_flow(mut labels: KeyframeLabels, [from, to]: [&Dialect; 2]) -> KeyframeLabels {
    let is_flat = to.array_of(&Holds::Flow).is_some_and(|array| array.components == 2);
    let free = from.classes.free_index();
    let semantics = labels.semantics.values().to_vec();
    if let Some(flow) = &mut labels.flow {
        for (flow, index) in flow.values_mut().iter_mut().zip(semantics) {
            if is_flat {
                flow[2] = 0.0;
            }
            if index == free {
                *flow = [0.0; 3];
            }
        }
    }
    labels
}

#[test]
fn what_the_other_dialect_has_no_words_for_is_noted() {
    let (mut random, mut noted) = (Random(8), 0);
    for from in &Dialect::all() {
        for to in &Dialect::all() {
            let all = labels(from, &mut random);
            let (_, notes) = through(&all, [from, to]);
            let lost = |array: Holds, what: &str| {
                let is_lost = from.can_say(&array) && !to.can_say(&array);
                let note = Note::Lost { what: what.to_owned() };
                assert_eq!(notes.contains(&note), is_lost, "{what}: {} to {}", from.name, to.name);
                usize::from(is_lost)
            };
            noted += lost(Holds::MaskLidar, "mask_lidar") + lost(Holds::MaskCamera, "mask_camera");
            noted += lost(Holds::Instances, "instances") + lost(Holds::Flow, "flow");
        }
    }
    assert!(noted > 100, "{noted}");
}
