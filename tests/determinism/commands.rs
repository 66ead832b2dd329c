//! What other commands make of labels.

use std::path::Path;

use crate::case::Case;
use crate::support::{Ended, files_under, program, text};

/// What lines have in place of a path and of a number of threads.
const FILE: &str = "FILE";
const THREADS: &str = "THREADS";

/// Runs a line by so many threads; gives its result and what it wrote.
fn run(line: &[&str], threads: &str, folder: &Path) -> (String, Vec<Vec<u8>>) {
    let written = folder.join(threads);
    std::fs::create_dir_all(&written).expect("a folder");
    let file = line.iter().find_map(|arg| arg.strip_prefix(FILE)).unwrap_or_default();
    let place = written.join(format!("made{file}"));
    let line = line.iter().map(|arg| match *arg {
        THREADS => threads,
        arg if arg.starts_with(FILE) => text(&place),
        arg => arg,
    });
    let mut command = program();
    command.args(line).env("RAYON_NUM_THREADS", threads);
    let ended = Ended::of(command.output().expect("the program starts"));
    assert!(matches!(ended.code, Some(0 | 1)), "{ended:?}");
    let files = files_under(&written).into_values().collect();
    std::fs::remove_dir_all(&written).expect("removed");
    (ended.stdout.replace(text(&written), ""), files)
}

#[test]
fn section_12_pictures_pages_and_scores_are_the_same_by_any_number_of_threads() {
    let case = Case::scenes("precise");
    let (one, other) = (case.tree(), case.tree());
    case.label(&one, &[]);
    case.label(&other, &["--set", "states.occupied_min_hits=3"]);
    let (one, other, beside) = (text(&one), text(&other), case.tree());
    let made: [&[&str]; 5] = [
        &["view", one, "--output", "FILE.png"],
        &["view", one, "--picture", "perspective", "--output", "FILE.png"],
        &["view", one, "--output", "FILE.html"],
        &["view", one, "--output", "FILE.glb"],
        &["view", one, "--output", "FILE.mcap"],
    ];
    let by_jobs: [&[&str]; 4] = [
        &["convert", one, "--to", "occ3d-nuscenes", "--output", "FILE"],
        &["compare", one, other, "--json"],
        &["evaluate", "--truth", one, "--prediction", other, "--metrics", "all", "--json"],
        &["report", one, "--output", "FILE.html"],
    ];
    let by_jobs = by_jobs.map(|line| [line, &["--jobs", THREADS]].concat());
    for line in made.into_iter().chain(by_jobs.iter().map(Vec::as_slice)) {
        let by_one = run(line, "1", &beside);
        assert!(!by_one.0.is_empty() || !by_one.1.is_empty(), "{line:?}");
        assert!(run(line, "8", &beside) == by_one, "{line:?}");
    }
}
