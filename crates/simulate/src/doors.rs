//! World files, behind the signature that fuzzing and the tests with damage knock at.

use std::sync::LazyLock;

use occlabel_core::Taxonomy;
use occlabel_testkit::Door;

use crate::{Drive, World, world_text_with};

/// All of them.
pub const DOORS: &[Door] = &[
    Door { name: "world", knock: world, seeds: worlds },
    Door { name: "world_settings", knock: world_settings, seeds: settings },
];

const TINY: &str = include_str!("../tests/tiny.toml");
/// A drive with more shots than this takes too long to be driven here.
const MOST_SHOTS: f64 = 3e3;
/// As many things are moved and asked for here.
const MOST_THINGS: usize = 50;

static TAXONOMY: LazyLock<Taxonomy> = LazyLock::new(|| {
    let text = include_str!("../../../configs/taxonomies/occ3d-nuscenes.toml");
    toml::from_str(text).expect("a sound taxonomy")
});

/// A world's file. What is no large world is driven through, and its first sweep cast.
fn world(bytes: &[u8]) -> bool {
    let Ok(world) = World::parse(&String::from_utf8_lossy(bytes), "") else { return false };
    if !is_small(&world) {
        return true;
    }
    let Ok(drive) = Drive::new(world, &TAXONOMY) else { return false };
    if !drive.scene().sweeps.is_empty() {
        let cloud = drive.points(0);
        assert!(cloud.positions.iter().all(occlabel_core::is_finite));
        assert_eq!(cloud.positions.len(), cloud.labels.len());
    }
    true
}

fn is_small(world: &World) -> bool {
    let shots = |lidar: &crate::lidar::Lidar| {
        let pattern = &lidar.pattern;
        (pattern.shots() * pattern.rings()) as f64 * world.duration_s * lidar.clock.rate_hz()
    };
    let exposures: f64 = world.cameras.iter().map(|it| it.clock.rate_hz() * world.duration_s).sum();
    let keyframes = world.keyframe_hz * world.duration_s;
    world.lidars.iter().map(shots).sum::<f64>() < MOST_SHOTS
        && world.movers.len() + world.static_classes.len() < MOST_THINGS
        && exposures.max(keyframes) < MOST_THINGS as f64
}

/// The tiny world, and a part of it that is driven through in no time.
fn worlds() -> Vec<Vec<u8>> {
    let settings = ["duration_s=0.2", "lidar.0.pattern.spinning.azimuths=12"].map(String::from);
    let text = world_text_with(TINY, &settings).unwrap_or_else(|fault| panic!("{fault}"));
    vec![TINY.into(), text.into()]
}

/// Lines `key=VALUE` laid over the tiny world.
fn world_settings(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let settings: Vec<String> = text.lines().map(str::to_owned).collect();
    world_text_with(TINY, &settings).is_ok_and(|text| World::parse(&text, "").is_ok())
}

fn settings() -> Vec<Vec<u8>> {
    vec![b"duration_s=0.2\nname=other".into()]
}

#[cfg(test)]
mod tests {
    use occlabel_testkit::{knock_with_corpus, knock_with_damage};

    use super::*;

    /// Runs of each reader.
    const CASES: u32 = 200;

    #[test]
    fn damaged_worlds_are_read_or_refused() {
        for (door, [taken, refused]) in DOORS.iter().zip(knock_with_damage(DOORS, CASES)) {
            assert!(refused > CASES / 20, "{}: {taken} taken, {refused} refused", door.name);
        }
    }

    #[test]
    fn what_fuzzing_found_in_worlds_is_read_or_refused() {
        assert!(knock_with_corpus(DOORS) >= DOORS.len());
    }
}
