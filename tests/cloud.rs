//! Reconstructed clouds, labelled and judged by the program.

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use support::{Ended, occlabel, read_arrays, text};
use tempfile::TempDir;

/// A street with a car that drives ahead, and three cameras.
const WORLD: &str = r#"
name = "drive"
duration_s = 2.1
seed = 3
taxonomy = "occ3d-nuscenes"
keyframe_hz = 1.0

[ground]
bands = [{ class = "flat.driveable_surface" }]

[ego]
trajectory.straight = { start = { x_m = 0.1, y_m = -1.61 }, speed_mps = 6.0 }

[reconstruction]
exposure_stride = 2
pixel_stride = 2

[[lidar]]
name = "LIDAR_TOP"
mounting.position_m = [0.9, 0.0, 1.84]
rate_hz = 10.0
max_range_m = 50.0
[lidar.pattern.spinning]
azimuths = 90
beams.even = { count = 4, min_rad = -0.42, max_rad = 0.15 }

[[camera]]
name = "FRONT"
mounting.position_m = [1.7, 0.0, 1.5]
model.pinhole.matrix = [[250.0, 0.0, 240.0], [0.0, 250.0, 135.0], [0.0, 0.0, 1.0]]
width = 480
height = 270
rate_hz = 10.0
body_mask = [{ from-row = 262 }]

[[camera]]
name = "LEFT"
mounting = { position_m = [1.5, 0.5, 1.5], yaw_rad = 1.57 }
model.pinhole.matrix = [[250.0, 0.0, 240.0], [0.0, 250.0, 135.0], [0.0, 0.0, 1.0]]
width = 480
height = 270
rate_hz = 10.0

[[camera]]
name = "RIGHT"
mounting = { position_m = [1.5, -0.5, 1.5], yaw_rad = -1.57 }
model.kannala-brandt = { matrix = [[250.0, 0.0, 240.0], [0.0, 250.0, 135.0], [0.0, 0.0, 1.0]], distortion = [0.01, 0.0, 0.0, 0.0] }
width = 480
height = 270
rate_hz = 10.0

[[static]]
class = "static.manmade"
pose = { position_m = [12.0, 9.1, 2.0] }
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
trajectory.straight = { start = { x_m = 8.0, y_m = 2.4 }, speed_mps = 7.0 }
[[mover.part]]
shape.box.size_m = [4.3, 1.7, 1.4]
"#;

/// A grid of which no surface of the world lies on a face.
const GRID: [&str; 4] =
    ["--set", "grid.min_m=[-16.0, -16.0, -1.0]", "--set", "grid.max_m=[16.0, 16.0, 5.4]"];

struct Reconstructed {
    folder: TempDir,
}

impl Reconstructed {
    fn new() -> Self {
        let cloud = Self { folder: tempfile::tempdir().expect("a folder") };
        let world = cloud.place("world.toml");
        fs::write(&world, WORLD).expect("a world");
        let simulate = ["simulate", "--world", text(&world), "--format", "cloud"];
        let log = cloud.place("log");
        let told = occlabel(&[&simulate[..], &["--output", text(&log)]].concat()).exits(0);
        assert!(told.stdout.contains("label --format cloud --preset gs-occ3d"), "{}", told.stdout);
        cloud
    }

    fn place(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, command: &str, more: &[&str]) -> Ended {
        let log = self.place("log");
        occlabel(&[&[command, "--format", "cloud", "--input", text(&log)], more].concat())
    }

    fn label(&self, tree: &Path, more: &[&str]) -> Ended {
        let line = ["--preset", "gs-occ3d", "--output", text(tree)];
        self.run("label", &[&line[..], &GRID, more].concat())
    }
}

fn figure(judged: &Value, name: &str) -> (f64, u64) {
    let figure = &judged["trees"][0]["quality"]["all"][name];
    let value = figure["value"].as_f64().unwrap_or_else(|| panic!("{name} of {judged}"));
    (value, figure["count"].as_u64().expect("a count"))
}

