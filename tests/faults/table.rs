//! `docs/reliability.md` against the sources: each case of bad input has its row, each row its tests,
//! and what is named there exists.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Bad inputs and faults are numbered from 1 to this.
const CASES: usize = 40;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn page() -> String {
    fs::read_to_string(root().join("docs/reliability.md")).expect("the page")
}

/// The cells of each row of the table of bad inputs.
fn rows(page: &str) -> Vec<Vec<&str>> {
    let (_, table) = page.split_once("| case | input | gets | tests |").expect("the table");
    let lines = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    lines.map(|line| line.trim_matches('|').split('|').map(str::trim).collect()).collect()
}

/// The texts between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// The tests that stand in rows: of those with a number by it, of the others by 0.
fn named(page: &str) -> BTreeMap<usize, BTreeSet<&str>> {
    let rows = rows(page).into_iter().map(|cells| {
        let [case, _, _, tests] = cells[..] else { panic!("four cells, not {cells:?}") };
        (case.parse().unwrap_or(0), quoted(tests).collect())
    });
    rows.collect()
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let sources = |path: PathBuf| if path.is_dir() { sources(&path) } else { vec![path] };
    let all = paths.flat_map(sources);
    all.filter(|path| path.extension().is_some_and(|ending| ending == "rs")).collect()
}

/// The names of a file's tests.
fn tests_of(source: &str) -> Vec<String> {
    let (mut tests, mut is_test) = (Vec::new(), false);
    for line in source.lines().map(str::trim) {
        let name = line.strip_prefix("fn ").and_then(|rest| rest.split_once('('));
        is_test |= line == "#[test]";
        if let (true, Some((name, _))) = (is_test, name) {
            tests.push(name.to_owned());
            is_test = false;
        }
    }
    tests
}

fn all_tests() -> BTreeSet<String> {
    let files = ["crates", "src", "tests"].into_iter().flat_map(|name| sources(&root().join(name)));
    files.flat_map(|file| tests_of(&fs::read_to_string(file).expect("a source"))).collect()
}

/// The cases that a test's name begins with: `fault_38_39_…`, `fault_06_fault_08_…`.
fn cases_of(test: &str) -> Vec<usize> {
    let is_number = |word: &&str| *word == "fault" || word.parse::<usize>().is_ok();
    let words = test.split('_').take_while(is_number);
    let numbers: Vec<usize> = words.filter_map(|word| word.parse().ok()).collect();
    if test.starts_with("fault_") { numbers } else { Vec::new() }
}

#[test]
fn every_case_has_one_row() {
    let page = page();
    let cases = rows(&page).into_iter().filter_map(|cells| cells[0].parse().ok());
    assert_eq!(cases.collect::<Vec<usize>>(), (1..=CASES).collect::<Vec<_>>());
}

#[test]
fn every_test_that_a_row_names_exists() {
    let (page, tests) = (page(), all_tests());
    for (case, named) in named(&page) {
        assert!(!named.is_empty() || case == 0, "case {case} has no test");
        let absent: Vec<_> = named.iter().filter(|name| !tests.contains(**name)).collect();
        assert!(absent.is_empty(), "case {case}: {absent:?}");
    }
}

#[test]
fn every_test_of_a_case_stands_in_its_row() {
    let (page, tests) = (page(), all_tests());
    let (named, mut counted) = (named(&page), 0);
    for test in &tests {
        for case in cases_of(test) {
            let is_named = named.get(&case).is_some_and(|tests| tests.contains(test.as_str()));
            assert!(is_named, "docs/reliability.md, case {case}: `{test}`");
            counted += 1;
        }
    }
    assert!(counted > 200, "{counted} tests of cases");
}

#[test]
fn every_file_that_the_page_names_exists() {
    let page = page();
    let files: Vec<_> = quoted(&page).filter(|name| name.ends_with(".rs")).collect();
    let absent: Vec<_> = files.iter().filter(|file| !root().join(file).exists()).collect();
    assert!(absent.is_empty() && files.len() > 5, "{absent:?} of {}", files.len());
}
