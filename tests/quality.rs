//! Labels of exactly known worlds, judged through the program.

mod support;

use std::path::{Path, PathBuf};

use serde_json::Value;
use support::{Ended, Label, occlabel, text};
use tempfile::TempDir;

/// What a second of `hill` has to reach with `precise`; all of docs/findings.md takes 20 s.
const LIMITS: &str = "
[at_least]
occupied_precision = 0.995
surface_recall = 0.99
free_recall = 0.995
mask_lidar_iou = 0.99
[at_most]
occupied_distance_excess_voxels = 0.02
trail_rate = 0.001
flow_error_right_class_mps = 0.05
";

/// A second on the hill: its log, and labels of it by two presets.
struct Judged {
    folder: TempDir,
}

impl Judged {
    fn new() -> Self {
        let judged = Self { folder: tempfile::tempdir().expect("a temporary folder") };
        let set = "duration_s=1.05";
        let simulate = ["simulate", "--world", "hill", "--format", "nuscenes", "--images", "none"];
        let log = judged.place("log");
        let log = ["--output", text(&log), "--set", set];
        occlabel(&[&simulate[..], &log].concat()).exits(0);
        ["precise", "paper"].iter().for_each(|preset| judged.label(preset));
        judged
    }

    fn place(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn label(&self, preset: &str) {
        let (log, tree) = (self.place("log"), self.place(preset));
        let input = ["label", "--format", "nuscenes", "--input", text(&log), "--preset", preset];
        occlabel(&[&input[..], &["--evidence", "--output", text(&tree)]].concat()).exits(0);
    }

    fn quality(&self, trees: &[&Path], more: &[&str]) -> Ended {
        let log = self.place("log");
        let trees: Vec<&str> = trees.iter().map(|tree| text(tree)).collect();
        let truth = ["--world-truth", text(&log), "--quick"];
        occlabel(&[&["quality"], &trees[..], &truth, more].concat())
    }
}

fn figure(tree: &Value, name: &str) -> f64 {
    tree["quality"]["all"][name]["value"].as_f64().unwrap_or_else(|| panic!("{name} of {tree}"))
}

#[test]
fn precise_keeps_its_limits_where_the_published_rules_do_not() {
    let judged = Judged::new();
    let limits = judged.place("limits.toml");
    std::fs::write(&limits, LIMITS).expect("a file");
    let (precise, paper) = (judged.place("precise"), judged.place("paper"));
    judged.quality(&[&precise], &["--limits", text(&limits)]).exits(0);
    judged.quality(&[&paper], &["--limits", text(&limits)]).exits(1).tells(&["free_recall"]);
    let both = judged.quality(&[&precise, &paper], &["--json"]).exits(0);
    let both: Value = serde_json::from_str(&both.stdout).expect("JSON");
    let (precise, paper) = (&both["trees"][0], &both["trees"][1]);
    for name in ["occupied_precision", "free_recall", "mask_lidar_iou"] {
        assert!(figure(precise, name) > figure(paper, name), "{name}: {precise} {paper}");
    }
}

#[test]
fn trees_of_sweeps_are_judged_and_quick_asks_no_limit_that_it_cannot() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (log, tree) = (folder.path().join("log"), folder.path().join("labels"));
    let simulate = ["simulate", "--world", "crossing", "--format", "nuscenes", "--images", "none"];
    let set = ["--set", "duration_s=0.4", "--output", text(&log)];
    occlabel(&[&simulate[..], &set].concat()).exits(0);
    let label = ["label", "--format", "nuscenes", "--input", text(&log), "--preset", "panommocc"];
    // The preset knows a robot's body, and this is a car.
    let car = ["--set", "aggregate.ego_box_m=auto"];
    let more = ["--set", "taxonomy.file=occ3d-nuscenes", "--output", text(&tree)];
    occlabel(&[&label[..], &car, &more].concat()).exits(0);
    let quality = ["quality", text(&tree), "--world-truth", text(&log), "--quick", "--json"];
    let limits = folder.path().join("limits.toml");
    let camera = "[at_least]\noccupied_precision = 0.995\nmask_camera_iou = 0.97\n";
    std::fs::write(&limits, camera).expect("a file");
    let judged = occlabel(&[&quality[..], &["--limits", text(&limits)]].concat()).exits(0);
    let judged = judged.tells(&["--quick leaves these limits unasked: mask_camera_iou"]);
    let judged: Value = serde_json::from_str(&judged.stdout).expect("JSON");
    let tree = &judged["trees"][0];
    assert_eq!(tree["quality"]["keyframes"], 2, "every fifth of 8 sweeps");
    let (right, pure) = (figure(tree, "occupied_precision"), figure(tree, "free_purity"));
    assert!(right > 0.995 && pure > 0.98, "{right} {pure}");
}

#[test]
fn a_world_of_the_same_name_with_other_values_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, set, outcome) in [("same", "seed=1", 0), ("other", "seed=2", 2)] {
        let [log, tree] = ["log", "labels"].map(|kind| folder.path().join(name).join(kind));
        let simulate = ["simulate", "--world", "street", "--format", "nuscenes", "--set", set];
        occlabel(&[&simulate[..], &["--images", "none", "--output", text(&log)]].concat()).exits(0);
        Label::new(&log, &tree).small().run().exits(0);
        let judge =
            |truth: &str| occlabel(&["quality", text(&tree), "--world-truth", truth, "--quick"]);
        judge(text(&log)).exits(0);
        let ended = judge("street").exits(outcome);
        assert_eq!(ended.stderr.contains("the very world `street`"), outcome == 2, "{ended:?}");
    }
}

#[test]
fn a_tree_of_another_world_is_refused() {
    let judged = tempfile::tempdir().expect("a temporary folder");
    let (log, tree) = (judged.path().join("log"), judged.path().join("labels"));
    let nano = ["label", "--format", "nuscenes", "--input", "tests/fixtures/nano", "--output"];
    occlabel(&[&nano[..], &[text(&tree)]].concat()).exits(0);
    let simulate = ["simulate", "--world", "street", "--format", "nuscenes", "--images", "none"];
    occlabel(&[&simulate[..], &["--output", text(&log)]].concat()).exits(0);
    let quality = ["quality", text(&tree), "--world-truth"];
    let refused = occlabel(&[&quality[..], &[text(&log)]].concat());
    refused.exits(2).tells(&["the world of the labelled scene `scene-0001`", "street"]);
    occlabel(&["quality", text(&log), "--world-truth", text(&log)]).exits(2).tells(&["manifest"]);
}