#[test]
fn a_vision_only_cloud_gives_the_true_occupancy_within_the_cameras_view() {
    let cloud = Reconstructed::new();
    let tree = cloud.place("labels");
    cloud.label(&tree, &["--evidence"]).exits(0);
    let truth = cloud.place("log");
    let judged = ["quality", text(&tree), "--world-truth", text(&truth), "--json"];
    let judged: Value =
        serde_json::from_str(&occlabel(&judged).exits(0).stdout).expect("JSON of figures");
    let ((iou, voxels), (right, _)) =
        (figure(&judged, "occupied_camera_iou"), figure(&judged, "occupied_precision"));
    assert!(iou >= 0.9 && voxels > 2_000, "IoU {iou} of {voxels} voxels, {right} right");

    let arrays = read_arrays(&tree, "drive", "1000000000");
    let states = arrays.evidence.state.values();
    let count = |state: u8| states.iter().filter(|of| **of == state).count();
    assert!(count(0) > 1_000 && count(1) > 1_000 && count(2) > 500, "unobserved, free, occupied");
    assert_eq!(arrays.labels.mask_lidar, arrays.labels.mask_camera);
    assert!(arrays.evidence.instances.values().contains(&1), "the car");
    assert!(arrays.evidence.crossings.values().iter().all(|crossings| *crossings == 0));
}

#[test]
fn fault_07_a_cloud_far_from_all_poses_is_told() {
    let cloud = Reconstructed::new();
    let poses = cloud.place("log/drive/poses.txt");
    let told = fs::read_to_string(&poses).expect("poses");
    let moved = told.lines().map(|line| {
        let mut words: Vec<&str> = line.split(' ').collect();
        if let Some(x) = words.get_mut(1).filter(|_| !line.starts_with('#')) {
            *x = "500000.0";
        }
        words.join(" ") + "\n"
    });
    fs::write(&poses, moved.collect::<String>()).expect("poses elsewhere");
    let parts = ["within", "of a pose", "frame of the poses"];
    cloud.label(&cloud.place("labels"), &[]).exits(0).tells(&parts);
}

#[test]
fn the_clouds_own_classes_are_kept_and_surfels_need_not_be_spread() {
    let cloud = Reconstructed::new();
    let tree = cloud.place("labels");
    let set =
        ["--set", "taxonomy.file=occ3d-nuscenes", "--set", "voxelize.surfels=points", "--evidence"];
    cloud.label(&tree, &set).exits(0);
    let arrays = read_arrays(&tree, "drive", "1000000000");
    for class in [4, 11, 15, 16] {
        assert!(arrays.labels.semantics.values().contains(&class), "class {class}");
    }
}

#[test]
fn a_cloud_is_inspected_checked_and_planned() {
    let cloud = Reconstructed::new();
    let told = cloud.run("inspect", &[]).exits(0).stdout;
    for line in [
        "poses: 3 sweeps",
        "RIGHT: kannala-brandt, 480 x 270",
        "FRONT: pinhole, 480 x 270, body mask",
    ] {
        assert!(told.contains(line), "{line} in {told}");
    }
    cloud.run("check", &["--preset", "gs-occ3d"]).exits(0).tells_nothing_of("ground");
    let plan = cloud.run("plan", &["--preset", "gs-occ3d"]).exits(0).stdout;
    let plan: Value = serde_json::from_str(&plan).expect("a line of JSON");
    assert!(plan["points"].as_u64() > Some(10_000) && plan["keyframes"] == 3, "{plan}");
}

#[test]
fn what_lidar_rays_or_held_out_sweeps_would_tell_is_refused() {
    let cloud = Reconstructed::new();
    let tree = cloud.place("labels");
    let refused = cloud.run("label", &["--output", text(&tree)]).exits(2);
    refused.tells(&["no lidar measured", "gs-occ3d"]);
    let log = cloud.place("log");
    let held_out = ["quality", "--held-out", "2", "--format", "cloud", "--input", text(&log)];
    let held_out = [&held_out[..], &["--preset", "gs-occ3d"]].concat();
    occlabel(&held_out).exits(2).tells(&["raycast.source"]);
    let nano = ["label", "--format", "nuscenes", "--input", "tests/fixtures/nano", "--output"];
    let cloud_key = ["--set", "reader.cloud.min_opacity=0.1"];
    let flags = [&nano[..], &[text(&tree)], &cloud_key].concat();
    occlabel(&flags).exits(2).tells(&["--set reader.cloud", "--format cloud"]);
}

#[test]
fn lidar_sweeps_may_be_judged_by_the_cameras_rays() {
    let folder = tempfile::tempdir().expect("a folder");
    let tree = folder.path().join("labels");
    let nano = ["label", "--format", "nuscenes", "--input", "tests/fixtures/nano"];
    let more = ["--preset", "gs-occ3d", "--output", text(&tree)];
    occlabel(&[&nano[..], &more].concat()).exits(0);
}
