//! Processes that write into one folder.

use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};

use crate::is_all;
use crate::line::{Line, log_of};
use crate::support::{Ended, Label, SCENE, TestLog, files_under, occlabel, text};

fn start(label: &Label) -> Child {
    label.command().stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("started")
}

fn end(child: Child) -> (u32, Ended) {
    (child.id(), Ended::of(child.wait_with_output().expect("an end")))
}

fn small(log: &TestLog, output: &Path) -> Label {
    Label::new(&log.root(), output).small().with(&["--jobs", "1"])
}

#[test]
fn fault_39_of_two_that_start_at_once_one_is_refused_by_the_others_process() {
    let log = log_of(1);
    let line = Line::label(&log, &["--jobs", "1"]);
    let (rounds, mut refused) = (if is_all() { 50 } else { 5 }, 0);
    for round in 0..rounds {
        let output = log.beside(&format!("out-{round}"));
        let [one, other] = [(); 2].map(|()| start(&small(&log, &output)));
        let [one, other] = [one, other].map(end);
        for ((_, ended), (winner, _)) in [(&one, &other), (&other, &one)] {
            if ended.code != Some(0) {
                refused += 1;
                assert_eq!(ended.code, Some(1), "{ended:?}");
                assert!(ended.stderr.contains(&format!("process {winner} ")), "{ended:?}");
            }
        }
        assert!(one.1.code == Some(0) || other.1.code == Some(0), "{one:?} {other:?}");
        line.is_as_undisturbed(&output, "two at once");
        line.ends_as_undisturbed(&output, "two at once");
    }
    println!("{refused} of {rounds} refused");
    assert!(refused > 0, "no two met");
}

#[test]
fn shards_side_by_side_are_merged_into_an_undivided_run() {
    let log = log_of(3);
    let whole = Line::label(&log, &["--evidence", "--jobs", "1"]);
    let rounds = if is_all() { 10 } else { 1 };
    for round in 0..rounds {
        let output = log.beside(&format!("shared-{round}"));
        let shard = |shard| small(&log, &output).with(&["--evidence", "--shard", shard]);
        let shards = ["0/3", "1/3", "2/3"].map(|name| start(&shard(name)));
        for child in shards {
            end(child).1.exits(0);
        }
        occlabel(&["merge-manifests", text(&output)]).exits(0);
        whole.is_as_undisturbed(&output, "shards");
        occlabel(&["verify", text(&output)]).exits(0);
        assert!(files_under(&output).keys().eq(whole.expected.keys()));
    }
}

/// Ids of processes are used again: the lock of one that is gone names a process that runs, but began
/// at another time.
#[cfg(target_os = "linux")]
#[test]
fn fault_39_a_lock_by_an_id_that_another_process_has_now_is_taken_over() {
    let log = log_of(1);
    let line = Line::label(&log, &["--jobs", "1"]);
    for lock in [".run.lock".to_owned(), format!("gts/{SCENE}/.lock")] {
        let output = log.beside("reused");
        line.prepare(&output);
        let path = output.join(lock);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        let id = std::process::id();
        fs::write(&path, format!("{id}\n")).expect("written");
        small(&log, &output).run().exits(1).tells(&["lock", &format!("process {id} ")]);
        fs::write(&path, format!("{id} 1\n")).expect("written");
        line.ends_as_undisturbed(&output, "an id used again");
    }
}
