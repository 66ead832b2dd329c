//! A bound on memory.

use crate::labelled::labelled;
use crate::support::{Label, SCENE, TestLog, tree_hash};

/// The bytes that one keyframe at a time needs, as the program tells them.
fn bytes_needed(label: &Label) -> String {
    let ended = label.clone().with(&["--memory", "1kB"]).run().exits(1);
    let (_, rest) = ended.stderr.split_once("found ").expect("what was found");
    rest.split(' ').next().expect("a number").to_owned()
}

#[test]
fn too_little_memory_fails_before_any_work_and_says_what_is_needed() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small();
    label.clone().with(&["--memory", "1kB"]).run().exits(1).tells(&[
        SCENE,
        "1000 bytes",
        "--memory",
    ]);
    let needed: u64 = bytes_needed(&label).parse().expect("a number");
    label.clone().with(&["--memory", &(needed - 1).to_string()]).run().exits(1);
    assert!(!label.output.exists());
}

#[test]
fn one_keyframe_at_a_time_gives_the_same_bytes() {
    let (log, free) = labelled(&["--jobs", "3"]);
    let bound = Label::new(&log.root(), &log.beside("bound")).small().with(&["--jobs", "3"]);
    let bytes = bytes_needed(&bound);
    bound.clone().with(&["--memory", &bytes]).run().exits(0);
    assert_eq!(tree_hash(&bound.output), tree_hash(&free.output));
}
