//! Runs of which the log, the labels or both are in a store.

use std::collections::BTreeMap;
use std::path::Path;

use crate::bucket::Bucket;
use crate::proxy::FAULTS;
use crate::support::{SMALL, TestLog, files_under, nano_spec, occlabel, text};

/// What a run leaves, but for its report, which tells of times.
fn labels(mut files: BTreeMap<String, Vec<u8>>) -> BTreeMap<String, Vec<u8>> {
    files.retain(|name, _| !name.starts_with("report."));
    files
}

fn label<'a>(format: &'a str, input: &'a str, output: &'a str) -> Vec<&'a str> {
    let line = ["label", "--format", format, "--input", input, "--output", output];
    [&line[..], &["--progress", "none"], &SMALL].concat()
}

#[test]
fn a_run_in_a_store_that_fails_leaves_what_a_run_on_a_disk_leaves() {
    for format in ["nuscenes", "waymo", "mcap", "semantickitti", "coda"] {
        let Some(bucket) = Bucket::new(30) else { return };
        let folder = tempfile::tempdir().unwrap();
        let [log, local] = ["log", "local"].map(|name| folder.path().join(name));
        simulate(format, &log);
        let rules = ["--set", "aggregate.ego_box_m=none"];
        let line = |input, output| [&label(format, input, output)[..], &rules].concat();
        let told = occlabel(&line(text(&log), text(&local))).exits(0).stderr;

        bucket.upload(&log, "logs/street");
        let [input, output] = [bucket.url("logs/street"), bucket.url("labels/street")];
        let ended = bucket.run(&line(&input, &output)).exits(0);
        assert_eq!(
            labels(bucket.download("labels/street")),
            labels(files_under(&local)),
            "{format}"
        );
        let fates = bucket.proxy.fates();
        assert!(FAULTS.iter().filter(|fault| fates.contains_key(fault)).count() >= 4, "{fates:?}");
        assert_eq!(ended.stderr, told, "{format}");
    }
}

fn simulate(format: &str, log: &Path) {
    let line = ["simulate", "--world", "street", "--format", format, "--output", text(log)];
    occlabel(&[&line[..], &["--images", "none"]].concat()).exits(0);
}

#[test]
fn a_killed_run_goes_on_in_the_store_and_keeps_what_is_finished() {
    let Some(bucket) = Bucket::new(0) else { return };
    let log = TestLog::simulated(&nano_spec());
    let local = log.beside("local");
    occlabel(&label("nuscenes", text(&log.root()), text(&local))).exits(0);
    bucket.upload(&log.root(), "log");
    let [input, output] = [bucket.url("log"), bucket.url("labels")];
    let line = [&label("nuscenes", &input, &output)[..], &["--jobs", "1"]].concat();

    let mut running = bucket.command(&line).spawn().unwrap();
    let journal = format!("PUT /{}", output.trim_start_matches("s3://")) + "/journal.jsonl";
    // The journal without a line, with the first, with the second.
    while bucket.proxy.count(&journal) < 3 {
        assert!(running.try_wait().unwrap().is_none(), "it ended before it was killed");
        std::thread::yield_now();
    }
    running.kill().unwrap();
    running.wait().unwrap();
    let left = bucket.download("labels");
    let finished = left["journal.jsonl"].iter().filter(|&&byte| byte == b'\n').count();
    assert!(finished >= 1 && !left.contains_key("manifest.json"), "{finished}");

    let put = format!("PUT /{}/gts/", output.trim_start_matches("s3://"));
    let before = bucket.proxy.count(&put);
    bucket.run(&line).exits(0);
    assert_eq!(labels(bucket.download("labels")), labels(files_under(&local)));
    let todo = files_under(&local.join("gts")).len() - finished;
    // The dead run's lock is met first, then taken over.
    assert_eq!(bucket.proxy.count(&put) - before, todo + 2, "what is left, and the lock");
}

#[test]
fn shards_in_a_store_are_merged_into_the_tree_of_one_run() {
    let Some(bucket) = Bucket::new(20) else { return };
    let log = TestLog::simulated(&nano_spec().with_scenes(3));
    let local = log.beside("local");
    occlabel(&label("nuscenes", text(&log.root()), text(&local))).exits(0);
    bucket.upload(&log.root(), "log");
    let [input, output] = [bucket.url("log"), bucket.url("labels")];
    for shard in ["2/3", "0/3", "1/3"] {
        let line = label("nuscenes", &input, &output);
        bucket.run(&[&line[..], &["--shard", shard]].concat()).exits(0);
    }
    bucket.run(&["merge-manifests", &output]).exits(0);
    assert_eq!(labels(bucket.download("labels")), labels(files_under(&local)));
}

/// A log whose sweeps lie side by side is asked about by pages of the listing, and each file is fetched
/// once.
#[test]
fn a_store_is_asked_about_once_for_each_file_of_a_log() {
    let Some(bucket) = Bucket::new(0) else { return };
    let log = TestLog::simulated(&nano_spec());
    bucket.upload(&log.root(), "log");
    let [input, output] = [bucket.url("log"), text(&log.beside("labels")).to_owned()];
    bucket.run(&label("nuscenes", &input, &output)).exits(0);

    let under = |folder: &str| format!("GET /{}/{folder}/", input.trim_start_matches("s3://"));
    let sweeps = files_under(&log.file("sweeps")).len() + files_under(&log.file("samples")).len();
    let fetched = bucket.proxy.count(&under("sweeps")) + bucket.proxy.count(&under("samples"));
    assert!(sweeps > 5 && fetched <= sweeps, "{fetched} requests for {sweeps} files");
    let looked = bucket.proxy.count("HEAD");
    assert!(looked <= 2, "{looked} files were looked at one by one");
}
