//! What a store cannot do, and what another does there.

use crate::bucket::Bucket;
use crate::support::{Ended, SMALL, TestLog};

#[test]
fn what_is_not_in_a_store_is_told_in_a_line() {
    let Some(bucket) = Bucket::new(0) else { return };
    for input in [bucket.url("absent"), "s3://no-such-bucket/log".to_owned()] {
        let ended = bucket.run(&["inspect", "--format", "nuscenes", "--input", &input]);
        assert!(
            matches!(ended.code, Some(1 | 2)) && ended.stderr.lines().count() <= 2,
            "{ended:?}"
        );
        ended.tells(&[&input]);
    }
    for url in ["s3://", "s3:///log", "s3://bucket/a/../b", "ftp://host/log", "file://host/log"] {
        let read = ["inspect", "--format", "nuscenes", "--input", url];
        bucket.run(&read).exits(2).tells(&[url, "the URL of a store"]);
        let write = ["label", "--format", "nuscenes", "--input", "log", "--output", url];
        bucket.run(&write).exits(2).tells(&[url, "the URL of a store"]);
    }
    let mut command = bucket.command(&["verify", "s3://bucket/labels"]);
    let ended = Ended::of(command.env("AWS_ENDPOINT_URL", "127.0.0.1:9000").output().unwrap());
    ended.exits(2).tells(&["AWS_ENDPOINT_URL is no URL"]);
    bucket
        .run(&["simulate", "--world", "street", "--format", "nuscenes", "--output", "s3://b/log"])
        .exits(2)
        .tells(&["a folder of this machine"]);
    bucket.run(&["verify", &bucket.url("absent")]).exits(2).tells(&[&bucket.url("absent")]);
}

#[test]
fn fault_39_of_two_writers_in_a_store_the_second_is_refused() {
    let Some(bucket) = Bucket::new(0) else { return };
    let log = TestLog::nano();
    let (input, output) = (log.root(), bucket.url("labels"));
    let input = input.to_str().unwrap();
    let line = ["label", "--format", "nuscenes", "--input", input, "--output", &output];
    let line = [&line[..], &SMALL].concat();
    bucket.put("labels/.run.lock", std::process::id().to_string().as_bytes());
    bucket.run(&line).exits(1).tells(&[".run.lock", "no other writer"]);
    bucket.put("labels/.run.lock", b"4294967295\n");
    bucket.run(&line).exits(0);
    assert!(!bucket.download("labels").contains_key(".run.lock"));
}

#[test]
fn a_sweep_that_is_missing_from_a_store_is_told_by_its_name() {
    let Some(bucket) = Bucket::new(0) else { return };
    let log = TestLog::nano();
    let gone = log.rows("sample_data")[0]["filename"].as_str().unwrap().to_owned();
    std::fs::remove_file(log.file(&gone)).unwrap();
    bucket.upload(&log.root(), "log");
    let output = log.beside("labels");
    let line = ["label", "--format", "nuscenes", "--input", &bucket.url("log")].map(str::to_owned);
    let line: Vec<&str> = line.iter().map(String::as_str).collect();
    let ended = bucket.run(&[&line[..], &["--output", output.to_str().unwrap()]].concat());
    ended.exits(1).tells(&[&gone, "found none"]);
}
