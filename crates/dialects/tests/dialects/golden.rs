//! Tiny files whose numbers are known, as numpy reads them.
//!
//! The grid has 4 x 3 x 2 voxels. Voxel (3, 0, 1) is of the second class (index 1), voxel (1, 2, 0)
//! of the fourth (index 3); voxel (2, 1, 0) is free but unobserved.

use occlabel_core::VoxelGrid;
use occlabel_dialects::{Dialect, Encoded, KeyframeLabels, Note};
use occlabel_labels::{NpzFile, NumberArray, NumberType, read_npy};

use crate::support::{dialect, free, spec, write};

fn labels(dialect: &Dialect) -> KeyframeLabels {
    let spec = spec();
    let at = |voxel| spec.flat(occlabel_core::VoxelIndex(voxel)).unwrap();
    let mut labels = free(dialect, &spec);
    labels.semantics.values_mut()[at([3, 0, 1])] = 1;
    labels.semantics.values_mut()[at([1, 2, 0])] = 3;
    let mut mask = VoxelGrid::filled(&spec, 1);
    mask.values_mut()[at([2, 1, 0])] = 0;
    labels.mask_lidar = Some(mask.clone());
    labels.mask_camera = Some(mask);
    let mut flow = VoxelGrid::filled(&spec, [0.0; 3]);
    flow.values_mut()[at([3, 0, 1])] = [1.5, -2.0, 0.25];
    labels.flow = Some(flow);
    labels
}

struct Written {
    folder: tempfile::TempDir,
    encoded: Encoded,
}

impl Written {
    fn of(name: &str, change: impl Fn(&mut KeyframeLabels)) -> Self {
        let (folder, dialect) = (tempfile::tempdir().unwrap(), dialect(name));
        let mut labels = labels(&dialect);
        change(&mut labels);
        let encoded = write(folder.path(), &dialect, &labels, "s", "k");
        Self { folder, encoded }
    }

    fn all(name: &str) -> Self {
        Self::of(name, |_| {})
    }

    fn paths(&self) -> Vec<&str> {
        self.encoded.files.iter().map(|(path, _)| path.as_str()).collect()
    }

    fn array(&self, name: &str) -> NumberArray {
        let place = self.folder.path().join(self.paths()[0]);
        NpzFile::open(&place, 1 << 20).unwrap().array(name, 1 << 20).unwrap().unwrap()
    }

    fn rows(&self, file: usize) -> (NumberType, Vec<usize>, Vec<f64>) {
        let array = read_npy(&self.folder.path().join(self.paths()[file]), 1 << 20).unwrap();
        (array.number, array.shape.clone(), array.floats())
    }

    fn notes(&self) -> Vec<String> {
        self.encoded.notes.iter().map(Note::to_string).collect()
    }
}

/// A value, and others at places of the flat array.
fn but<const N: usize>(value: i64, others: [(usize, i64); N]) -> Vec<i64> {
    let mut values = vec![value; 24];
    others.into_iter().for_each(|(at, other)| values[at] = other);
    values
}

#[test]
fn occ3d_nuscenes_is_x_y_z() {
    let written = Written::all("occ3d-nuscenes");
    assert_eq!(written.paths(), ["gts/s/k/labels.npz"]);
    let semantics = written.array("semantics");
    assert_eq!((semantics.number, &semantics.shape[..]), (NumberType::U8, &[4, 3, 2][..]));
    assert_eq!(semantics.whole().unwrap(), but(17, [(19, 1), (10, 3)]));
    assert_eq!(written.array("mask_lidar").whole().unwrap(), but(1, [(14, 0)]));
    assert_eq!(written.notes(), ["flow: the dialect has no words for it, left out"]);
}

#[test]
fn occ3d_waymo_has_names_of_its_own() {
    let written = Written::all("occ3d-waymo");
    assert_eq!(written.paths(), ["s/k_04.npz"]);
    assert_eq!(written.array("voxel_label").whole().unwrap(), but(23, [(19, 1), (10, 3)]));
    assert_eq!(written.array("origin_voxel_state").whole().unwrap(), but(1, [(14, 0)]));
    assert_eq!(written.array("infov").whole().unwrap(), [1; 24]);
    let notes = ["infov: not known, written as 1 everywhere", "ego2global: not known, left out"];
    assert_eq!(written.notes()[..2], notes);
    assert_eq!(Written::all("occ3d-waymo-fine").paths(), ["s/k.npz"]);
}

#[test]
fn a_submission_is_an_array_without_a_name() {
    let written = Written::all("occ3d-nuscenes-submission");
    assert_eq!(written.paths(), ["k.npz"]);
    assert_eq!(written.array("arr_0").whole().unwrap(), but(17, [(19, 1), (10, 3)]));
}

#[test]
fn surroundocc_is_rows_of_x_y_z_class() {
    let written = Written::all("surroundocc");
    assert_eq!(written.paths(), ["dense_voxels_with_semantic/k.npy"]);
    let rows = vec![1.0, 2.0, 0.0, 3.0, 3.0, 0.0, 1.0, 1.0];
    assert_eq!(written.rows(0), (NumberType::I64, vec![2, 4], rows));
}

#[test]
fn openoccupancy_is_rows_of_z_y_x_class() {
    let written = Written::of("openoccupancy", |labels| labels.flow = None);
    assert_eq!(written.paths(), ["scene_s/occupancy/k.npy"]);
    let rows = vec![0.0, 2.0, 1.0, 3.0, 1.0, 0.0, 3.0, 1.0];
    assert_eq!(written.rows(0), (NumberType::I64, vec![2, 4], rows));
    let moving = vec![0., 2., 1., 0., 0., 0., 3., 1., 0., 3., 1.5, -2., 0.25, 1.];
    let written = Written::all("openoccupancy");
    assert_eq!(written.rows(0), (NumberType::F32, vec![2, 7], moving));
}

