//! One simulated drive, written in every format that holds it and labelled from each log by the same
//! rules. `tests/semantickitti.rs` has the format without boxes and cameras.

mod support;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use support::{Arrays, labelled_drive, occlabel, read_arrays, text};

/// A street with movers, two lidars and two cameras. The ego does not sway: Waymo's boxes stand upright
/// in the vehicle.
const WORLD: &str = r#"
name = "drive"
duration_s = 1.6
seed = 3
taxonomy = "occ3d-waymo"
keyframe_hz = 2.0

[ground]
bands = [
    { until_y_m = -5.6, class = "flat.sidewalk", raise_m = 0.12 },
    { until_y_m = 5.6, class = "flat.driveable_surface" },
    { class = "flat.terrain", raise_m = 0.12 },
]

[ego]
trajectory.turn = { start = { x_m = 0.1, y_m = -1.61 }, speed_mps = 6.0, begin_s = 0.4, duration_s = 1.0, yaw_rate_rad_s = 0.3 }

[[lidar]]
name = "LIDAR_TOP"
mounting = { position_m = [0.9, 0.0, 1.84], yaw_rad = -1.57 }
rate_hz = 10.0
max_range_m = 50.0
[lidar.pattern.spinning]
azimuths = 360
beams.even = { count = 16, min_rad = -0.42, max_rad = 0.15 }

[[lidar]]
name = "LIDAR_FRONT"
mounting = { position_m = [3.2, 0.0, 0.7], yaw_rad = 0.2, pitch_rad = 0.05 }
rate_hz = 10.0
max_range_m = 30.0
[lidar.pattern.spinning]
azimuths = 180
beams.even = { count = 8, min_rad = -0.5, max_rad = 0.4 }

[[camera]]
name = "CAM_FRONT"
mounting.position_m = [1.7, 0.0, 1.5]
model.pinhole.matrix = [[250.0, 0.0, 240.0], [0.0, 250.0, 135.0], [0.0, 0.0, 1.0]]
width = 480
height = 270
rate_hz = 10.0
offset_s = 0.01

[[camera]]
name = "CAM_BACK"
mounting = { position_m = [0.0, 0.0, 1.5], yaw_rad = 3.1416 }
model.brown-conrady = { matrix = [[250.0, 0.0, 240.0], [0.0, 250.0, 135.0], [0.0, 0.0, 1.0]], distortion = [-0.1, 0.01, 0.001, 0.0, 0.0] }
width = 480
height = 270
rate_hz = 10.0
offset_s = 0.02

[[static]]
class = "static.manmade"
pose = { position_m = [10.0, 9.0, 2.0] }
shape.box.size_m = [30.0, 1.0, 4.0]

[[static]]
class = "static.vegetation"
pose = { position_m = [12.0, -6.5, 2.0] }
shape.cylinder = { radius_m = 0.4, height_m = 4.0 }

[[mover]]
name = "car"
category = "vehicle.car"
size_m = [4.4, 1.8, 1.5]
lift_m = 0.05
trajectory.straight = { start = { x_m = 6.0, y_m = 2.4 }, speed_mps = 8.0 }
[[mover.part]]
shape.box.size_m = [4.3, 1.7, 1.4]

[[mover]]
name = "walker"
category = "human.pedestrian.adult"
size_m = [0.8, 0.7, 1.8]
lift_m = 0.05
trajectory.straight = { start = { x_m = 9.0, y_m = -3.0, yaw_rad = 1.6 }, speed_mps = 1.4 }
[[mover.part]]
shape.capsule = { from_m = [0.0, 0.0, -0.6], to_m = [0.0, 0.0, 0.6], radius_m = 0.25 }
"#;

/// Keyframes of the drive, nanoseconds.
const KEYFRAMES: [u64; 4] = [0, 500_000_000, 1_000_000_000, 1_500_000_000];

/// The label tree of the drive, written as one format and read as it, or as another that reads both.
fn labelled(folder: &Path, written: &str, read: &str) -> PathBuf {
    labelled_drive(folder, WORLD, [written, read], "occ3d-waymo")
}

fn arrays(tree: &Path, prefix: &str) -> Vec<Arrays> {
    let read = |time| read_arrays(tree, "drive", &format!("{prefix}{time}"));
    KEYFRAMES.into_iter().map(read).collect()
}

