//! Label trees in a store, and what reads them.

use std::collections::BTreeMap;
use std::path::Path;

use crate::bucket::Bucket;
use crate::server::Server;
use crate::support::{Label, TestLog, files_under, occlabel, text};

/// A log, labelled on a disk, and the same tree in a bucket.
fn labelled(faults_in_100: u64) -> Option<(TestLog, String, Bucket)> {
    let bucket = Bucket::new(faults_in_100)?;
    let log = TestLog::nano();
    let local = log.beside("labels");
    Label::new(&log.root(), &local).small().run().exits(0);
    bucket.upload(&local, "labels");
    Some((log, text(&local).to_owned(), bucket))
}

#[test]
fn a_tree_in_a_store_is_verified_compared_described_and_shown() {
    let Some((log, local, bucket)) = labelled(10) else { return };
    let stored = bucket.url("labels");
    bucket.run(&["verify", &stored]).exits(0);
    bucket.run(&["compare", &stored, &local]).exits(0);
    let told = bucket.run(&["describe", &stored]).exits(0).stdout;
    assert_eq!(told.replace(&stored, &local), occlabel(&["describe", &local]).exits(0).stdout);
    for file in ["sheet.png", "labels.html", "labels.glb", "report.html"] {
        let command = if file.starts_with("report") { "report" } else { "view" };
        let here = log.beside(file);
        occlabel(&[command, &local, "--output", text(&here)]).exits(0);
        bucket.run(&[command, &stored, "--output", &bucket.url(&format!("shown/{file}"))]).exits(0);
        let put = &bucket.download("shown")[file];
        assert!(*put == std::fs::read(&here).unwrap(), "{file} differs");
    }
}

#[test]
fn what_was_flipped_added_or_lost_in_a_store_is_found() {
    let Some((_log, local, bucket)) = labelled(0) else { return };
    let files = files_under(Path::new(&local));
    let (name, bytes) = files.iter().find(|(name, _)| name.ends_with("labels.npz")).unwrap();
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    bucket.put(&format!("labels/{name}"), &flipped);
    bucket.put("labels/gts/stray.txt", b"x");
    let told = bucket.run(&["verify", &bucket.url("labels")]).exits(1).stdout;
    assert!(told.contains(name) && told.contains("stray.txt"), "{told}");
}

#[test]
fn a_tree_is_converted_from_one_store_folder_to_another() {
    let Some((log, local, bucket)) = labelled(10) else { return };
    let here = log.beside("converted");
    let to = ["--to", "surroundocc", "--output"];
    occlabel(&[&["convert", &local][..], &to, &[text(&here)]].concat()).exits(0);
    let (stored, there) = (bucket.url("labels"), bucket.url("converted"));
    bucket.run(&[&["convert", &stored][..], &to, &[&there]].concat()).exits(0);
    let but_report = |mut files: BTreeMap<String, Vec<u8>>| {
        files.remove("report.json");
        files
    };
    assert!(but_report(bucket.download("converted")) == but_report(files_under(&here)));
}

#[test]
fn a_log_on_a_server_of_webdav_is_labelled_and_so_is_one_by_its_files_url() {
    let log = TestLog::nano();
    let local = log.beside("labels");
    Label::new(&log.root(), &local).small().run().exits(0);
    let same = |output: &Path| {
        let manifest = |tree: &Path| files_under(tree)["manifest.json"].clone();
        assert_eq!(manifest(output), manifest(&local));
    };
    let (from, to) = (format!("file://{}", text(&log.root())), log.beside("by-url"));
    Label::new(Path::new(&from), Path::new(&format!("file://{}", text(&to))))
        .small()
        .run()
        .exits(0);
    same(&to);

    let root = log.root();
    let Some(server) = Server::start("dav_server.py", &[text(root.parent().unwrap())]) else {
        return;
    };
    let (from, to) = (format!("http://127.0.0.1:{}/log", server.port), log.beside("by-http"));
    Label::new(Path::new(&from), &to).small().run().exits(0);
    same(&to);
}
