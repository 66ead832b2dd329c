//! Symbolic links (case 37).

use std::fs;
use std::os::unix::fs::symlink;

use crate::asserts::{assert_refused, label, untouched};
use crate::support::{Label, SCENE, TestLog, VERSION, gts_files};

#[test]
fn fault_37_a_linked_root_and_linked_blobs_are_followed() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    for folder in ["samples", "sweeps/LIDAR_TOP", VERSION] {
        let moved = log.beside(&folder.replace('/', "-"));
        fs::rename(log.file(folder), &moved).expect("moved");
        symlink(&moved, log.file(folder)).expect("a link");
    }
    let file = log.other_files()[0].clone();
    fs::rename(log.file(&file), log.beside("sweep.bin")).expect("moved");
    symlink(log.beside("sweep.bin"), log.file(&file)).expect("a link");
    symlink(log.root(), log.beside("link")).expect("a link");
    let label = Label::new(&log.beside("link"), &log.beside("out")).small().with(&["--evidence"]);
    label.run().exits(0);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
}

#[test]
fn fault_37_a_loop_of_links_is_told() {
    let log = TestLog::nano();
    let file = log.other_files()[0].clone();
    log.remove(&file);
    symlink(log.file(&file), log.file(&file)).expect("a link");
    assert_refused(&label(&log), &[&file]);
}

#[test]
fn fault_37_an_output_folder_may_be_a_link() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    fs::create_dir_all(log.beside("disk/gts")).expect("a folder");
    symlink(log.beside("disk"), log.beside("out")).expect("a link");
    label(&log).run().exits(0);
    assert!(gts_files(&log.beside("disk")) == gts_files(&clean.output));
    assert!(log.beside("out").is_symlink());
}

#[test]
fn fault_37_an_output_file_may_not_be_a_link() {
    let log = TestLog::nano();
    let victim = log.beside("victim");
    fs::write(&victim, "mine").expect("written");
    let folder = log.beside(&format!("out/gts/{SCENE}/{}", log.keyframes()[1]));
    fs::create_dir_all(&folder).expect("a folder");
    symlink(&victim, folder.join("labels.npz")).expect("a link");
    label(&log).run().exits(1).tells(&["labels.npz", "a symbolic link"]);
    assert_eq!(fs::read(&victim).expect("still there"), b"mine");
    assert!(!log.beside("out/manifest.json").exists());
}

#[test]
fn fault_37_nothing_is_written_through_a_link_in_place_of_a_record() {
    for name in ["run.json", "journal.jsonl", "manifest.json", "report.json"] {
        let log = TestLog::nano();
        let victim = log.beside("victim");
        fs::create_dir_all(log.beside("out")).expect("a folder");
        symlink(&victim, log.beside("out").join(name)).expect("a link");
        label(&log).run().exits(1).tells(&[name, "a symbolic link"]);
        assert!(!victim.exists(), "{name}");
    }
}
