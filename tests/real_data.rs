//! Recorded data, where it lies: `OCCLABEL_DATA`, or `../shared/data` beside the workspace.
//!
//! KITTI drive 0005 in the nuScenes layout: 21 sweeps, 5 keyframes, a van, a cyclist and parked
//! cars. No point labels, so only a box can make a voxel a thing.

mod support;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use occlabel_core::Evidence;
use serde_json::Value;
use support::{Label, manifest, read_arrays};

/// The classes of Occ3D-nuScenes that are things.
const THINGS: std::ops::RangeInclusive<u8> = 1..=10;
const VERSION: &str = "v1.0-kitti";
const SCENE: &str = "kitti-0005a";
const MIN_M: [f64; 3] = [-40.0, -40.0, -1.0];
const SIZE_M: f64 = 0.4;
const SHAPE: [usize; 3] = [200, 200, 16];

/// The log's root; none, with the reason told, if it is not there.
fn kitti() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let data = std::env::var_os("OCCLABEL_DATA").map_or(beside, PathBuf::from);
    let root = data.join("kitti0005_nuscenes");
    if root.is_dir() {
        return Some(root);
    }
    eprintln!("skipped: no kitti0005_nuscenes in OCCLABEL_DATA or ../shared/data");
    None
}

/// A box as annotated: place, rotation (w, x, y, z) and half sides along its own axes, world.
struct Annotated {
    translation: [f64; 3],
    rotation: [f64; 4],
    half_m: [f64; 3],
}

/// A key sweep: where the ego stood, and the boxes of the moment.
struct KeySweep {
    token: String,
    file: PathBuf,
    ego: ([f64; 3], [f64; 4]),
    lidar: ([f64; 3], [f64; 4]),
    boxes: Vec<Annotated>,
}

fn rows(root: &Path, table: &str) -> Vec<Value> {
    let path = root.join(VERSION).join(format!("{table}.json"));
    serde_json::from_slice(&fs::read(path).expect("a table")).expect("rows")
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let list: Vec<f64> =
        value.as_array().expect("a list").iter().filter_map(Value::as_f64).collect();
    list.try_into().expect("as many numbers")
}

fn find<'a>(rows: &'a [Value], token: &Value) -> &'a Value {
    rows.iter().find(|row| row["token"] == *token).expect("a row")
}

fn placement(row: &Value) -> ([f64; 3], [f64; 4]) {
    (numbers(&row["translation"]), numbers(&row["rotation"]))
}

fn key_sweeps(root: &Path) -> Vec<KeySweep> {
    let (poses, mounts) = (rows(root, "ego_pose"), rows(root, "calibrated_sensor"));
    let annotations = rows(root, "sample_annotation");
    let mut captures = rows(root, "sample_data");
    captures.retain(|row| row["is_key_frame"] == true && row["fileformat"] == "pcd");
    let key_sweep = |row: &Value| KeySweep {
        token: row["sample_token"].as_str().expect("a token").to_owned(),
        file: root.join(row["filename"].as_str().expect("a name")),
        ego: placement(find(&poses, &row["ego_pose_token"])),
        lidar: placement(find(&mounts, &row["calibrated_sensor_token"])),
        boxes: boxes_of(&annotations, &row["sample_token"]),
    };
    captures.iter().map(key_sweep).collect()
}

fn boxes_of(annotations: &[Value], sample: &Value) -> Vec<Annotated> {
    let annotated = |row: &Value| {
        let [width, length, height] = numbers(&row["size"]);
        let (translation, rotation) = placement(row);
        let half_m = [length / 2.0, width / 2.0, height / 2.0];
        Annotated { translation, rotation, half_m }
    };
    annotations.iter().filter(|row| row["sample_token"] == *sample).map(annotated).collect()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// v + 2 w (u x v) + 2 u x (u x v), for the quaternion (w, u).
fn rotate([w, x, y, z]: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let u = [x, y, z];
    let once = cross(u, v);
    let twice = cross(u, once);
    [0, 1, 2].map(|a| v[a] + 2.0 * (w * once[a] + twice[a]))
}

/// From the placed thing's own frame to the one it is placed in.
fn out_of((translation, rotation): ([f64; 3], [f64; 4]), p: [f64; 3]) -> [f64; 3] {
    let turned = rotate(rotation, p);
    [0, 1, 2].map(|a| turned[a] + translation[a])
}

/// The way back.
fn into((translation, [w, x, y, z]): ([f64; 3], [f64; 4]), p: [f64; 3]) -> [f64; 3] {
    rotate([w, -x, -y, -z], [0, 1, 2].map(|a| p[a] - translation[a]))
}

impl Annotated {
    /// How far a point of the world lies outside of the box grown by a margin.
    fn distance_m(&self, p: [f64; 3], margin_m: f64) -> f64 {
        let p = into((self.translation, self.rotation), p);
        let beyond = [0, 1, 2].map(|a| (p[a].abs() - self.half_m[a] - margin_m).max(0.0));
        beyond.iter().map(|d| d * d).sum::<f64>().sqrt()
    }
}

fn centre(voxel: [usize; 3]) -> [f64; 3] {
    [0, 1, 2].map(|a| MIN_M[a] + (voxel[a] as f64 + 0.5) * SIZE_M)
}

fn voxel_of(p: [f64; 3]) -> Option<[usize; 3]> {
    let index = [0, 1, 2].map(|a| ((p[a] - MIN_M[a]) / SIZE_M).floor());
    let inside = (0..3).all(|a| 0.0 <= index[a] && index[a] < SHAPE[a] as f64);
    inside.then(|| index.map(|i| i as usize))
}

fn voxels() -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = SHAPE;
    (0..nx).flat_map(move |x| (0..ny).flat_map(move |y| (0..nz).map(move |z| [x, y, z])))
}