/// The bytes of every keyframe's arrays.
fn files(tree: &Path, prefix: &str) -> Vec<Vec<u8>> {
    let file = |time, name| {
        let path = tree.join(format!("gts/drive/{prefix}{time}/{name}.npz"));
        fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    KEYFRAMES.into_iter().flat_map(|time| [file(time, "labels"), file(time, "evidence")]).collect()
}

/// How many voxels differ in class, state or masks, of how many; and how many are occupied.
fn compare(a: &[Arrays], b: &[Arrays]) -> (usize, usize, usize) {
    let told = |arrays: &Arrays| {
        let (labels, states) = (&arrays.labels, arrays.evidence.state.values());
        let masks = labels.mask_lidar.values().iter().zip(labels.mask_camera.values());
        let voxels = labels.semantics.values().iter().zip(masks).zip(states);
        voxels
            .map(|((class, masks), state)| (*class, *masks.0, *masks.1, *state))
            .collect::<Vec<_>>()
    };
    let (a, b): (Vec<_>, Vec<_>) =
        (a.iter().flat_map(told).collect(), b.iter().flat_map(told).collect());
    assert_eq!(a.len(), b.len());
    let differ = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    (differ, a.len(), a.iter().filter(|voxel| voxel.3 == 2).count())
}

#[test]
fn the_mcap_log_of_a_drive_gives_the_arrays_of_its_nuscenes_log_to_the_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let nuscenes = labelled(folder.path(), "nuscenes", "nuscenes");
    let mcap = labelled(folder.path(), "mcap", "mcap");
    let arrays = arrays(&nuscenes, "drive-");
    let (differ, voxels, occupied) = compare(&arrays, &self::arrays(&mcap, ""));
    assert_eq!(differ, 0, "of {voxels}");
    assert!(occupied > 1000, "{occupied}");
    assert!(files(&nuscenes, "drive-") == files(&mcap, ""), "evidence differs");
}

#[test]
fn the_waymo_log_of_a_drive_gives_the_states_of_its_nuscenes_log_but_for_roundings() {
    let folder = tempfile::tempdir().expect("a folder");
    let nuscenes = labelled(folder.path(), "nuscenes", "nuscenes");
    let waymo = labelled(folder.path(), "waymo", "waymo");
    let (differ, voxels, occupied) = compare(&arrays(&nuscenes, "drive-"), &arrays(&waymo, ""));
    println!("{differ} of {voxels} voxels differ, {occupied} are occupied");
    assert!(
        differ * 1000 <= voxels && occupied > 1000,
        "{differ} of {voxels}, {occupied} occupied"
    );
}

#[cfg(feature = "waymo-v2")]
#[test]
fn both_waymo_logs_of_a_drive_give_the_same_arrays() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = labelled(folder.path(), "waymo", "waymo");
    let second = labelled(folder.path(), "waymo-v2", "waymo");
    assert!(files(&first, "") == files(&second, ""));
}

/// The drive with what CODa has words for: one lidar, cameras that it triggers.
fn one_lidar() -> String {
    let (before, front) =
        WORLD.split_once("[[lidar]]\nname = \"LIDAR_FRONT\"").expect("two lidars");
    let (_, cameras) = front.split_once("[[camera]]").expect("cameras");
    let cameras = cameras.replace("offset_s = 0.01", "").replace("offset_s = 0.02", "");
    format!("{before}[[camera]]{cameras}")
}

/// The label tree of that drive in the lidar's frame, which is the ego's in CODa.
fn labelled_in_lidar_frame(folder: &Path, format: &str) -> Vec<Arrays> {
    let [world, log, labels] =
        ["world.toml", "log", "labels"].map(|name| folder.join(format).join(name));
    fs::create_dir_all(folder.join(format))
        .and_then(|()| fs::write(&world, one_lidar()))
        .expect("a world");
    let line = ["simulate", "--world", text(&world), "--format", format, "--output", text(&log)];
    occlabel(&[&line[..], &["--images", "none"]].concat()).exits(0);
    let line = ["label", "--format", format, "--input", text(&log), "--output", text(&labels)];
    let rules = ["taxonomy.file=coda", "grid.frame=lidar", "aggregate.ego_box_m=none"];
    let grid = ["grid.min_m=[-16.0, -16.0, -3.2]", "grid.max_m=[16.0, 16.0, 3.2]"];
    let sets = rules.iter().chain(&grid).flat_map(|rule| ["--set", rule]);
    occlabel(&line.into_iter().chain(sets).chain(["--evidence"]).collect::<Vec<_>>()).exits(0);
    arrays(&labels, if format == "nuscenes" { "drive-" } else { "" })
}

/// CODa tells terrain and boxes apart from the rest, and the rest not from each other.
#[test]
fn the_coda_log_of_a_drive_gives_the_arrays_of_its_nuscenes_log_but_for_classes_of_what_stands() {
    const FREE: u8 = 20;
    /// `other`, `vegetation`, `manmade`: what stands and has no box.
    const STANDS: [u8; 3] = [0, 9, 15];
    let folder = tempfile::tempdir().expect("a folder");
    let mut seen = BTreeSet::new();
    let mut as_told = |mut arrays: Vec<Arrays>| {
        for class in arrays.iter_mut().flat_map(|arrays| arrays.labels.semantics.values_mut()) {
            *class = if STANDS.contains(class) { STANDS[0] } else { *class };
            seen.insert(*class);
        }
        arrays
    };
    let nuscenes = as_told(labelled_in_lidar_frame(folder.path(), "nuscenes"));
    let coda = as_told(labelled_in_lidar_frame(folder.path(), "coda"));
    let (differ, voxels, occupied) = compare(&nuscenes, &coda);
    assert!(differ == 0 && occupied > 1000, "{differ} of {voxels} differ, {occupied} occupied");
    // The car, the walker, road, sidewalk and terrain, and what stands.
    assert_eq!(Vec::from_iter(seen), [0, 1, 7, 16, 17, 18, FREE]);
}
