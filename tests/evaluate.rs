//! Scores of label sets, through the program: the committed log by two presets.

mod support;

use std::path::PathBuf;

use serde_json::Value;
use support::{Ended, Label, TestLog, manifest, occlabel, read_arrays, text};

const SCENE: &str = "scene-0001";

/// The committed log, labelled twice.
struct Labelled {
    log: TestLog,
}

impl Labelled {
    fn new() -> Self {
        let labelled = Self { log: TestLog::nano() };
        labelled.label("precise", &[]);
        labelled.label("paper", &[]);
        labelled
    }

    fn label(&self, preset: &str, more: &[&str]) -> PathBuf {
        let tree = self.place(&[&[preset], more].concat().join("-").replace(['-', ','], "_"));
        let line = Label::new(&self.log.root(), &tree).small().with(&["--preset", preset]);
        line.with(&["--evidence"]).with(more).run().exits(0);
        tree
    }

    fn place(&self, name: &str) -> PathBuf {
        self.log.beside(name)
    }

    fn evaluate(&self, prediction: &str, more: &[&str]) -> Ended {
        let (truth, prediction) = (self.place("precise"), self.place(prediction));
        let line = ["evaluate", "--truth", text(&truth), "--prediction", text(&prediction)];
        occlabel(&[&line[..], more].concat())
    }

    fn scores(&self, prediction: &str, more: &[&str]) -> Value {
        let ended = self.evaluate(prediction, &[&["--json"], more].concat()).exits(0);
        serde_json::from_str(&ended.stdout).expect("JSON")
    }

    fn tokens(&self, tree: &str) -> Vec<String> {
        let manifest = manifest(&self.place(tree));
        let tokens = manifest["scenes"][SCENE]["keyframes"].as_array().expect("keyframes").clone();
        tokens.iter().map(|token| token.as_str().expect("a token").to_owned()).collect()
    }

    /// Voxels where both trees say the same, and all voxels, within the truth's mask.
    fn agreement(&self) -> (u64, u64) {
        let (mut same, mut all) = (0, 0);
        for token in self.tokens("precise") {
            let [truth, paper] = ["precise", "paper"]
                .map(|tree| read_arrays(&self.place(tree), SCENE, &token).labels);
            let classes = truth.semantics.values().iter().zip(paper.semantics.values());
            for ((a, b), seen) in classes.zip(truth.mask_camera.values()) {
                all += u64::from(*seen);
                same += u64::from(*seen != 0 && a == b);
            }
        }
        (same, all)
    }
}

#[test]
fn labels_score_full_marks_against_themselves() {
    let found = Labelled::new().scores("precise", &["--metrics", "all"]);
    let scores = &found["scores"];
    assert_eq!(scores["keyframes"], 3);
    assert_eq!(scores["semantic"]["miou"], 1.0);
    assert_eq!(scores["semantic"]["occupied"]["iou"], 1.0);
    assert_eq!(scores["f_score"]["accuracy"], 1.0);
    assert_eq!(scores["f_score"]["chamfer_m"], 0.0);
    assert_eq!(scores["panoptic"]["all"]["pq"], 1.0);
    assert_eq!(scores["velocity"]["ave_t_mps"], 0.0);
    assert_eq!(scores["rays"]["ray_iou"]["mean"], 1.0);
}

#[test]
fn scores_count_what_the_files_hold_on_any_number_of_threads() {
    let labelled = Labelled::new();
    let found = labelled.scores("paper", &["--metrics", "all", "--rings", "5,10"]);
    let (same, all) = labelled.agreement();
    assert!(same > 1000 && same < all, "{same} of {all}");
    let semantic = &found["scores"]["semantic"];
    assert_eq!(semantic["voxels"], all);
    assert_eq!(semantic["accuracy"], same as f64 / all as f64);
    assert_eq!(found["mask"], "mask_camera");
    let rings = found["scores"]["by_ring"].as_array().expect("rings");
    let voxels = rings.iter().map(|ring| ring["semantic"]["voxels"].as_u64().expect("a count"));
    assert_eq!((rings.len(), voxels.sum::<u64>()), (3, all));
    let alone = labelled.scores("paper", &["--metrics", "all", "--rings", "5,10", "--jobs", "1"]);
    assert_eq!(alone, found);
}

#[test]
fn scenes_are_broken_down_by_what_is_known_of_them() {
    let labelled = Labelled::new();
    let table = labelled.place("scenes.tsv");
    std::fs::write(&table, "scene\tlight\nscene-0001\tnight\n").expect("a file");
    let found = labelled.scores("paper", &["--attributes", text(&table)]);
    assert_eq!(found["by_attribute"]["light"]["night"], found["scores"]);
    std::fs::write(&table, "scene\tlight\nscene-7\tday\n").expect("a file");
    labelled.evaluate("paper", &["--attributes", text(&table)]).exits(0).tells(&[SCENE]);
    std::fs::write(&table, "token\tlight\n").expect("a file");
    labelled.evaluate("paper", &["--attributes", text(&table)]).exits(2).tells(&["line 1"]);
}

#[test]
fn a_missing_prediction_is_told_and_can_be_allowed() {
    let labelled = Labelled::new();
    let tokens = labelled.tokens("precise");
    let part = labelled.label("precise", &["--keyframes", &tokens[1]]);
    let name = part.file_name().and_then(|name| name.to_str()).expect("a name").to_owned();
    let missing = ["2 missing: ", tokens[0].as_str(), tokens[2].as_str()];
    let ended = labelled.evaluate(&name, &[]).exits(1);
    ended.tells(&missing).tells(&["hint", "--allow-missing"]);
    let ended = labelled.evaluate(&name, &["--allow-missing", "--json"]).exits(3).tells(&missing);
    let found: Value = serde_json::from_str(&ended.stdout).expect("JSON");
    assert_eq!((&found["missing"], &found["scores"]["keyframes"]), (&2.into(), &1.into()));
}

#[test]
fn what_does_not_fit_is_refused() {
    let labelled = Labelled::new();
    labelled.evaluate("precise", &["--scenes", "moon"]).exits(1).tells(&["`moon`", SCENE]);
    labelled.evaluate("precise", &["--things", "moon"]).exits(2).tells(&["`moon`", "car"]);
    labelled.evaluate("precise", &["--rings", "9,3"]).exits(2).tells(&["rising"]);
    labelled.evaluate("nowhere", &[]).exits(2);
}
