//! Logs with bytes changed, cut or doubled: a fault or a scene, never a panic.

use std::cell::Cell;
use std::fs;

use occlabel_logs::SceneSource;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use crate::log::{load, open, tiny};

const FILES: [&str; 5] =
    ["calib.txt", "poses.txt", "times.txt", "velodyne/000000.bin", "labels/000000.label"];
const CASES: u32 = 200;

#[derive(Clone, Debug)]
enum Change {
    Set(u8),
    Cut,
    Double,
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        8 => any::<u8>().prop_map(Change::Set),
        1 => Just(Change::Cut),
        1 => Just(Change::Double),
    ]
}

fn apply(bytes: &mut Vec<u8>, at: usize, change: Change) {
    let at = at % bytes.len();
    match change {
        Change::Set(byte) => bytes[at] = byte,
        Change::Cut => bytes.truncate(at),
        Change::Double => bytes.extend_from_within(at..),
    }
}

#[test]
fn bent_logs_are_read_or_refused() {
    let (sound, refused) = (Cell::new(0), Cell::new(0));
    let mut runner =
        TestRunner::new(Config { failure_persistence: None, ..Config::with_cases(CASES) });
    let bent = (0..FILES.len(), any::<usize>(), change());
    let outcome = runner.run(&bent, |(file, at, change)| {
        let root = tiny();
        let path = root.path().join("sequences/00").join(FILES[file]);
        let mut bytes = fs::read(&path).unwrap();
        apply(&mut bytes, at, change);
        fs::write(&path, bytes).unwrap();
        let read = load(&root).is_ok_and(|scene| {
            let log = open(&root);
            scene.refused.is_empty()
                && scene.sweeps.iter().all(|sweep| log.read_sweep(sweep).is_ok())
        });
        let count = if read { &sound } else { &refused };
        count.set(count.get() + 1);
        Ok(())
    });
    outcome.unwrap();
    assert_eq!(sound.get() + refused.get(), CASES);
    assert!(sound.get() > 20 && refused.get() > 50, "{sound:?} {refused:?}");
}
