//! Random damage: never a panic, and never more than the image's size believed.

use occlabel_core::Fault;
use occlabel_logs::{SceneSource, WaymoLog};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use crate::log::{folder_of, frames, options};
use crate::message::{edit, recompressed, record};

/// Runs the same cases every time, so that their outcomes can be counted.
pub(crate) fn runner(cases: u32) -> TestRunner {
    let config = Config { failure_persistence: None, ..Config::with_cases(cases) };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}

/// A byte of a whole, as a share, and what it becomes.
fn damage() -> impl Strategy<Value = (f64, u8)> {
    (0.0..1.0, any::<u8>())
}

fn damaged(bytes: &[u8], damage: &[(f64, u8)]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (share, byte) in damage {
        let place = (share * bytes.len() as f64) as usize;
        bytes[place] = *byte;
    }
    bytes
}

/// Reads all that can be read; how many sweeps that were, or why none.
fn read_all(file: &[u8]) -> Result<usize, Fault> {
    let root = folder_of(file);
    let log = WaymoLog::open(root.path(), options())?;
    let mut sweeps = 0;
    for name in log.scene_names() {
        let Ok(scene) = log.load(&name) else { continue };
        sweeps += scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count();
    }
    Ok(sweeps)
}

/// Runs cases of damage; how many left nothing, some, and all of a frame's five sweeps.
fn outcomes(cases: u32, damage_to: impl Fn(&[(f64, u8)]) -> Vec<u8>) -> [usize; 3] {
    let counts = std::cell::RefCell::new([0; 3]);
    let mut runner = runner(cases);
    let strategy = prop::collection::vec(damage(), 1..6);
    let run = runner.run(&strategy, |damage| {
        let place = match read_all(&damage_to(&damage)) {
            Ok(5) => 2,
            Ok(1..5) => 1,
            _ => 0,
        };
        counts.borrow_mut()[place] += 1;
        Ok(())
    });
    run.unwrap();
    counts.into_inner()
}

#[test]
fn a_damaged_file_never_gives_a_sweep_and_never_a_panic() {
    let file = record(&frames()[0]);
    let found = outcomes(200, |damage| damaged(&file, damage));
    assert_eq!(found.iter().sum::<usize>(), 200);
    // A byte may become what it was.
    assert!(found[0] >= 190, "{found:?}");
}

#[test]
fn a_damaged_frame_with_right_checksums_is_refused_or_read_but_never_a_panic() {
    let found = outcomes(400, |damage| record(&damaged(&frames()[0], damage)));
    assert_eq!(found.iter().sum::<usize>(), 400);
    assert!(found.iter().all(|count| *count > 5), "{found:?}");
}

#[test]
fn damage_outside_the_images_reaches_every_field() {
    // The context alone: lengths, numbers, names of sensors.
    let found = outcomes(300, |damage| {
        record(&edit(&frames()[0], &[(1, 0)], &mut |context| damaged(context, damage)))
    });
    assert_eq!(found.iter().sum::<usize>(), 300);
    assert!(found[0] > 50 && found[2] > 50, "{found:?}");
}

#[test]
fn damage_behind_zlib_is_refused_or_read_but_never_a_panic() {
    for field in [2, 4, 6] {
        let path = [(5, 0), (2, 0), (field, 0)];
        let found = outcomes(100, |damage| {
            let mut change =
                |bytes: &[u8]| recompressed(bytes, |plain| tail_damaged(&plain, damage));
            record(&edit(&frames()[0], &path, &mut change))
        });
        assert_eq!(found.iter().sum::<usize>(), 100);
        assert!(found[1] > 20, "{found:?}");
    }
}

/// Damage to the last 12 bytes, which hold the shape, and to the head of the values.
fn tail_damaged(plain: &[u8], damage: &[(f64, u8)]) -> Vec<u8> {
    let (values, shape) = plain.split_at(plain.len() - 12);
    let (head, rest) = values.split_at(4);
    [damaged(head, &damage[1..]), rest.to_vec(), damaged(shape, damage)].concat()
}
