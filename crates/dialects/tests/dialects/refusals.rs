//! Files that are refused, and what is said of them.

use occlabel_core::Fault;
use occlabel_dialects::{LabelSet, Wanted};
use occlabel_labels::{NumberArray, npz};

use crate::support::{dialect, manifest, put, spec, write_manifest};

const MASKS: [&str; 2] = ["mask_lidar", "mask_camera"];

/// What reading an Occ3D keyframe with such semantics comes to.
fn occ3d(semantics: &NumberArray, masks: &NumberArray) -> Result<(), Fault> {
    let arrays = [("semantics", semantics), (MASKS[0], masks), (MASKS[1], masks)];
    read("occ3d-nuscenes", "gts/s/k/labels.npz", &npz(arrays))
}

fn rows(rows: &NumberArray) -> Result<(), Fault> {
    read("openoccupancy", "scene_s/occupancy/k.npy", &rows.to_npy())
}

fn read(name: &str, file: &str, bytes: &[u8]) -> Result<(), Fault> {
    let folder = tempfile::tempdir().unwrap();
    write_manifest(folder.path(), &manifest(&spec(), Some(name)));
    put(folder.path(), file, bytes);
    let set = LabelSet::open(folder.path(), None)?;
    set.read_with(&set.keyframes()[0], &Wanted::ALL).map(drop)
}

#[test]
fn fault_26_ids_of_no_class_are_told_with_count_and_file() {
    let mask = NumberArray::new(&[4, 3, 2], &[1_u8; 24]);
    let mut ids = [17_u8; 24];
    (ids[3], ids[5], ids[7]) = (99, 18, 18);
    let fault = occ3d(&NumberArray::new(&[4, 3, 2], &ids), &mask).unwrap_err();
    assert_eq!(fault.found, "id 18 in 2 voxels");
    assert!(fault.place.ends_with("gts/s/k/labels.npz"), "{fault}");
    let fault = rows(&NumberArray::new(&[2, 4], &[0_i64, 0, 0, 99, 1, 1, 1, 99])).unwrap_err();
    assert_eq!(fault.found, "id 99 in 2 rows");
}

#[test]
fn fault_35_any_type_that_holds_the_values_is_read() {
    let mask = NumberArray::new(&[4, 3, 2], &[-1_i32; 24]);
    let ids = NumberArray::new(&[4, 3, 2], &[17_i64; 24]);
    occ3d(&ids, &mask).unwrap();
    let floats = NumberArray::new(&[4, 3, 2], &[17.0_f32; 24]);
    assert!(occ3d(&floats, &mask).unwrap_err().to_string().contains("whole numbers"));
    let twos = NumberArray::new(&[4, 3, 2], &[2_u8; 24]);
    assert!(occ3d(&ids, &twos).unwrap_err().to_string().contains("0 and 1"));
    rows(&NumberArray::new(&[1, 4], &[1_u8, 2, 3, 4])).unwrap();
    rows(&NumberArray::new(&[1, 4], &[1.0_f64, 2.0, 3.0, 4.0])).unwrap();
}

#[test]
fn other_shapes_and_places_outside_are_refused() {
    let mask = NumberArray::new(&[4, 3, 2], &[1_u8; 24]);
    let turned = NumberArray::new(&[2, 3, 4], &[17_u8; 24]);
    assert!(occ3d(&turned, &mask).unwrap_err().found.contains("[2, 3, 4]"));
    for row in [[2_i64, 0, 0, 1], [0, 3, 0, 1], [0, 0, 4, 1], [0, 0, -1, 1]] {
        assert!(rows(&NumberArray::new(&[1, 4], &row)).unwrap_err().found.contains("row 0"));
    }
    assert!(rows(&NumberArray::new(&[1, 5], &[0_i64; 5])).is_err());
    assert!(rows(&NumberArray::new(&[1, 4], &[0.5_f32; 4])).is_err());
    assert!(
        read("semantickitti-predictions", "sequences/s/predictions/k.label", &[0; 47]).is_err()
    );
    let index = NumberArray::new(&[1, 2], &[24_i32, 0]).to_npy();
    let fault = read("openscene", "s/occupancy/k_occ_final.npy", &index).unwrap_err();
    assert!(fault.found.contains("24"), "{fault}");
}

#[test]
fn fault_34_a_header_that_claims_too_much_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = "{'descr': '|u1', 'fortran_order': False, 'shape': (65536, 65536, 1), }\n";
    let header = [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes()];
    let empty = NumberArray::new::<u8>(&[0], &[]);
    let mut bytes = npz([("arr_0", &empty)]);
    put(folder.path(), "k.npz", &bytes);
    assert!(LabelSet::open(folder.path(), Some("occ3d-nuscenes-submission")).is_err());
    bytes = header.concat();
    put(folder.path(), "dense_voxels_with_semantic/k.npy", &bytes);
    let set = LabelSet::open(folder.path(), Some("surroundocc")).unwrap();
    assert_eq!(set.read(&set.keyframes()[0]).unwrap_err().rule, "npz-array");
}

#[test]
fn a_folder_of_nothing_known_lists_the_dialects() {
    let folder = tempfile::tempdir().unwrap();
    let fault = LabelSet::open(folder.path(), None).unwrap_err();
    assert!(fault.hint.unwrap().contains("semantickitti-predictions"));
    put(folder.path(), "gts/s/k/labels.npz", b"no zip");
    let fault = LabelSet::open(folder.path(), None).unwrap_err();
    assert!(fault.found.contains("named as those of occ3d-nuscenes"), "{fault}");
    let fault = LabelSet::open(folder.path(), Some("openscene")).unwrap_err();
    assert!(fault.expected.contains("{token}"), "{fault}");
    assert!(LabelSet::open(folder.path(), Some("openseen")).is_err());
}

#[test]
fn fault_36_no_scene_or_token_leads_out_of_the_tree() {
    let kitti = dialect("semantickitti");
    let labels = crate::support::free(&kitti, &spec());
    for name in ["../x", "a/b", "/etc", "", ".", "a\u{1b}"] {
        assert!(kitti.encode(&labels, name, "k").is_err(), "scene {name:?}");
        assert!(kitti.encode(&labels, "s", name).is_err(), "token {name:?}");
    }
    // SurroundOcc's own tokens are names of files of nuScenes
    let token = "n015-2018-07-18-11-07-57+0800__LIDAR_TOP__1531883530449377.pcd.bin";
    let rows = dialect("surroundocc");
    assert!(rows.encode(&crate::support::free(&rows, &spec()), "s", token).is_ok());
}
