//! Ways to run a line, all of which end in one tree.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use crate::case::{Case, keyframes, whole};
use crate::support::{Ended, files_under, occlabel, program, text};

/// Ends a line in a tree, and gives the tree's hash.
type Way = fn(&Case, &Path) -> String;

/// What differs most from a plain run by one thread.
const SOME: [(&str, Way); 4] = [
    ("64 threads", |case, _| case.hash(&["--jobs", "64"])),
    ("little memory", |case, undisturbed| little_memory(case, undisturbed, 1)),
    ("keyframes in parts", in_parts),
    ("two shards", |case, _| in_shards(case, &["1/2", "0/2"])),
];
const MORE: [(&str, Way); 9] = [
    ("2 threads", |case, _| case.hash(&["--jobs", "2"])),
    ("3 threads", |case, _| case.hash(&["--jobs", "3"])),
    ("8 threads", |case, _| case.hash(&["--jobs", "8"])),
    ("twice as much memory", |case, undisturbed| little_memory(case, undisturbed, 2)),
    ("one shard", |case, _| in_shards(case, &["0/1"])),
    ("three shards", |case, _| in_shards(case, &["2/3", "0/3", "1/3"])),
    ("scenes in another order", scenes_named),
    ("scenes listed in another order", scenes_listed),
    ("taken up again", taken_up_again),
];

/// Runs the line in several ways; gives how many.
#[track_caller]
fn assert_one_tree(case: &Case, ways: &[(&str, Way)]) -> usize {
    let (undisturbed, log) = (case.tree(), files_under(&case.log()));
    case.label(&undisturbed, &["--jobs", "1"]);
    let expected = whole(&undisturbed);
    for (name, way) in ways {
        assert_eq!(way(case, &undisturbed), expected, "{}: {name}", case.name);
    }
    assert!(files_under(&case.log()) == log, "{}: the log was written", case.name);
    ways.len()
}

/// The ways that a case is run in.
#[track_caller]
fn assert_some(case: &Case) {
    let all = std::env::var("OCCLABEL_MATRIX").is_ok_and(|value| value == "all");
    let more = if all { &MORE[..] } else { &[] };
    assert!(assert_one_tree(case, &[&SOME, more].concat()) >= SOME.len());
}

/// By eight threads in the memory that one keyframe at a time needs, or so many times as much.
fn little_memory(case: &Case, _: &Path, times: u64) -> String {
    let ended = occlabel(&case.line(&case.tree(), &["--memory", "1kB"])).exits(1);
    let error = ended.stderr.lines().find(|line| line.starts_with("error: ")).expect("an error");
    let (_, found) = error.split_once("found ").expect("what was found");
    let needed: u64 = found.split(' ').next().and_then(|n| n.parse().ok()).expect("a number");
    case.hash(&["--jobs", "8", "--memory", &(times * needed).to_string()])
}

/// The last keyframe of each scene first, then the others.
fn in_parts(case: &Case, undisturbed: &Path) -> String {
    let (mut last, mut others) = (Vec::new(), Vec::new());
    for (_, mut tokens) in keyframes(undisturbed) {
        last.extend(tokens.pop());
        others.extend(tokens.into_iter().rev());
    }
    let tree = case.tree();
    case.label(&tree, &["--keyframes", &last.join(",")]);
    assert_ne!(whole(&tree), whole(undisturbed));
    case.label(&tree, &["--keyframes", &others.join(",")]);
    whole(&tree)
}

fn in_shards(case: &Case, shards: &[&str]) -> String {
    let tree = case.tree();
    for shard in shards {
        case.label(&tree, &["--shard", shard]);
    }
    occlabel(&["merge-manifests", text(&tree)]).exits(0);
    whole(&tree)
}

fn backwards(undisturbed: &Path) -> Vec<String> {
    keyframes(undisturbed).into_iter().rev().map(|(scene, _)| scene).collect()
}

fn scenes_named(case: &Case, undisturbed: &Path) -> String {
    case.hash(&["--scenes", &backwards(undisturbed).join(",")])
}

fn scenes_listed(case: &Case, undisturbed: &Path) -> String {
    let (tree, list) = (case.tree(), case.tree());
    fs::write(&list, backwards(undisturbed).join("\n")).expect("a list");
    let mut command = program();
    command.args(case.line(&tree, &["--scenes-from", "-"]));
    command.stdin(Stdio::from(fs::File::open(&list).expect("a list")));
    Ended::of(command.output().expect("the program starts")).exits(0);
    whole(&tree)
}

/// A keyframe's files were lost, and the run's end with them.
fn taken_up_again(case: &Case, undisturbed: &Path) -> String {
    let tree = case.tree();
    crate::support::copy(undisturbed, &tree);
    let (scene, tokens) = keyframes(&tree).swap_remove(0);
    fs::remove_dir_all(tree.join("gts").join(scene).join(&tokens[1])).expect("removed");
    case.label(&tree, &["--jobs", "3"]);
    whole(&tree)
}

#[test]
fn section_12_every_way_of_running_gives_the_same_tree() {
    let ways = [&SOME[..], &MORE].concat();
    assert_eq!(assert_one_tree(&Case::scenes("precise"), &ways), 13);
}

#[test]
fn section_12_by_other_rules_too() {
    for preset in ["occ3d-nuscenes", "panommocc"] {
        assert_some(&Case::scenes(preset));
    }
}

#[test]
fn section_12_from_mcap_too() {
    assert_some(&Case::drive("mcap", "mobileocc", "occ3d-nuscenes"));
}

#[test]
fn section_12_from_waymo_too() {
    assert_some(&Case::drive("waymo", "occ3d-waymo", "occ3d-waymo"));
}

#[test]
fn section_12_from_semantickitti_too() {
    assert_some(&Case::drive("semantickitti", "precise", "semantickitti"));
}
