//! What is printed, written and refused.

use crate::support::*;
use std::fs;
use std::path::Path;

use occlabel_core::{Fault, VoxelGrid, VoxelTruth};
use occlabel_evaluate::{KnownWorld, Limits, Quality, Tally, judge};

fn street() -> Quality {
    let swept = VoxelTruth { swept: true, ..air() };
    let mut pairs = vec![(EMPTY, air()); 20];
    pairs.extend([(occupied(WALL), surface(WALL)), (occupied(ROAD), surface(WALL))]);
    pairs.extend([(occupied(CAR), swept), (EMPTY, swept), (EMPTY, surface(ROAD))]);
    pairs.extend([(moving(CAR, [3.0, 0.0, 0.0]), mover(1, [3.0, 0.25, 0.0]))]);
    judge_row(&pairs)
}

#[test]
fn the_table_reads_so() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/world_truth/table.txt");
    let table = street().table();
    if std::env::var_os("UPDATE_GOLDENS").is_some() {
        fs::write(&path, &table).unwrap();
    }
    let golden = fs::read_to_string(&path).unwrap();
    assert!(table == golden, "{} differs:\n{table}", path.display());
}

#[test]
fn a_table_of_the_usual_rings_fits_a_hundred_columns() {
    let mut scale = row(2);
    scale.ring_m = occlabel_evaluate::RINGS_M.to_vec();
    scale.noise_sigma_m = 0.02;
    let pairs = [(occupied(WALL), surface(WALL)), (EMPTY, air())];
    let table = tally("row", &pairs, &scale).quality().table();
    let widest = table.lines().map(|line| line.chars().count()).max();
    assert!(widest <= Some(100), "{widest:?}");
    assert!(table.contains("noise of 0.02 m"));
}

#[test]
fn json_holds_values_counts_and_null() {
    let json = serde_json::to_value(street()).unwrap();
    assert_eq!(json["all"]["occupied_precision"]["value"], 0.75);
    assert_eq!(json["all"]["occupied_precision"]["count"], 4);
    assert!(json["all"]["mask_camera_iou"]["value"].is_null());
    assert_eq!(json["by_ring"][0]["to_m"], 10.0);
    assert!(json["by_ring"][2]["to_m"].is_null());
    assert_eq!(json["by_class"][1]["class"], "car");
    assert!(json["by_class"][1]["figures"].get("free_purity").is_none());
    assert_eq!(json["worst_object"]["track"], 1);
}

#[test]
fn nothing_judged_is_null_throughout() {
    let quality = Tally::default().quality();
    let json = serde_json::to_value(&quality).unwrap();
    let figures = json["all"].as_object().unwrap();
    assert!(figures.values().all(|figure| figure["value"].is_null() && figure["count"] == 0));
    assert_eq!(figures.len(), 30);
    assert!(!quality.table().contains("NaN"));
}

#[test]
fn limits_tell_in_words_what_is_missed() {
    let toml_as_json = r#"{
        "at_least": { "surface_recall": 0.99, "occupied_precision": 0.75, "mask_camera_iou": 0.5 },
        "at_most": { "flow_error_mps": 0.05, "trail_rate": 0.5 }
    }"#;
    let limits: Limits = serde_json::from_str(toml_as_json).unwrap();
    let misses: Vec<String> = limits.misses(&street()).iter().map(ToString::to_string).collect();
    assert_eq!(
        misses,
        [
            "mask_camera_iou: nothing to judge, expected at least 0.5",
            "surface_recall: 0.750000, expected at least 0.99",
            "flow_error_mps: 0.250000, expected at most 0.05",
        ]
    );
}

#[test]
fn limits_of_unknown_figures_are_refused() {
    let read = |json: &str| serde_json::from_str::<Limits>(json).unwrap_err().to_string();
    assert!(read(r#"{ "at_least": { "recall": 0.9 } }"#).contains("found `recall`"));
    assert!(read(r#"{ "below": {} }"#).contains("below"));
}

#[test]
fn the_limits_of_precise_are_figures() {
    // Ten limits, and no tally keeps one of them.
    assert_eq!(Limits::precise().misses(&Tally::default().quality()).len(), 10);
}

fn refused(classes: [u8; 2], truth_voxels: usize, class: u8) -> Fault {
    let (scale, other) = (row(2), row(truth_voxels));
    let arrays = Arrays::new(&scale.spec, &classes.map(occupied));
    let truth = VoxelGrid::filled(&other.spec, surface(class));
    let known = KnownWorld { scene: "row", truth: &truth, eyes: &[], occlusion: None };
    judge(&arrays.judged(), &known, &scale).unwrap_err()
}

#[test]
fn grids_and_classes_that_do_not_fit_are_refused() {
    assert_eq!(
        refused([ROAD, ROAD], 3, WALL).to_string(),
        "truth: expected 2 x 1 x 1 voxels, found 3 x 1 x 1 voxels"
    );
    assert_eq!(
        refused([ROAD, 3], 2, WALL).to_string(),
        "semantics: expected class ids below 3, or 17 for free, found class 3"
    );
    assert!(refused([ROAD, ROAD], 2, 9).to_string().starts_with("truth: "));
}
