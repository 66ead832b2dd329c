//! Trees that `label` wrote.

use occlabel_core::{OccupancyLabels, VoxelGrid, VoxelState};
use occlabel_dialects::{LabelSet, Wanted};
use occlabel_labels::{evidence_npz, labels_npz};

use crate::support::{manifest, put, spec, write_manifest};

fn labels() -> OccupancyLabels {
    let spec = spec();
    let grid = |value: u16| VoxelGrid::filled(&spec, value);
    let mut semantics = VoxelGrid::filled(&spec, 9);
    semantics.values_mut()[..2].copy_from_slice(&[0, 1]);
    OccupancyLabels {
        semantics,
        mask_lidar: VoxelGrid::filled(&spec, 1),
        mask_camera: VoxelGrid::filled(&spec, 0),
        states: VoxelGrid::filled(&spec, VoxelState::Free),
        evidence: Some(occlabel_core::Evidence {
            hits: grid(1),
            crossings: grid(2),
            state: VoxelGrid::filled(&spec, 1),
            instances: grid(7),
            flow: VoxelGrid::filled(&spec, [1.0, 2.0, 3.0]),
            camera_bits: grid(0),
        }),
    }
}

#[test]
fn classes_and_grid_are_the_manifest_s() {
    let (folder, labels) = (tempfile::tempdir().unwrap(), labels());
    let root = folder.path();
    put(root, "gts/s/k/labels.npz", &labels_npz(&labels));
    write_manifest(root, &manifest(&spec(), None));
    let set = LabelSet::open(root, None).unwrap();
    assert_eq!((set.dialect().name.as_str(), set.frame()), ("occlabel", "lidar"));
    assert_eq!(set.classes().names(), ["car", "road"]);
    let key = &set.keyframes()[0];
    let read = set.read_with(key, &Wanted::ALL).unwrap();
    assert_eq!(read.semantics.values()[..3], [0, 1, 2]);
    assert_eq!(read.mask_camera, Some(labels.mask_camera.clone()));
    assert!(read.instances.is_none() && !set.has_evidence(key));
}

#[test]
fn instances_and_flow_are_the_evidence_s_if_wanted() {
    let (folder, labels) = (tempfile::tempdir().unwrap(), labels());
    let root = folder.path();
    put(root, "gts/s/k/labels.npz", &labels_npz(&labels));
    put(root, "gts/s/k/evidence.npz", &evidence_npz(labels.evidence()));
    write_manifest(root, &manifest(&spec(), None));
    let set = LabelSet::open(root, None).unwrap();
    let key = &set.keyframes()[0];
    assert!(set.has_evidence(key) && set.read(key).unwrap().flow.is_none());
    let read = set.read_with(key, &Wanted::ALL).unwrap();
    assert_eq!(read.instances, Some(labels.evidence().instances.clone()));
    assert_eq!(read.flow, Some(labels.evidence().flow.clone()));
}
