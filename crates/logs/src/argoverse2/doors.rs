//! Logs of Argoverse 2, for whoever throws bytes at them.

use std::sync::{Arc, LazyLock};

use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_ipc::writer::FileWriter;
use occlabel_testkit::in_folder;

use super::Argoverse2Log;
use crate::SceneSource;
use crate::doors::read_options;

/// The time of the one sweep, and of everything else.
const TIME_NS: i64 = 315_966_265_259_836_000;

/// The files of a sound log.
static FILES: LazyLock<[(&str, Vec<u8>); 5]> = LazyLock::new(|| {
    let time = || ("timestamp_ns", Arc::new(Int64Array::from(vec![TIME_NS])) as ArrayRef);
    let names = |name, texts: &[&str]| (name, Arc::new(StringArray::from(texts.to_vec())) as _);
    let lasers = ("laser_number", Arc::new(Int64Array::from(vec![0, 40])) as ArrayRef);
    let sensors = names("sensor_name", &["up_lidar", "down_lidar", "ring_front_center"]);
    let camera = names("sensor_name", &["ring_front_center"]);
    let boxed = [time(), names("track_uuid", &["t"]), names("category", &["car"])];
    let sides = [("length_m", 4.0), ("width_m", 2.0), ("height_m", 1.5)];
    let lens = [("fx_px", 9.0), ("fy_px", 9.0), ("cx_px", 5.0), ("cy_px", 4.0), ("k1", 0.1)];
    let image = [("k2", 0.0), ("k3", 0.0), ("width_px", 10.0), ("height_px", 8.0)];
    let points = [("x", 1.0), ("y", 2.0), ("z", 3.0)];
    [
        ("a/city_SE3_egovehicle.feather", table([vec![time()], pose(1)])),
        ("a/calibration/egovehicle_SE3_sensor.feather", table([vec![sensors], pose(3)])),
        (
            "a/calibration/intrinsics.feather",
            table([vec![camera], reals(1, &lens), reals(1, &image)]),
        ),
        ("a/annotations.feather", table([boxed.to_vec(), reals(1, &sides), pose(1)])),
        ("a/sensors/lidar/315966265259836000.feather", table([reals(2, &points), vec![lasers]])),
    ]
});

type Column = (&'static str, ArrayRef);

fn reals(rows: usize, columns: &[(&'static str, f64)]) -> Vec<Column> {
    let column = |(name, value): &(&'static str, f64)| -> Column {
        (name, Arc::new(Float64Array::from(vec![*value; rows])))
    };
    columns.iter().map(column).collect()
}

fn pose(rows: usize) -> Vec<Column> {
    let turn = [("qw", 1.0), ("qx", 0.0), ("qy", 0.0), ("qz", 0.0)];
    [reals(rows, &turn), reals(rows, &[("tx_m", 1.0), ("ty_m", -2.0), ("tz_m", 0.5)])].concat()
}

fn table<const N: usize>(columns: [Vec<Column>; N]) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns.concat()).unwrap();
    let mut writer = FileWriter::try_new(Vec::new(), &batch.schema()).unwrap();
    writer.write(&batch).unwrap();
    writer.into_inner().unwrap()
}

/// The log with other bytes in the file that the first byte tells; whether all of it was read.
pub(crate) fn log(bytes: &[u8]) -> bool {
    let Some((&place, bytes)) = bytes.split_first() else { return false };
    let mut files = FILES.each_ref().map(|(name, bytes)| (*name, &bytes[..])).to_vec();
    let place = usize::from(place) % files.len();
    files[place].1 = bytes;
    in_folder(&files, |root| {
        let Ok(log) = Argoverse2Log::open(root, read_options()) else { return false };
        log.load("a").is_ok_and(|scene| {
            let _ = log.scene_points(&scene);
            let read = scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count();
            scene.refused.is_empty() && read == 1
        })
    })
}

/// Every file, behind its number.
pub(crate) fn files() -> Vec<Vec<u8>> {
    (0..).zip(FILES.iter()).map(|(place, (_, bytes))| [&[place], &bytes[..]].concat()).collect()
}
