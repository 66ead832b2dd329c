//! Which part of a log is labelled.

use std::fs;

use serde_json::Value;

use crate::labelled::{labelled, strings};
use crate::support::{
    Ended, Label, SCENE, TestLog, files_under, gts_files, leftovers, manifest, nano_spec, occlabel,
    report, text, tree_hash,
};

#[test]
fn an_unknown_scene_or_keyframe_exits_with_2_and_is_named() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small();
    label
        .clone()
        .with(&["--scenes", "scene-0002"])
        .run()
        .exits(2)
        .tells(&["scene-0002", "scene-0001"]);
    label.clone().with(&["--keyframes", "abc"]).run().exits(2).tells(&["abc", "inspect"]);
    assert!(!label.output.exists());
}

#[test]
fn scenes_can_be_named_or_listed_in_a_file() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let list = log.beside("list.txt");
    fs::write(&list, "\nscene-0002\n").expect("written");
    let named =
        Label::new(&log.root(), &log.beside("named")).small().with(&["--scenes", "scene-0002"]);
    let listed = Label::new(&log.root(), &log.beside("listed"))
        .small()
        .with(&["--scenes-from", text(&list)]);
    named.run().exits(0);
    listed.run().exits(0);
    assert_eq!(tree_hash(&named.output), tree_hash(&listed.output));
    assert!(gts_files(&named.output).keys().all(|name| name.starts_with("scene-0002/")));
}

#[test]
fn scenes_can_be_listed_on_stdin() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let label = Label::new(&log.root(), &log.beside("out")).small();
    let mut command = label.with(&["--scenes-from", "-", "--dry-run"]).command();
    fs::write(log.beside("list.txt"), "scene-0002\n").expect("written");
    let list = fs::File::open(log.beside("list.txt")).expect("a list");
    let ended = Ended::of(command.stdin(list).output().expect("the program starts")).exits(0);
    assert!(ended.stdout.contains("scene-0002") && !ended.stdout.contains("scene-0001"));
}

#[test]
fn every_sweep_or_every_nth_can_be_a_keyframe() {
    let log = TestLog::nano();
    let of_sweeps = ["--set", "keyframes.source=sweeps"];
    let all = Label::new(&log.root(), &log.beside("all")).small().with(&of_sweeps);
    all.run().exits(0);
    assert_eq!(gts_files(&all.output).len(), 9);
    let fourth = Label::new(&log.root(), &log.beside("fourth")).small().with(&of_sweeps);
    let fourth = fourth.with(&["--set", "keyframes.stride=4"]);
    fourth.run().exits(0);
    let annotated: Vec<String> = gts_files(&labelled(&[]).1.output).into_keys().collect();
    assert_eq!(gts_files(&fourth.output).into_keys().collect::<Vec<_>>(), annotated);
}

#[test]
fn keyframes_limit_what_is_written_not_what_is_aggregated() {
    let (log, label) = labelled(&[]);
    let tokens = log.keyframes();
    let some = Label::new(&log.root(), &log.beside("some")).small();
    some.clone().with(&["--keyframes", &format!("{},{}", tokens[2], tokens[0])]).run().exits(0);
    let (all, some_files) = (gts_files(&label.output), gts_files(&some.output));
    assert_eq!(some_files.len(), 2);
    assert!(some_files.iter().all(|(name, bytes)| all[name] == *bytes));
    let listed = strings(&manifest(&some.output)["scenes"][SCENE]["keyframes"]);
    assert_eq!(listed, [tokens[0].clone(), tokens[2].clone()]);
}

