//! A log of two samples, to be bent by the tests.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use occlabel_core::{ClassId, Fault, KeyframeSettings, Scene, Taxonomy};
use occlabel_logs::{NuScenesLog, NuScenesOptions, QuaternionOrder, ReadOptions, SceneSource};
use serde_json::{Value, json};
use tempfile::TempDir;

/// In a table, stands for a bare `NaN`.
pub(crate) const NAN: &str = "<NaN>";

/// The tables and files of a log, before they are written.
///
/// One scene, `scene-0001`: lidar sweeps l0, l1, l2 at 1.0, 1.25 and 1.5 s, of which l0 and l2 are the
/// key sweeps of samples s0 and s1; images c0, c1, c2 of CAM_FRONT 10 ms after each; a car i0 with box
/// a0 at s0 and a1 at s1. The ego drives along x at 10 m/s.
pub(crate) struct TinyLog {
    pub(crate) tables: BTreeMap<&'static str, Vec<Value>>,
    pub(crate) files: BTreeMap<String, Vec<u8>>,
    pub(crate) keyframes: KeyframeSettings,
    pub(crate) options: fn(&mut NuScenesOptions),
}

impl TinyLog {
    pub(crate) fn new() -> Self {
        let keyframes = KeyframeSettings::annotated();
        let files = ["l0", "l1", "l2"]
            .into_iter()
            .zip([0.0, 1.0, 2.0])
            .map(|(token, x)| (sweep_file(token), points(&[[x, 1.0, 2.0], [-1.5, x, 0.5]])));
        Self { tables: tables(), files: files.collect(), keyframes, options: |_| {} }
    }

    /// A row, by its token.
    pub(crate) fn row(&mut self, table: &str, token: &str) -> &mut Value {
        let rows = self.tables.get_mut(table).unwrap();
        rows.iter_mut().find(|row| row["token"] == token).unwrap()
    }

    /// Another row like the one with a token.
    pub(crate) fn copy(&mut self, table: &str, token: &str, changes: &[(&str, Value)]) {
        let mut row = self.row(table, token).clone();
        for (field, value) in changes {
            row[*field] = value.clone();
        }
        self.tables.get_mut(table).unwrap().push(row);
    }

    /// Writes the log.
    pub(crate) fn write(&self) -> TempDir {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("v1.0-tiny");
        fs::create_dir(&folder).unwrap();
        for (table, rows) in &self.tables {
            let text = serde_json::to_string_pretty(rows).unwrap();
            let text = text.replace(&format!("\"{NAN}\""), "NaN");
            fs::write(folder.join(format!("{table}.json")), text).unwrap();
        }
        for (file, bytes) in &self.files {
            let path = root.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
        root
    }

    /// Writes the log and opens it.
    pub(crate) fn open(&self) -> Result<OpenLog, Fault> {
        let root = self.write();
        Ok(OpenLog { log: self.open_in(root.path())?, root })
    }

    /// Opens a log that is written already.
    pub(crate) fn open_in(&self, root: &Path) -> Result<NuScenesLog, Fault> {
        let mut options = NuScenesOptions {
            read: ReadOptions { keyframes: self.keyframes.clone(), ..ReadOptions::of(taxonomy()) },
            version: None,
            quaternion_order: QuaternionOrder::Wxyz,
            columns: None,
        };
        (self.options)(&mut options);
        NuScenesLog::open(root, options)
    }

    /// The scene, however it goes.
    pub(crate) fn load(&self) -> Result<Scene, Fault> {
        let open = self.open()?;
        open.log.load(&open.log.scene_names()[0])
    }

    /// The scene, which has to be readable.
    pub(crate) fn scene(&self) -> Scene {
        self.load().unwrap_or_else(|fault| panic!("{fault}"))
    }

    /// What opening the log or loading the scene says against it.
    pub(crate) fn refusal(&self) -> String {
        self.load().expect_err("a log that is refused").to_string()
    }
}

/// An opened log, and the folder that it stands in.
pub(crate) struct OpenLog {
    pub(crate) log: NuScenesLog,
    pub(crate) root: TempDir,
}

pub(crate) const CAR: ClassId = ClassId(0);
pub(crate) const ROAD: ClassId = ClassId(1);

pub(crate) fn taxonomy() -> Taxonomy {
    serde_json::from_value(json!({
        "classes": ["car", "road"], "free": 17, "unknown": "drop",
        "things": ["car"], "movers": ["car"], "deformable": [], "flat": ["road"],
        "priority": ["car", "road"],
        "points": {"noise": "ignore", "vehicle.car": "car", "flat.driveable_surface": "road"},
        "boxes": {"vehicle.car": "car", "vehicle.ego": "ignore"},
    }))
    .unwrap()
}

pub(crate) fn sweep_file(token: &str) -> String {
    format!("sweeps/LIDAR_TOP/{token}.pcd.bin")
}

/// A sweep's file: x, y, z, intensity, ring.
pub(crate) fn points(points: &[[f32; 3]]) -> Vec<u8> {
    let columns = points
        .iter()
        .enumerate()
        .flat_map(|(ring, [x, y, z])| [*x, *y, *z, 17.5, (ring % 32) as f32]);
    columns.flat_map(f32::to_le_bytes).collect()
}

fn tables() -> BTreeMap<&'static str, Vec<Value>> {
    let captures = [
        ("l0", "s0", "cal-lidar", 1_000_000, true),
        ("l1", "s1", "cal-lidar", 1_250_000, false),
        ("l2", "s1", "cal-lidar", 1_500_000, true),
        ("c0", "s0", "cal-cam", 1_010_000, true),
        ("c1", "s1", "cal-cam", 1_260_000, false),
        ("c2", "s1", "cal-cam", 1_510_000, true),
        ("r0", "s0", "cal-radar", 1_000_000, true),
    ];
    BTreeMap::from([
        ("scene", vec![json!({"token": "scene-a", "name": "scene-0001", "nbr_samples": 2})]),
        ("sample", vec![sample("s0", 1_020_000), sample("s1", 1_520_000)]),
        ("sample_data", captures.map(capture).into()),
        ("ego_pose", captures.map(|(token, .., time, _)| ego_pose(token, time)).into()),
        ("calibrated_sensor", calibrations()),
        ("sensor", ["lidar", "cam", "radar"].map(sensor).into()),
        ("sample_annotation", vec![annotation("a0", "s0", 20.0), annotation("a1", "s1", 24.0)]),
        ("instance", vec![json!({"token": "i0", "category_token": "cat-car"})]),
        (
            "category",
            vec![
                json!({"token": "cat-noise", "name": "noise", "index": 0}),
                json!({"token": "cat-car", "name": "vehicle.car", "index": 17}),
                json!({"token": "cat-road", "name": "flat.driveable_surface", "index": 24}),
            ],
        ),
    ])
}

