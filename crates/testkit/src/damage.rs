//! Random damage to sound input of every door: read or refused, but never a panic, never long.

use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use crate::Door;

/// No run is longer; a hundredth of it is usual.
const LONGEST: Duration = Duration::from_secs(2);

/// Knocks at every door with its seeds, and with so many damaged ones: how many of these were taken,
/// and how many refused, door by door.
///
/// # Panics
/// If a seed is refused, a door panics, or takes longer than two seconds.
pub fn knock_with_damage(doors: &[Door], cases: u32) -> Vec<[u32; 2]> {
    let knock = |door: &Door| {
        let seeds = (door.seeds)();
        let strange = seeds.iter().position(|seed| !(door.knock)(seed));
        assert_eq!(strange, None, "a seed of {}", door.name);
        let [taken, refused] = damaged(door, &seeds, cases);
        assert_eq!(taken + refused, cases);
        println!("{}: {taken} taken, {refused} refused", door.name);
        [taken, refused]
    };
    doors.iter().map(knock).collect()
}

/// What happens to the bytes at a share of their length.
#[derive(Clone, Debug)]
enum Damage {
    Flip(u8),
    Set(u8),
    /// A giant number, or -1.
    Giant(u8),
    Cut,
    /// What follows stands there twice.
    Double,
    /// Bytes of another place.
    Splice(f64),
}

fn damage() -> impl Strategy<Value = (f64, Damage)> {
    let kind = prop_oneof![
        4 => (0_u8..8).prop_map(Damage::Flip),
        3 => any::<u8>().prop_map(Damage::Set),
        3 => prop_oneof![Just(0x7f_u8), Just(0xff), Just(0)].prop_map(Damage::Giant),
        1 => Just(Damage::Cut),
        1 => Just(Damage::Double),
        2 => (0.0..1.0).prop_map(Damage::Splice),
    ];
    (0.0..1.0, kind)
}

fn apply(bytes: &mut Vec<u8>, share: f64, damage: &Damage) {
    let place = |share: f64, length: usize| (share * length as f64) as usize;
    if bytes.is_empty() {
        return;
    }
    let at = place(share, bytes.len());
    let end = (at + 8).min(bytes.len());
    match damage {
        Damage::Flip(bit) => bytes[at] ^= 1 << bit,
        Damage::Set(byte) => bytes[at] = *byte,
        Damage::Giant(byte) => bytes[at..end].fill(*byte),
        Damage::Cut => bytes.truncate(at),
        Damage::Double => bytes.extend_from_within(at..),
        Damage::Splice(from) => {
            let from = place(*from, bytes.len()).min(bytes.len() - (end - at));
            bytes.copy_within(from..from + end - at, at);
        }
    }
}

/// How many damaged inputs a door took, and refused.
fn damaged(door: &Door, seeds: &[Vec<u8>], cases: u32) -> [u32; 2] {
    let counts = std::cell::RefCell::new([0; 2]);
    let config = Config { failure_persistence: None, ..Config::with_cases(cases) };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let inputs = (0..seeds.len(), prop::collection::vec(damage(), 1..4));
    let run = TestRunner::new_with_rng(config, rng).run(&inputs, |(seed, damages)| {
        let mut bytes = seeds[seed].clone();
        damages.iter().for_each(|(share, damage)| apply(&mut bytes, *share, damage));
        let begun = Instant::now();
        let is_refused = !(door.knock)(&bytes);
        prop_assert!(begun.elapsed() < LONGEST, "{:?}", begun.elapsed());
        counts.borrow_mut()[usize::from(is_refused)] += 1;
        Ok(())
    });
    run.unwrap_or_else(|error| panic!("{}: {error}", door.name));
    counts.into_inner()
}
