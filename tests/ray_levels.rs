//! The kernels on exactly known worlds: on every instruction set of this processor they count what
//! section 8 of labels.md says, told here ray by ray and voxel by voxel, and find the voxels of points.

mod ray_oracle;

use std::convert::Infallible;

use nalgebra::Point3;
use occlabel_aggregate::{Moment, TrackBox, compose};
use occlabel_core::{
    AggregatedScene, BUNDLE, ClassId, GridSpec, Instant, Kernel, Keyframe, LIDAR_ORIGIN, Level,
    RayCounts, RigidMap, SweepHeader,
};
use occlabel_pipeline::{
    Autos, Config, Rules, aggregate_scene, parse_taxonomy, preset, shipped_taxonomy, standing_at,
};
use occlabel_raycast::{Casting, Crossings, count};
use occlabel_simulate::{Drive, World, shipped_world, world_text_with};
use ray_oracle::{Oracle, Tally};

/// Drives of two seconds, with as many rays as the test has time for.
const COARSE: [&str; 2] = ["duration_s=2.05", "lidar.*.pattern.spinning.azimuths=60"];
const THIN: [&str; 2] = ["duration_s=2.05", "lidar.*.pattern.rosette.shots=1000"];

#[test]
fn section_8_every_level_counts_as_the_oracle_does_on_the_street() {
    let tally = tally_of("street", &[]);
    tally.assert_of(2 * 5);
}

#[test]
fn section_8_every_level_counts_as_the_oracle_does_on_the_crossing() {
    let tally = tally_of("crossing", &COARSE);
    tally.assert_of(2 * 5);
}

#[test]
fn section_8_every_level_counts_as_the_oracle_does_on_the_campus() {
    let tally = tally_of("campus", &THIN);
    tally.assert_of(2 * 5);
}

/// The voxels of points, as `voxelize` finds them.
struct Flats<'a> {
    positions: &'a [Point3<f64>],
    place: &'a RigidMap,
    spec: &'a GridSpec,
}

impl Kernel for Flats<'_> {
    type Output = Vec<Option<usize>>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let mut flats = Vec::with_capacity(self.positions.len());
        for bundle in self.positions.chunks(BUNDLE) {
            flats.extend_from_slice(&self.spec.flats_of(self.place, bundle)[..bundle.len()]);
        }
        flats
    }
}

#[test]
fn section_7_every_level_finds_the_voxels_that_one_point_after_the_other_gives() {
    let drive = drive("street", &COARSE);
    let rules = rules(&drive, "precise");
    let (aggregated, spec) = (aggregated(&drive, &rules), &rules.spec);
    let mut inside = 0;
    for keyframe in &drive.scene().keyframes {
        let place =
            &RigidMap::from(&instant(&drive, &aggregated, keyframe, &rules).grid_from_world);
        for positions in aggregated.background.iter().map(|sweep| &sweep.cloud.positions) {
            let one_by_one = positions.iter().map(|point| spec.flat_of(&place.apply(point)));
            let expected: Vec<_> = one_by_one.collect();
            inside += expected.iter().flatten().count();
            for level in Level::all() {
                assert!(level.run(Flats { positions, place, spec }) == expected, "{level:?}");
            }
        }
    }
    assert!(inside > 10_000, "{inside} points inside");
}

/// All keyframes of a world, by the rules of two presets.
fn tally_of(world: &str, settings: &[&str]) -> Tally {
    let drive = drive(world, settings);
    let mut tally = Tally::default();
    for preset in ["precise", "occ3d-nuscenes"] {
        let rules = rules(&drive, preset);
        let aggregated = aggregated(&drive, &rules);
        for keyframe in &drive.scene().keyframes {
            compare(&instant(&drive, &aggregated, keyframe, &rules), &rules, &mut tally);
        }
    }
    println!("{world}: {tally:#?}");
    tally
}

/// Compares every kernel at every level with the oracle.
fn compare(instant: &Instant, rules: &Rules, tally: &mut Tally) {
    let expected = Oracle::count(instant, rules, tally);
    for level in Level::all() {
        for crossings in [Crossings::HowMany, Crossings::Whether] {
            let casting = Casting { level, ..Casting::new(crossings, 2) };
            let found = count(instant, &rules.spec, &rules.rays(), &casting);
            let is_equal = match crossings {
                Crossings::HowMany => found == expected,
                Crossings::Whether => marks(&found) == marks(&expected),
            };
            assert!(is_equal, "{level:?}, {crossings:?}, at {:?}", instant.time);
            tally.compared += rules.spec.len() as u64;
        }
    }
    tally.keyframes += 1;
}

/// Hits, and whether there were crossings.
fn marks(counts: &RayCounts) -> (&[u32], Vec<bool>) {
    let crossings = counts.crossings.values().iter();
    (counts.hits.values(), crossings.map(|&crossings| crossings > 0).collect())
}

fn drive(name: &str, settings: &[&str]) -> Drive {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let text = world_text_with(shipped_world(name).unwrap(), &settings).unwrap();
    let world = World::parse(&text, name).unwrap_or_else(|fault| panic!("{fault}"));
    let taxonomy = parse_taxonomy(shipped_taxonomy(&world.taxonomy).unwrap(), name).unwrap();
    Drive::new(world, &taxonomy).unwrap()
}

fn rules(drive: &Drive, name: &str) -> Rules {
    let world = drive.world();
    let taxonomy = shipped_taxonomy(&world.taxonomy).unwrap();
    let taxonomy = parse_taxonomy(taxonomy, &world.taxonomy).unwrap();
    let mut config = Config::from_layers(name, preset(name).unwrap(), None, &[]).unwrap();
    let autos = Autos {
        ego_box_m: None,
        taxonomy: world.taxonomy.clone(),
        reference_lidar: world.lidars[0].name.clone(),
    };
    config.resolve(&autos, &taxonomy);
    Rules::new(&config, taxonomy.into()).unwrap_or_else(|fault| panic!("{fault}"))
}

fn aggregated(drive: &Drive, rules: &Rules) -> AggregatedScene<ClassId> {
    let sweeps = &drive.scene().sweeps;
    let read = |header: &SweepHeader| -> Result<_, Infallible> {
        let is_it =
            |other: &SweepHeader| (other.time, &other.lidar) == (header.time, &header.lidar);
        Ok(sweeps.iter().position(is_it).map(|at| drive.points(at)))
    };
    let Ok(aggregated) = aggregate_scene(drive.scene(), rules, read, |_| {});
    aggregated
}

fn instant<'a>(
    drive: &Drive,
    aggregated: &'a AggregatedScene<ClassId>,
    keyframe: &Keyframe,
    rules: &Rules,
) -> Instant<'a> {
    let reference = drive.scene().reference_sweep(keyframe);
    let grid_from_world = rules.world_from_grid(reference).inverse();
    let standing = standing_at(drive.scene(), keyframe.time, &grid_from_world, rules);
    let boxes = standing.into_iter();
    let moment = Moment {
        time: keyframe.time,
        grid_from_world,
        ego: reference.world_from_ego * LIDAR_ORIGIN,
        reference_lidar: grid_from_world * reference.world_from_lidar() * LIDAR_ORIGIN,
        standing: &boxes
            .map(|stands| TrackBox { track: stands.track, class: None, boxed: stands.boxed })
            .collect::<Vec<_>>(),
    };
    compose(aggregated, &moment, &rules.window)
}
