//! People labelled by their meshes, through the program, judged by an exactly known world.

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use support::{Ended, occlabel, text};
use tempfile::TempDir;

/// A second among the people of `crowd`, six metres around the robot.
const GRID: [&str; 8] = [
    "--set",
    "grid.min_m=[-6.4, -6.4, -0.6]",
    "--set",
    "grid.max_m=[6.4, 6.4, 2.0]",
    "--set",
    "grid.voxel_size_m=0.1",
    "--set",
    "aggregate.ego_box_m=none",
];

/// A log with the meshes of its people, off by so much.
struct Crowd {
    folder: TempDir,
}

impl Crowd {
    fn new(off: &[&str]) -> Self {
        let crowd = Self { folder: tempfile::tempdir().expect("a temporary folder") };
        let log = crowd.log();
        let line = ["simulate", "--world", "crowd", "--format", "nuscenes", "--images", "none"];
        let rest = ["--meshes", "--set", "duration_s=1.05", "--output", text(&log)];
        occlabel(&[&line[..], &rest, off].concat()).exits(0);
        crowd
    }

    fn log(&self) -> PathBuf {
        self.folder.path().join("log")
    }

    fn label(&self, tree: &str, more: &[&str]) -> (PathBuf, Ended) {
        let (log, tree) = (self.log(), self.folder.path().join(tree));
        let line =
            ["label", "--format", "nuscenes", "--input", text(&log), "--preset", "mobileocc"];
        let rest = ["--evidence", "--output", text(&tree)];
        let ended = occlabel(&[&line[..], &rest, &GRID, more].concat());
        (tree, ended)
    }

    /// The overlap of people with the truth, and the error of their velocity.
    fn people(&self, tree: &Path) -> [f64; 2] {
        let log = self.log();
        let line = ["quality", text(tree), "--world-truth", text(&log), "--quick", "--json"];
        let json: Value = serde_json::from_str(&occlabel(&line).exits(0).stdout).expect("JSON");
        ["people_iou", "people_speed_error_mps"].map(|name| {
            let figure = &json["trees"][0]["quality"]["all"][name];
            assert!(figure["count"].as_u64() > Some(15), "{name}: {figure}");
            figure["value"].as_f64().expect("a figure")
        })
    }

    fn mesh(&self, token: &str, track: &str) -> PathBuf {
        self.log().join("meshes/crowd").join(token).join(track)
    }
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("a file")).expect("JSON")
}

#[test]
fn section_9a_people_are_whole_where_their_meshes_are_exact_and_where_points_put_them_right() {
    let exact = Crowd::new(&[]);
    let (tree, ended) = exact.label("labels", &[]);
    ended.exits(0);
    let [iou, speed_mps] = exact.people(&tree);
    assert!(iou >= 0.9 && speed_mps < 0.1, "exact: {iou} {speed_mps}");
    let counts = &json(&tree.join("report.json"))["total"]["meshes"];
    assert!(counts["aligned"].as_u64() > Some(40) && counts["refused"] == 0, "{counts}");
    assert_eq!(json(&tree.join("manifest.json"))["config"]["meshes"]["folder"], "meshes");

    let (points, ended) = exact.label("points", &["--set", "meshes.folder=none"]);
    ended.exits(0);
    let [of_points, _] = exact.people(&points);
    assert!(of_points < 0.5, "points alone know one side: {of_points}");

    let off = ["--set", "annotator.mesh_jitter_m=0.1", "--set", "annotator.mesh_jitter_rad=0.0873"];
    let off = Crowd::new(&off);
    let (tree, ended) = off.label("labels", &[]);
    ended.exits(0);
    let [iou, speed_mps] = off.people(&tree);
    assert!(iou >= 0.8 && speed_mps < 0.1, "10 cm and 5 degrees off: {iou} {speed_mps}");
}

#[test]
fn section_9a_strangers_are_numbered_and_broken_meshes_end_the_run() {
    let crowd = Crowd::new(&["--set", "duration_s=0.55"]);
    let (known, stranger) =
        (crowd.mesh("crowd-0", "crowd-person-01.obj"), crowd.mesh("crowd-0", "stranger.obj"));
    fs::copy(&known, &stranger).expect("a copy");
    let (tree, ended) = crowd.label("labels", &[]);
    ended.exits(0).tells(&["stranger at crowd-0", "they stay as given"]);
    let tracks = &json(&tree.join("manifest.json"))["scenes"]["crowd"]["tracks"];
    let tracks = tracks.as_array().expect("tracks");
    let last = tracks.last().expect("a track");
    assert_eq!((&last["id"], &last["class"]), (&"stranger".into(), &"person".into()));
    assert_eq!(last["index"], tracks.len());

    fs::write(&stranger, "v 0 0 0\nf 1 2 3\n").expect("a file");
    let (_, ended) = crowd.label("broken", &[]);
    ended.exits(1).tells(&["meshes/crowd/crowd-0/stranger.obj (line 2)"]);
    let (_, ended) = crowd.label("skipped", &["--on-error", "skip"]);
    ended.exits(3);
    let (_, ended) = crowd.label("absent", &["--set", "meshes.folder=bodies"]);
    ended.exits(2).tells(&["bodies", "a folder of meshes"]);
}
