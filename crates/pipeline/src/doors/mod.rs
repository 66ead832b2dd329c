//! What of the pipeline meets anything from outside, behind one signature: texts of configurations,
//! and, as numbers out of bytes, the grids, rays, cameras, tracks and scenes that its stages take.
//! What fuzzing and the tests with damage knock at.

mod bytes;
mod cameras;
mod grids;
mod rules;
mod scenes;
mod texts;
mod tracks;
mod walks;

use occlabel_testkit::Door;

/// Parsers of texts.
pub const TEXTS: &[Door] = &[
    Door { name: "config", knock: texts::config, seeds: texts::configs },
    Door { name: "taxonomy", knock: texts::taxonomy, seeds: texts::taxonomies },
];

/// Geometry: what is taken has to work, and what it gives has to make sense.
pub const GEOMETRY: &[Door] = &[
    Door { name: "grid", knock: grids::grid, seeds: grids::grids },
    Door { name: "walk", knock: walks::walk_both_ways, seeds: some_bytes },
    Door { name: "camera", knock: cameras::camera, seeds: cameras::cameras },
    Door { name: "track", knock: tracks::track, seeds: some_bytes },
    Door { name: "scene", knock: scenes::scene, seeds: scenes::scenes },
];

/// Bytes of no meaning.
fn some_bytes() -> Vec<Vec<u8>> {
    let noise = |seed: u32| (0..96_u32).map(|at| (seed + at * at * 7) as u8).collect();
    vec![noise(3), noise(77)]
}

#[cfg(test)]
mod tests {
    use occlabel_testkit::{knock_with_corpus, knock_with_damage};

    use super::*;

    #[test]
    fn damaged_texts_are_read_or_refused() {
        for (door, [taken, refused]) in TEXTS.iter().zip(knock_with_damage(TEXTS, 300)) {
            assert!(refused > 15, "{}: {taken} taken, {refused} refused", door.name);
        }
    }

    #[test]
    fn any_geometry_that_is_taken_works() {
        for (door, [taken, _]) in GEOMETRY.iter().zip(knock_with_damage(GEOMETRY, 300)) {
            assert!(taken > 100, "{}: {taken} taken", door.name);
        }
    }

    #[test]
    fn what_fuzzing_found_works_or_is_refused() {
        assert!(knock_with_corpus(TEXTS) >= TEXTS.len());
        assert!(knock_with_corpus(GEOMETRY) >= GEOMETRY.len());
    }
}
