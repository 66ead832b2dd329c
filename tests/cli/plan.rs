//! `plan`: scenes as work items.

use serde_json::Value;

use crate::support::{Label, SMALL, TestLog, nano_spec, occlabel, text, tree_hash};

fn plan(log: &TestLog, more: &[&str]) -> crate::support::Ended {
    let root = log.root();
    let line = ["plan", "--format", "nuscenes", "--input", text(&root)];
    occlabel(&[&line[..], &SMALL, more].concat())
}

fn lines(told: &str) -> Vec<Value> {
    told.lines().map(|line| serde_json::from_str(line).expect("a JSON line")).collect()
}

#[test]
fn a_scene_is_a_line_with_what_it_costs() {
    let log = TestLog::simulated(&nano_spec().with_scenes(3));
    let lines = lines(&plan(&log, &[]).exits(0).stdout);
    let shards: Vec<_> = lines.iter().map(|line| line["shard"].as_str().unwrap()).collect();
    assert_eq!(shards, ["0/3", "1/3", "2/3"]);
    for line in &lines {
        let number = |key: &str| line[key].as_f64().unwrap_or_else(|| panic!("{key} of {line}"));
        assert_eq!(number("rays"), number("points") * number("keyframes"));
        for key in ["sweeps", "bytes", "cpu_seconds", "memory_bytes", "output_bytes"] {
            assert!(number(key) > 0.0, "{key} of {line}");
        }
        let expected = number("expected_memory_bytes");
        assert!(expected > 0.0 && expected < number("memory_bytes"), "{line}");
    }
}

#[test]
fn the_shards_of_a_plan_are_the_run() {
    let log = TestLog::simulated(&nano_spec().with_scenes(3));
    let whole = Label::new(&log.root(), &log.beside("whole")).small();
    whole.run().exits(0);
    let shards = Label::new(&log.root(), &log.beside("shards")).small();
    for line in lines(&plan(&log, &[]).exits(0).stdout).iter().rev() {
        shards.clone().with(&["--shard", line["shard"].as_str().unwrap()]).run().exits(0);
    }
    occlabel(&["merge-manifests", text(&shards.output)]).exits(0);
    assert_eq!(tree_hash(&shards.output), tree_hash(&whole.output));
}

#[test]
fn evidence_and_finer_grids_cost_more_memory() {
    let log = TestLog::nano();
    let bytes = |more: &[&str]| {
        lines(&plan(&log, more).exits(0).stdout)[0]["memory_bytes"].as_u64().unwrap()
    };
    let plain = bytes(&[]);
    assert!(bytes(&["--evidence"]) > plain);
    assert!(bytes(&["--set", "grid.voxel_size_m=0.2"]) > plain);
}

#[test]
fn what_is_expected_follows_the_configuration() {
    let log = TestLog::nano();
    let line = |more: &[&str]| lines(&plan(&log, more).exits(0).stdout).remove(0);
    let number = |line: &Value, key: &str| line[key].as_f64().unwrap();
    let plain = line(&[]);
    let costlier: [&[&str]; 3] = [
        &["--evidence"],
        &["--set", "grid.voxel_size_m=0.2"],
        &["--set", "states.free_min_crossings=11", "--set", "occlusion.rays=pixels"],
    ];
    for more in costlier {
        let other = line(more);
        assert!(number(&other, "cpu_seconds") > number(&plain, "cpu_seconds"), "{more:?}");
    }
    let bytes = |more: &[&str]| number(&line(more), "output_bytes");
    assert!(bytes(&["--evidence"]) > 2.0 * bytes(&[]));
    assert_eq!(plain["work"].as_array().map(Vec::len), Some(1), "one grid");
    assert_eq!(line(&["--also", "occ3d-nuscenes"])["work"].as_array().map(Vec::len), Some(2));
}

#[test]
fn a_scene_that_cannot_be_labelled_says_why_and_hides_no_other() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    log.remove(&log.other_files()[0]);
    let lines = lines(&plan(&log, &[]).exits(3).stdout);
    assert_eq!((lines.len(), &lines[0]["cpu_seconds"]), (2, &0.0.into()));
    assert_eq!(lines[0]["errors"][0]["rule"], "missing-files");
    assert!(lines[1]["cpu_seconds"].as_f64() > Some(0.0));
}