/// The voxels that the returns of a key sweep lie in, those on the ego's own body left out.
fn hit_voxels(sweep: &KeySweep) -> BTreeSet<[usize; 3]> {
    let bytes = fs::read(&sweep.file).expect("a sweep");
    let number = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes.try_into().expect("4 bytes")));
    let point = |bytes: &[u8]| [0, 4, 8].map(|at| number(&bytes[at..at + 4]));
    let points = bytes.chunks_exact(20).map(|bytes| out_of(sweep.lidar, point(bytes)));
    points.filter(|p| !is_on_ego(p)).filter_map(voxel_of).collect()
}

/// labels.md section 13, nuScenes.
fn is_on_ego(p: &[f64; 3]) -> bool {
    let (min, max) = ([-1.2, -1.1, -0.3], [3.7, 1.1, 2.2]);
    (0..3).all(|a| min[a] <= p[a] && p[a] <= max[a])
}

/// The labelled tree of a preset.
fn labelled(root: &Path, preset: &str) -> tempfile::TempDir {
    let output = tempfile::tempdir().expect("a temporary folder");
    let line = Label::new(root, output.path()).with(&["--preset", preset, "--evidence"]);
    line.run().exits(0);
    output
}

/// Every voxel of a thing is within half a voxel's diagonal of a grown box: no ghost trails.
fn assert_things_are_in_boxes(
    sweep: &KeySweep,
    semantics: impl Fn([usize; 3]) -> u8,
    margin_m: f64,
) {
    let reach_m = SIZE_M * 3.0_f64.sqrt() / 2.0 + 1e-6;
    let mut things = 0;
    for voxel in voxels().filter(|voxel| THINGS.contains(&semantics(*voxel))) {
        let world = out_of(sweep.ego, centre(voxel));
        let nearest = sweep.boxes.iter().map(|b| b.distance_m(world, margin_m));
        let nearest_m = nearest.fold(f64::INFINITY, f64::min);
        let class = semantics(voxel);
        assert!(nearest_m <= reach_m, "{}: class {class} at {voxel:?}, {nearest_m} m", sweep.token);
        things += 1;
    }
    assert!(things > 100, "{}: {things} voxels of things", sweep.token);
}

/// What the returns of key sweeps say of the voxels they lie in.
#[derive(Debug, Default)]
struct Tally {
    /// Voxels with a return of the keyframe's own sweep.
    hit: usize,
    /// Free ones among them.
    hit_and_free: usize,
    /// Free voxels.
    free: usize,
}

impl Tally {
    /// Adds a keyframe. A free voxel has fewer hits than make it occupied.
    fn add(&mut self, sweep: &KeySweep, evidence: &Evidence, min_hits: u64) {
        let is_free = |voxel: &[usize; 3]| *evidence.state.at(*voxel) == 1;
        let hit = hit_voxels(sweep);
        let freed: Vec<_> = hit.iter().filter(|voxel| is_free(voxel)).collect();
        assert!(freed.iter().all(|voxel| u64::from(*evidence.hits.at(**voxel)) < min_hits));
        self.hit += hit.len();
        self.hit_and_free += freed.len();
        self.free += voxels().filter(is_free).count();
    }
}

#[test]
fn kitti_is_labelled_without_ghosts_and_without_holes() {
    let Some(root) = kitti() else { return };
    let sweeps = key_sweeps(&root);
    assert_eq!(sweeps.len(), 5);
    for preset in ["precise", "occ3d-nuscenes"] {
        let output = labelled(&root, preset);
        let config = manifest(output.path())["config"].clone();
        let margin_m = config["aggregate"]["box_margin_m"].as_f64().expect("a margin");
        let min_hits = config["states"]["occupied_min_hits"].as_u64().expect("a count");
        let mut tally = Tally::default();
        for sweep in &sweeps {
            let arrays = read_arrays(output.path(), SCENE, &sweep.token);
            assert_things_are_in_boxes(sweep, |voxel| *arrays.labels.semantics.at(voxel), margin_m);
            tally.add(sweep, &arrays.evidence, min_hits);
        }
        assert!(tally.hit > 20_000 && tally.free > 100_000, "{preset}: {tally:?}");
        assert!(tally.hit_and_free * 1000 < tally.free, "{preset}: {tally:?}");
        // One hit is enough for `precise`, so that it frees nothing that the sweep itself hit.
        assert!(min_hits > 1 || tally.hit_and_free * 1000 < tally.hit, "{preset}: {tally:?}");
        eprintln!("{preset}: {tally:?}");
    }
}