#[test]
fn openocc_v2_has_two_components_of_flow() {
    let written = Written::all("openocc-v2");
    assert_eq!(written.paths(), ["openocc_v2/s/k/labels.npz"]);
    assert_eq!(written.array("semantics").whole().unwrap(), but(16, [(19, 1), (10, 3)]));
    let flow = written.array("flow");
    assert_eq!((flow.number, &flow.shape[..]), (NumberType::F32, &[4, 3, 2, 2][..]));
    assert_eq!(flow.floats()[36..42], [0.0, 0.0, 1.5, -2.0, 0.0, 0.0]);
    let written = Written::of("openocc-v2", |labels| labels.flow = None);
    assert_eq!(written.array("flow").floats(), [0.0; 48]);
    assert_eq!(written.notes()[0], "flow: not known, written as 0 everywhere");
}

#[test]
fn lightwheelocc_counts_y_from_the_upper_end() {
    let written = Written::all("lightwheelocc");
    assert_eq!(written.paths(), ["occupancy/s/k.npz"]);
    // (3, 0, 1) is (3, 2, 1) there, (1, 2, 0) is (1, 0, 0)
    assert_eq!(written.array("semantics").whole().unwrap(), but(16, [(23, 1), (6, 3)]));
    assert_eq!(written.array("flow").floats()[44..], [0.0, 0.0, 1.5, -2.0]);
}

#[test]
fn openscene_counts_x_fastest() {
    let written = Written::all("openscene");
    let paths = ["k_occ_final.npy", "k_flow_final.npy", "k_occ_invalid.npy"];
    assert_eq!(written.paths(), paths.map(|path| format!("s/occupancy/{path}")));
    // index = z * 12 + y * 4 + x; ids 4 and 6 are the second and the fourth class
    let rows = vec![9.0, 6.0, 15.0, 4.0];
    assert_eq!(written.rows(0), (NumberType::I32, vec![2, 2], rows));
    let flow = vec![0.0, 0.0, 1.5, -2.0];
    assert_eq!(written.rows(1), (NumberType::F32, vec![2, 2], flow));
    assert_eq!(written.rows(2), (NumberType::I64, vec![1], vec![6.0]));
}

#[test]
fn semantickitti_has_its_first_voxel_in_the_highest_bit() {
    let written = Written::of("semantickitti", |labels| {
        let input = labels.semantics.map(|&index| u8::from(index < 33));
        let input = NumberArray::new(&[4, 3, 2], input.values());
        labels.extras.insert("input".to_owned(), input);
    });
    let paths = ["label", "bin", "invalid"].map(|end| format!("sequences/s/voxels/k.{end}"));
    assert_eq!(written.paths(), paths);
    let bytes: Vec<&[u8]> = written.encoded.files.iter().map(|(_, bytes)| &bytes[..]).collect();
    // raw ids 10 and 13, car and bus, at 19 and 10 of 24 voxels; 0 is free
    let ids = but(0, [(19, 10), (10, 13)]);
    assert_eq!(bytes[0], ids.iter().flat_map(|&id| (id as u16).to_le_bytes()).collect::<Vec<_>>());
    assert_eq!(bytes[1], [0b0000_0000, 0b0010_0000, 0b0001_0000]);
    assert_eq!(bytes[2], [0b0000_0000, 0b0000_0010, 0b0000_0000]);
    let predicted = Written::all("semantickitti-predictions");
    assert_eq!(predicted.paths(), ["sequences/s/predictions/k.label"]);
    assert_eq!(Written::all("sscbench-kitti360").paths()[0], "data_2d_raw/s/voxels/k.label");
}

#[test]
fn what_a_dialect_has_no_words_for_is_told() {
    let written = Written::of("semantickitti-predictions", |labels| {
        labels.semantics.values_mut()[0] = occlabel_dialects::IGNORED;
        labels.instances = Some(VoxelGrid::filled(&spec(), 0));
        labels.extras.insert("infov".to_owned(), NumberArray::new(&[1], &[1_u8]));
    });
    assert_eq!(written.encoded.files[0].1[..2], [0, 0]);
    let lost = ["flow", "infov", "instances", "mask_camera", "mask_lidar"];
    let lost = lost.map(|what| format!("{what}: the dialect has no words for it, left out"));
    assert_eq!(written.notes()[..5], lost);
    assert_eq!(written.notes()[5], "semantics: voxels without a label are written as free");
}

#[test]
fn sscbench_waymo_says_what_is_invalid() {
    let written = Written::all("sscbench-waymo");
    assert_eq!(written.paths(), ["voxels/s/k.npz"]);
    assert_eq!(written.array("labels").number, NumberType::U16);
    assert_eq!(written.array("labels").whole().unwrap(), but(0, [(19, 10), (10, 13)]));
    assert_eq!(written.array("invalid").whole().unwrap(), but(0, [(14, 1)]));
    assert_eq!(written.notes()[0], "input: not known, left out");
}

#[test]
fn uniocc_has_its_own_order_of_classes() {
    let written = Written::all("uniocc");
    assert_eq!(written.paths(), ["s/k.npz"]);
    assert_eq!(written.array("occ_label").whole().unwrap(), but(10, [(19, 1), (10, 3)]));
    assert_eq!(written.array("occ_mask_camera").whole().unwrap(), but(1, [(14, 0)]));
}