#[test]
fn shards_share_the_scenes_and_one_tree() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let (whole, shared) = (log.beside("whole"), log.beside("shared"));
    Label::new(&log.root(), &whole).small().run().exits(0);
    for (shard, scene) in [("0/2", "scene-0001"), ("1/2", "scene-0002")] {
        Label::new(&log.root(), &shared).small().with(&["--shard", shard]).run().exits(0);
        let name = format!("manifest.{}.json", shard.replace('/', "-of-"));
        let bytes = fs::read(shared.join(name)).expect("a shard's manifest");
        let manifest: Value = serde_json::from_slice(&bytes).expect("JSON");
        let scenes: Vec<_> = manifest["scenes"].as_object().expect("scenes").keys().collect();
        assert_eq!(scenes, [scene]);
    }
    assert!(gts_files(&whole) == gts_files(&shared), "shards write other bytes");
    assert!(!shared.join("manifest.json").exists());
    assert_eq!(leftovers(&shared), [""; 0]);
}

#[test]
fn merged_shards_are_the_tree_of_an_undivided_run() {
    let log = TestLog::simulated(&nano_spec().with_scenes(3));
    let sets = ["--also", "1.6,occ3d-nuscenes", "--evidence"];
    let (whole, shared) = (log.beside("whole"), log.beside("shared"));
    let label = |output| Label::new(&log.root(), output).small().with(&sets);
    label(&whole).run().exits(0);
    for shard in ["1/3", "0/3", "2/3"] {
        merge(&shared).exits(2).tells(&["manifest"]);
        label(&shared).with(&["--shard", shard]).run().exits(0);
    }
    merge(&shared).exits(0);
    assert_eq!(tree_hash(&whole), tree_hash(&shared));
    assert!(gts_files(&whole) == gts_files(&shared));
    occlabel(&["verify", text(&shared)]).exits(0);
    let names = |tree: &std::path::Path| files_under(tree).into_keys().collect::<Vec<_>>();
    assert_eq!(names(&whole), names(&shared), "the shards' own files are gone");
    let before = files_under(&shared);
    merge(&shared).exits(0);
    label(&shared).run().exits(0);
    assert_eq!(tree_hash(&whole), tree_hash(&shared), "an undivided run finds all of it done");
    assert_eq!(before.len(), files_under(&shared).len());
}

#[test]
fn a_merge_that_was_interrupted_is_ended_by_the_same_command() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let shared = log.beside("shared");
    for shard in ["0/2", "1/2"] {
        let label = Label::new(&log.root(), &shared).small().with(&["--shard", shard]);
        label.run().exits(0);
    }
    let second = fs::read(shared.join("manifest.1-of-2.json")).expect("a shard's manifest");
    merge(&shared).exits(0);
    let before = files_under(&shared);
    fs::write(shared.join("manifest.1-of-2.json"), &second).expect("written");
    merge(&shared).exits(0);
    assert!(files_under(&shared) == before);
    let other =
        String::from_utf8(second).expect("text").replace("\"scene-0002\"", "\"scene-0009\"");
    let other = other.replacen("\"version\": \"", "\"version\": \"9", 1);
    fs::write(shared.join("manifest.1-of-2.json"), other).expect("written");
    merge(&shared).exits(1).tells(&["shards of one run", "another program"]);
}

#[test]
fn shards_that_end_late_are_merged_in_later() {
    let log = TestLog::simulated(&nano_spec().with_scenes(3));
    let sets = ["--also", "1.6,occ3d-nuscenes"];
    let (whole, shared) = (log.beside("whole"), log.beside("shared"));
    let label = |output| Label::new(&log.root(), output).small().with(&sets);
    label(&whole).run().exits(0);
    let without = || occlabel(&["merge-manifests", text(&shared), "--without-missing"]);
    for (shard, code) in [("1/3", 3), ("0/3", 3), ("2/3", 0)] {
        label(&shared).with(&["--shard", shard]).run().exits(0);
        without().exits(code);
        let told = report(&shared);
        let is_whole = code == 0;
        assert_eq!(told["outcome"] == "complete", is_whole, "{told}");
        assert_eq!(told["missing_shards"].as_array().unwrap().is_empty(), is_whole, "{told}");
        merge(&shared).exits(if is_whole { 0 } else { 2 });
    }
    assert_eq!(tree_hash(&whole), tree_hash(&shared));
    let [theirs, ours] = [&whole, &shared].map(|tree| report(tree)["total"]["voxels"].clone());
    assert_eq!(theirs, ours);
    assert_eq!(leftovers(&shared), [""; 0]);
    merge(&shared).exits(0);
    let names = |tree: &std::path::Path| files_under(tree).into_keys().collect::<Vec<_>>();
    assert_eq!(names(&whole), names(&shared));
    fs::remove_file(shared.join("manifest.json")).expect("removed");
    label(&shared).with(&["--shard", "0/3"]).run().exits(0);
    merge(&shared).exits(2).tells(&["manifest.1-of-3.json", "--without-missing"]);
}

