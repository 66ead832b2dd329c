//! Disks that are full or may not be written, and files that may not grow.
//!
//! The disk is a tmpfs of some KiB, which takes rights that are had in a namespace of one's own: there
//! the test runs a part of itself. Where no namespace can be had, it says so and is passed over.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::line::{Line, log_of};
use crate::support::{Ended, text};
use crate::{is_all, promises};

/// Names the folder to mount on, for the part that runs in a namespace.
const MOUNT_POINT: &str = "OCCLABEL_TEST_MOUNT_POINT";

/// Runs a test of this program, one that is ignored otherwise, where file systems may be mounted.
fn run_in_namespace(test: &str) {
    let probe = Command::new("unshare").args(["-rm", "true"]).output();
    if !probe.is_ok_and(|probe| probe.status.success()) {
        println!("skipped: no namespace of mounts can be had here");
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = std::env::current_exe().expect("this program");
    let line = ["-rm", text(&program), "--exact", test, "--ignored", "--nocapture"];
    let inside = Command::new("unshare").args(line).env(MOUNT_POINT, folder.path()).output();
    let inside = Ended::of(inside.expect("unshare starts"));
    println!("{}", inside.stdout);
    assert!(inside.code == Some(0) && inside.stdout.contains("1 passed"), "{inside:?}");
}

/// The folder to mount on; none if the test is not run in a namespace of its own.
fn mount_point() -> Option<PathBuf> {
    std::env::var_os(MOUNT_POINT).map(PathBuf::from)
}

fn mount(options: &str, place: &Path) {
    let line = ["-t", "tmpfs", "-o", options, "tmpfs", text(place)];
    let mounted = Command::new("mount").args(line).status();
    assert!(mounted.expect("mount starts").success(), "{options}");
}

fn unmount(place: &Path) {
    assert!(Command::new("umount").arg(place).status().expect("umount starts").success());
}

#[test]
fn fault_38_a_full_disk_ends_the_run_and_room_ends_it_well() {
    run_in_namespace("full_disk::on_full_disks");
}

#[test]
fn fault_38_a_disk_that_may_not_be_written_is_told() {
    run_in_namespace("full_disk::on_a_read_only_disk");
}

#[test]
#[ignore = "run by another test, in a namespace of its own"]
fn on_full_disks() {
    let Some(place) = mount_point() else { return };
    let log = log_of(1);
    let line = Line::label(&log, &["--evidence", "--jobs", "2"]);
    let (mut full, step) = (0, if is_all() { 1 } else { 5 });
    for pages in (1..200).step_by(step) {
        mount(&format!("size={}k", 4 * pages), &place);
        let output = place.join("out");
        let ended = line.run(&output, None);
        if ended.code == Some(0) {
            unmount(&place);
            break;
        }
        full += 1;
        let why = format!("{pages} pages");
        let place_and_bytes = [text(&output), "bytes", "No space left"];
        let ended = ended.exits(1);
        let told = ended.stderr.contains("create") || ended.stderr.contains("folder");
        if !told {
            ended.tells(&place_and_bytes).tells(&["make room"]);
        }
        promises::check(&line, &output, &why);
        mount("remount,size=64m", &place);
        line.ends_as_undisturbed(&output, &why);
        unmount(&place);
    }
    println!("{full} disks were too small");
    assert!(full >= 3, "{full}");
}

#[test]
#[ignore = "run by another test, in a namespace of its own"]
fn on_a_read_only_disk() {
    let Some(place) = mount_point() else { return };
    let log = log_of(1);
    let line = Line::label(&log, &[]);
    mount("size=64m", &place);
    let output = place.join("out");
    std::fs::create_dir(&output).expect("a folder");
    mount("remount,ro", &place);
    line.run(&output, None).exits(1).tells(&[text(&output), "Read-only"]).tells(&["--output"]);
    mount("remount,rw,size=64m", &place);
    line.ends_as_undisturbed(&output, "read-only");
}

/// `ulimit -f`: the system ends a process whose file would grow beyond it, in the middle of a write.
#[test]
fn fault_38_a_file_that_may_not_grow_loses_nothing() {
    let log = log_of(1);
    let line = Line::label(&log, &["--evidence", "--jobs", "1"]);
    let (output, step) = (log.beside("limited"), if is_all() { 1 } else { 7 });
    let mut ended_so = 0;
    for blocks in (0..400).step_by(step) {
        line.prepare(&output);
        let why = format!("{blocks} blocks");
        let command = line.command(&output);
        let mut limited = Command::new("sh");
        limited.args(["-c", &format!("ulimit -f {blocks}; exec \"$@\""), "sh"]);
        limited.arg(command.get_program()).args(command.get_args());
        let ended = Ended::of(limited.output().expect("sh starts"));
        promises::check(&line, &output, &why);
        if ended.code == Some(0) {
            break;
        }
        ended_so += 1;
        line.ends_as_undisturbed(&output, &why);
    }
    println!("{ended_so} runs were ended by the limit");
    assert!(ended_so >= 2, "{ended_so}");
}
