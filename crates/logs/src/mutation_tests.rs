//! Damaged input of every parser.

use occlabel_testkit::{knock_with_corpus, knock_with_damage};

use crate::doors::DOORS;

/// Runs of each parser.
const CASES: u32 = 400;

#[test]
fn fault_34_damaged_input_of_every_parser_is_read_or_refused() {
    for (door, [taken, refused]) in DOORS.iter().zip(knock_with_damage(DOORS, CASES)) {
        assert!(refused > CASES / 20, "{}: {taken} taken, {refused} refused", door.name);
    }
}

#[test]
fn fault_34_what_fuzzing_found_is_read_or_refused() {
    assert!(knock_with_corpus(DOORS) >= DOORS.len());
}