#[test]
fn a_shard_that_was_merged_has_nothing_to_do_again() {
    let log = TestLog::simulated(&nano_spec().with_scenes(3));
    let shared = log.beside("shared");
    let label = |shard| Label::new(&log.root(), &shared).small().with(&["--shard", shard]).run();
    let merge = || occlabel(&["merge-manifests", text(&shared), "--without-missing"]);
    for shard in ["0/3", "1/3"] {
        label(shard).exits(0);
    }
    merge().exits(3);
    let before = (tree_hash(&shared), report(&shared)["total"]["voxels"].clone());
    for shard in ["0/3", "1/3"] {
        let told = label(shard).exits(0).stdout;
        assert!(told.contains("keyframes, 0 rays"), "{told}");
    }
    merge().exits(3);
    assert_eq!((tree_hash(&shared), report(&shared)["total"]["voxels"].clone()), before);
    assert!(!label("2/3").exits(0).stdout.contains("keyframes, 0 rays"), "it was not merged");
    merge().exits(0);
}

#[test]
fn fault_40_a_tree_holds_one_run_whole_or_in_shards() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let (whole, shared) = (log.beside("whole"), log.beside("shared"));
    let label = |output, more: &[&str]| Label::new(&log.root(), output).small().with(more).run();
    let other = ["--set", "raycast.outside=drop"];
    label(&whole, &[]).exits(0);
    let before = tree_hash(&whole);
    label(&whole, &[&other[..], &["--shard", "0/2"]].concat()).exits(2).tells(&["raycast.outside"]);
    assert_eq!(tree_hash(&whole), before, "nothing is written over");
    label(&shared, &["--shard", "0/2"]).exits(0);
    label(&shared, &[&other[..], &["--shard", "1/2"]].concat())
        .exits(2)
        .tells(&["raycast.outside"]);
    label(&shared, &["--shard", "1/3"]).exits(2).tells(&["shards: 2 before, 3 now"]);
    label(&shared, &[]).exits(2).tells(&["shards: 2 before, none now", "merge-manifests"]);
    label(&shared, &["--resume", "never"]).exits(2);
    label(&shared, &["--shard", "1/2"]).exits(0);
    merge(&shared).exits(0);
    assert_eq!(tree_hash(&shared), before);
}

#[test]
fn shards_of_two_runs_are_not_merged() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let shared = log.beside("shared");
    for shard in ["0/1", "0/2"] {
        let label = Label::new(&log.root(), &shared).small();
        label.with(&["--shard", shard, "--resume", "always"]).run().exits(0);
    }
    merge(&shared).exits(2).tells(&["shards of 1, and of 2"]);
    assert!(!shared.join("manifest.json").exists());
}

fn merge(tree: &std::path::Path) -> Ended {
    occlabel(&["merge-manifests", text(tree)])
}

#[test]
fn a_dry_run_tells_and_writes_nothing() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small().with(&["--dry-run"]);
    let told = label.run().exits(0).stdout;
    for word in [SCENE, "3 keyframes", "rays", "bytes"] {
        assert!(told.contains(word), "{word} in\n{told}");
    }
    assert!(!label.output.exists());
}
