//! Files as packed as Arrow may pack them, and how many rows they say that they have.

use std::fs::File;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float32Array, RecordBatch, UInt8Array};
use arrow_ipc::CompressionType;
use arrow_ipc::writer::{FileWriter, IpcWriteOptions};
use nalgebra::Point3;
use occlabel_logs::{Argoverse2Log, SceneSource};

use crate::{WHOLE, copied, data, options};

const ROWS: usize = 1000;

/// A sweep whose points stand in a row; single precision, as nothing says that it has to be half.
fn batch() -> RecordBatch {
    let metres = || (0..ROWS).map(|i| i as f32 * 0.01);
    let x: ArrayRef = Arc::new(Float32Array::from_iter_values(metres()));
    let z: ArrayRef = Arc::new(Float32Array::from_iter_values(metres().map(|_| 0.5)));
    let laser: ArrayRef = Arc::new(UInt8Array::from_iter_values((0..ROWS).map(|i| i as u8 % 64)));
    let columns = [("x", x), ("y", z.clone()), ("z", z), ("laser_number", laser)];
    RecordBatch::try_from_iter(columns).unwrap()
}

#[test]
fn sweeps_may_be_packed_by_lz4_zstandard_or_not_at_all() {
    let Some(data) = data() else { return };
    let mut read = 0;
    for packing in [None, Some(CompressionType::LZ4_FRAME), Some(CompressionType::ZSTD)] {
        let root = copied(&data, WHOLE);
        let log = Argoverse2Log::open(root.path(), options()).unwrap();
        let scene = log.load(WHOLE).unwrap();
        let options = IpcWriteOptions::default().try_with_compression(packing).unwrap();
        let file = File::create(root.path().join(&scene.sweeps[0].file)).unwrap();
        let batch = batch();
        let mut writer = FileWriter::try_new_with_options(file, &batch.schema(), options).unwrap();
        writer.write(&batch).unwrap();
        writer.write(&batch).unwrap();
        writer.finish().unwrap();
        let cloud = log.read_sweep(&scene.sweeps[0]).unwrap().cloud;
        let p_ego = scene.sweeps[0].ego_from_lidar * cloud.positions[ROWS + 7];
        assert!((p_ego - Point3::new(0.07, 0.5, 0.5)).norm() < 1e-6, "{packing:?}: {p_ego}");
        assert_eq!(cloud.len(), 2 * ROWS);
        read += 1;
    }
    assert_eq!(read, 3);
}

#[test]
fn the_points_of_a_scene_are_counted_without_unpacking_them() {
    let Some(data) = data() else { return };
    let root = copied(&data, WHOLE);
    let log = Argoverse2Log::open(root.path(), options()).unwrap();
    let scene = log.load(WHOLE).unwrap();
    assert_eq!(log.scene_points(&scene), 99_229 + 99_466);
    std::fs::write(root.path().join(&scene.sweeps[0].file), b"no Arrow file").unwrap();
    assert_eq!(log.scene_points(&scene), 99_466);
}
