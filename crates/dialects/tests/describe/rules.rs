//! One rule broken at a time.

use occlabel_dialects::describe::Description;
use occlabel_labels::NumberArray;

use crate::{Saved, rules_of};

const SHAPE: [usize; 3] = [50, 50, 4];
const VOXELS: usize = 10_000;

/// Road at the bottom, a car on a part of it, all observed and seen.
fn semantics() -> Vec<u8> {
    let level = |at: usize| match at % 4 {
        0 => 11,
        1 if at < 200 => 4,
        _ => 17,
    };
    (0..VOXELS).map(level).collect()
}

fn file(semantics: &[u8], lidar: &[u8], camera: &[u8]) -> Description {
    let array = |values: &[u8]| NumberArray::new(&SHAPE, values);
    let names = ["semantics", "mask_lidar", "mask_camera"];
    let arrays = [semantics, lidar, camera];
    let arrays: Vec<_> = names.into_iter().zip(arrays.map(array)).collect();
    Saved::npz(&arrays).describe()
}

const ONES: [u8; VOXELS] = [1; VOXELS];

#[test]
fn a_sound_file_breaks_no_rule() {
    let told = file(&semantics(), &ONES, &ONES);
    assert_eq!(rules_of(&told), [""; 0]);
    assert_eq!(told.dialects, ["occ3d-nuscenes"]);
    assert!(told.notes.is_empty());
}

#[test]
fn a_camera_that_sees_what_no_lidar_observed_is_told() {
    let mut lidar = ONES;
    lidar[2..5].fill(0);
    let told = file(&semantics(), &lidar, &ONES);
    assert_eq!(rules_of(&told), ["occupied-outside-mask-lidar", "mask-not-subset"]);
    assert_eq!((told.suspicions[1].count, told.suspicions[1].of), (3, 10_000));
    assert_eq!(told.suspicions[0].count, 1);
}

#[test]
fn masks_of_other_numbers_are_told_with_their_count() {
    let mut camera = ONES;
    camera[7..12].fill(2);
    let told = file(&semantics(), &ONES, &camera);
    assert_eq!(rules_of(&told), ["unreadable", "mask-values"]);
    assert_eq!(told.suspicions[1].text, "5 of 10000 values of mask_camera are neither 0 nor 1");
}

#[test]
fn ids_outside_the_table_are_told_and_the_rest_is_described() {
    let mut semantics = semantics();
    semantics[3] = 99;
    let told = file(&semantics, &ONES, &ONES);
    assert_eq!(rules_of(&told), ["ids-outside-classes"]);
    assert_eq!(told.suspicions[0].text, "1 of 10000 ids are no class: 99 (1)");
    let states = told.contents.expect("contents").states;
    assert_eq!((states.occupied, states.no_label, states.free), (2550, 1, 7449));
}

#[test]
fn the_free_id_of_another_dialect_is_told() {
    let openocc: Vec<u8> = semantics().iter().map(|id| if *id == 17 { 16 } else { *id }).collect();
    let told = file(&openocc, &ONES, &ONES);
    assert_eq!(rules_of(&told), ["free-id-of-another-dialect", "full-grid"]);
    assert!(told.suspicions[0].text.contains("free in openocc-v2, lightwheelocc"), "{told}");

    let waymo: Vec<u8> = semantics().iter().map(|id| if *id == 17 { 23 } else { *id }).collect();
    let rules = ["ids-outside-classes", "free-id-of-another-dialect", "full-grid"];
    assert_eq!(rules_of(&file(&waymo, &ONES, &ONES)), rules);
}

#[test]
fn empty_and_full_grids_are_told() {
    assert_eq!(rules_of(&file(&[17; VOXELS], &ONES, &ONES)), ["empty-grid"]);
    assert_eq!(rules_of(&file(&[4; VOXELS], &ONES, &ONES)), ["full-grid"]);
}

#[test]
fn what_no_file_of_a_dialect_tells_is_a_note_and_no_suspicion() {
    let semantics: Vec<u8> = semantics().iter().map(|id| if *id == 17 { 16 } else { 10 }).collect();
    let flow = NumberArray::new(&[50, 50, 4, 2], &[0.0_f32; 2 * VOXELS]);
    let arrays = [("semantics", NumberArray::new(&SHAPE, &semantics)), ("flow", flow)];
    let told = Saved::npz(&arrays).describe();
    assert_eq!(told.dialects, ["openocc-v2", "lightwheelocc"]);
    assert_eq!(rules_of(&told), [""; 0]);
    assert_eq!(told.notes.len(), 2);
    assert!(told.notes[0].starts_with("unobserved-as-free: "), "{told}");
    assert!(told.notes[1].starts_with("axes: lightwheelocc "), "{told}");
    assert_eq!(told.contents.expect("contents").states.unobserved, None);
}

#[test]
fn a_file_of_no_dialect_says_what_it_holds() {
    let told = Saved::npz(&[("points", NumberArray::new(&[2, 3], &[0.0_f32; 6]))]).describe();
    assert!(told.dialects.is_empty() && told.contents.is_none());
    let text = told.to_string();
    assert!(text.contains("looks like   no dialect"), "{text}");
    assert!(text.contains("points <f4 [2, 3]"), "{text}");
}

#[test]
fn fault_35_a_torn_file_is_one_fault() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("labels.npz");
    std::fs::write(&path, b"PK\x03\x04 and no more").expect("a file");
    let fault = Description::of_file(&path, None).unwrap_err();
    assert_eq!(fault.rule, "npz");
    assert!(Description::of_file(&path.with_file_name("absent"), None).is_err());
}

#[test]
fn axes_that_changed_places_stretch_the_voxels() {
    let semantics = NumberArray::new(&[4, 50, 50], &semantics());
    let mask = NumberArray::new(&[4, 50, 50], &ONES);
    let arrays = [("semantics", semantics), ("mask_lidar", mask.clone()), ("mask_camera", mask)];
    let told = Saved::npz(&arrays).describe();
    assert!(rules_of(&told).contains(&"voxels-stretched"), "{:?}", told.suspicions);
}