fn sample(token: &str, timestamp: i64) -> Value {
    json!({"token": token, "timestamp": timestamp, "scene_token": "scene-a", "prev": "", "next": ""})
}

fn capture((token, sample, calibration, time, key): (&str, &str, &str, i64, bool)) -> Value {
    let (width, height) = if calibration == "cal-cam" { (8, 4) } else { (0, 0) };
    json!({
        "token": token, "sample_token": sample, "ego_pose_token": format!("pose-{token}"),
        "calibrated_sensor_token": calibration, "filename": sweep_file(token),
        "timestamp": time, "is_key_frame": key, "width": width, "height": height,
        "prev": "", "next": "",
    })
}

fn ego_pose(token: &str, time: i64) -> Value {
    let x = time as f64 / 1e5;
    json!({
        "token": format!("pose-{token}"), "timestamp": time,
        "translation": [x, 0.0, 0.0], "rotation": [1.0, 0.0, 0.0, 0.0],
    })
}

fn calibrations() -> Vec<Value> {
    let calibration = |name: &str, translation: [f64; 3], intrinsic: Value| {
        json!({
            "token": format!("cal-{name}"), "sensor_token": format!("sensor-{name}"),
            "translation": translation, "rotation": [1.0, 0.0, 0.0, 0.0],
            "camera_intrinsic": intrinsic,
        })
    };
    vec![
        calibration("lidar", [1.0, 0.0, 2.0], json!([])),
        calibration(
            "cam",
            [1.5, 0.0, 1.5],
            json!([[6.0, 0.0, 4.0], [0.0, 6.0, 2.0], [0.0, 0.0, 1.0]]),
        ),
        calibration("radar", [3.5, 0.0, 0.5], json!([])),
    ]
}

fn sensor(name: &str) -> Value {
    let (channel, modality) = match name {
        "lidar" => ("LIDAR_TOP", "lidar"),
        "cam" => ("CAM_FRONT", "camera"),
        _ => ("RADAR_FRONT", "radar"),
    };
    json!({"token": format!("sensor-{name}"), "channel": channel, "modality": modality})
}

fn annotation(token: &str, sample: &str, x: f64) -> Value {
    json!({
        "token": token, "sample_token": sample, "instance_token": "i0",
        "translation": [x, 3.0, 0.8], "size": [2.0, 4.0, 1.5], "rotation": [1.0, 0.0, 0.0, 0.0],
        "attribute_tokens": [], "visibility_token": "4", "num_lidar_pts": 3, "prev": "", "next": "",
    })
}
