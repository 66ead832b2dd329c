//! What holds of every scene: properties of the whole pipeline over random drives.
//!
//! The seeds are fixed, so a run is the same everywhere. Each test counts what it exercised, and
//! asserts that it was enough to mean something.

mod scenes;

use std::cell::RefCell;

use nalgebra::{Point3, Vector3};
use occlabel_core::{OccupancyLabels, PointCloud, Pose, Timestamp};
use occlabel_pipeline::Rules;
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseResult, TestRunner};
use scenes::random::{HEAVY, INSIDE, LIVELY, drives, settings};
use scenes::{Drive, FREE, OCCUPIED, UNOBSERVED, large, same_arrays, upright};

const SHAPE: [usize; 3] = [16, 16, 8];

/// What a test exercised.
#[derive(Debug, Default)]
struct Tally {
    cases: usize,
    track_points: usize,
    occupied: usize,
    free: usize,
    unobserved: usize,
    /// Voxels with an instance.
    boxed: usize,
    /// Voxels with a bit in `camera_bits`.
    in_view: usize,
}

impl Tally {
    fn record(&mut self, drive: &Drive, rules: &Rules, labels: &OccupancyLabels) {
        let states = labels.evidence().state.values();
        let count = |state: u8| states.iter().filter(|&&other| other == state).count();
        let aggregated = drive.aggregate(rules, |_| true);
        self.cases += 1;
        self.track_points += aggregated.objects.iter().map(|o| o.cloud.len()).sum::<usize>();
        self.occupied += count(OCCUPIED);
        self.free += count(FREE);
        self.unobserved += count(UNOBSERVED);
        self.boxed += labels.evidence().instances.values().iter().filter(|id| **id > 0).count();
        self.in_view += labels.evidence().camera_bits.values().iter().filter(|b| **b > 0).count();
    }

    /// Asserts that so many cases were judged, which held, on average, more than 60 occupied voxels,
    /// 100 free, 100 unobserved, 80 in view, and at least so many points of tracks.
    #[track_caller]
    fn assert_rich(&self, cases: usize, track_points: usize) {
        let is_rich = self.cases >= cases
            && self.occupied > 60 * cases
            && self.free > 100 * cases
            && self.unobserved > 100 * cases
            && self.track_points >= track_points * cases
            && self.in_view > 80 * cases;
        assert!(is_rich, "{self:?}");
    }
}

/// Judges so many random values; the tally is what the judge recorded.
#[track_caller]
fn for_all<S: Strategy>(
    cases: u32,
    strategy: S,
    judge: impl Fn(S::Value, &mut Tally) -> TestCaseResult,
) -> Tally {
    let config = ProptestConfig {
        rng_seed: RngSeed::Fixed(20_260_101),
        failure_persistence: None,
        max_shrink_iters: 200,
        ..ProptestConfig::with_cases(cases)
    };
    let tally = RefCell::new(Tally::default());
    let judged =
        TestRunner::new(config).run(&strategy, |value| judge(value, &mut tally.borrow_mut()));
    judged.unwrap_or_else(|failure| panic!("{failure}"));
    tally.into_inner()
}

fn rules_with(settings: &[String], more: &[&str]) -> Rules {
    let all: Vec<&str> = settings.iter().map(String::as_str).chain(more.iter().copied()).collect();
    large(&all)
}

// ---- Moving a drive ----------------------------------------------------------------------------

/// The same drive in a log whose world frame is another.
fn in_another_world(drive: &Drive, other_from_world: &Pose) -> Drive {
    let mut other = drive.clone();
    for sweep in &mut other.scene.sweeps {
        sweep.world_from_ego = other_from_world * sweep.world_from_ego;
    }
    move_boxes_and_cameras(&mut other, |pose| other_from_world * pose);
    other
}

/// The drive with everything moved past the ego, whose grid stays.
fn past_the_ego(drive: &Drive, shift_m: Vector3<f64>) -> Drive {
    let mut other = drive.clone();
    let shift = Pose::from_parts(shift_m.into(), Default::default());
    for sweep in &mut other.scene.sweeps {
        sweep.ego_from_lidar = shift * sweep.ego_from_lidar;
    }
    move_boxes_and_cameras(&mut other, |pose| shift * pose);
    other
}

fn move_boxes_and_cameras(drive: &mut Drive, place: impl Fn(&Pose) -> Pose) {
    let boxes = drive.scene.tracks.iter_mut().flat_map(|track| &mut track.boxes);
    boxes.for_each(|(_, boxed)| boxed.world_from_box = place(&boxed.world_from_box));
    let exposures = drive.scene.keyframes.iter_mut().flat_map(|keyframe| &mut keyframe.exposures);
    exposures.for_each(|seen| seen.world_from_camera = place(&seen.world_from_camera));
}

/// The drive turned by 90 degrees to the left, points and origins exactly; the ego does not turn.
fn turned_left(drive: &Drive) -> Drive {
    let left = |v: &Vector3<f64>| Vector3::new(-v.y, v.x, v.z);
    let turn = upright([0.0; 3], std::f64::consts::FRAC_PI_2).rotation;
    let shifted =
        |pose: &Pose| Pose::from_parts(left(&pose.translation.vector).into(), pose.rotation);
    let turned =
        |pose: &Pose| Pose::from_parts(left(&pose.translation.vector).into(), turn * pose.rotation);
    let mut other = drive.clone();
    for sweep in &mut other.scene.sweeps {
        sweep.world_from_ego = shifted(&sweep.world_from_ego);
        sweep.ego_from_lidar = shifted(&sweep.ego_from_lidar);
    }
    for cloud in &mut other.clouds {
        let points = cloud.positions.iter_mut().chain(&mut cloud.origins);
        points.for_each(|p| *p = left(&p.coords).into());
    }
    move_boxes_and_cameras(&mut other, turned);
    other
}

/// Everything of a voxel but its flow.
fn evidence_at(labels: &OccupancyLabels, at: [usize; 3]) -> [u16; 8] {
    let evidence = labels.evidence();
    [
        *evidence.hits.at(at),
        *evidence.crossings.at(at),
        u16::from(*evidence.state.at(at)),
        u16::from(*labels.semantics.at(at)),
        u16::from(*labels.mask_lidar.at(at)),
        u16::from(*labels.mask_camera.at(at)),
        *evidence.instances.at(at),
        *evidence.camera_bits.at(at),
    ]
}

fn voxels() -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = SHAPE;
    (0..nx).flat_map(move |x| (0..ny).flat_map(move |y| (0..nz).map(move |z| [x, y, z])))
}

/// The same velocity to 0.1 mm/s, or none in both.
fn is_same_flow(a: [f32; 3], b: [f32; 3]) -> bool {
    (0..3).all(|axis| (a[axis] - b[axis]).abs() < 1e-4 || (a[axis].is_nan() && b[axis].is_nan()))
}

// ---- Where things are --------------------------------------------------------------------------

/// The log's world frame may be any: all arrays stay, flow but for its last bits.
#[test]
fn the_worlds_own_frame_does_not_matter() {
    let pose = ([-1e4..1e4, -1e4..1e4, -50.0..50.0], [-0.3..0.3, -0.3..0.3, -3.0..3.0]);
    let tally =
        for_all(300, (drives(LIVELY), settings(), pose), |(drive, settings, pose), tally| {
            let rules = rules_with(&settings, &[]);
            let (here, labels) = (Pose::new(pose.0.into(), pose.1.into()), drive.label(&rules));
            let moved = in_another_world(&drive, &here).label(&rules);
            for at in voxels() {
                prop_assert_eq!(evidence_at(&labels, at), evidence_at(&moved, at), "{:?}", at);
                let flows = [&labels, &moved].map(|labels| *labels.evidence().flow.at(at));
                prop_assert!(is_same_flow(flows[0], flows[1]), "{:?}: {:?}", at, flows);
            }
            tally.record(&drive, &rules, &labels);
            Ok(())
        });
    tally.assert_rich(300, 10);
}

/// Points, origins, boxes and cameras moved by whole voxels past an ego that stays: everything moves
/// by as many voxels. Compared where both grids are; nothing that is hit leaves them. Not under
/// `all-centers`: a voxel that only one of the grids has is a target there.
#[test]
fn a_shift_by_whole_voxels_shifts_the_grid() {
    let voxels_moved = [-2_i32..=2, -2..=2, -1..=1];
    let rays = prop_oneof![Just("occlusion.rays=pixels"), Just("occlusion.rays=occupied-centers")];
    let cases = (drives(INSIDE), settings(), voxels_moved, rays);
    let tally = for_all(300, cases, |(drive, settings, moved_by, rays), tally| {
        let rules = rules_with(&settings, &[rays]);
        let labels = drive.label(&rules);
        let shift_m = Vector3::from(moved_by.map(|n| f64::from(n) * 0.5));
        let moved = past_the_ego(&drive, shift_m).label(&rules);
        let hits = |labels: &OccupancyLabels| -> u64 {
            labels.evidence().hits.values().iter().map(|&hits| u64::from(hits)).sum()
        };
        prop_assert_eq!(hits(&labels), hits(&moved), "nothing left the grid");
        for at in voxels() {
            let to = [0, 1, 2].map(|axis| at[axis] as i32 + moved_by[axis]);
            let to = to.map(|i| usize::try_from(i).unwrap_or(usize::MAX));
            if (0..3).all(|axis| to[axis] < SHAPE[axis]) {
                prop_assert_eq!(evidence_at(&labels, at), evidence_at(&moved, to), "{:?}", at);
                let flows = [labels.evidence().flow.at(at), moved.evidence().flow.at(to)];
                prop_assert!(is_same_flow(*flows[0], *flows[1]), "{:?}: {:?}", at, flows);
            }
        }
        tally.record(&drive, &rules, &labels);
        Ok(())
    });
    tally.assert_rich(300, 30);
}

/// A quarter turn about z permutes the grid, flow turned along.
///
/// It exchanges x and y, and where a ray meets faces of both at one t, x steps first: rays of points
/// are asked for that, exactly, and left out. Rays cut at boxes and rays of cameras end anywhere, so
/// that a tie would be a coincidence of 1 in 10^6. The lattice has no centre of a voxel, only a point
/// 1/2048 beside it, always on the same side: cameras look through pixels, not at centres.
#[test]
fn a_quarter_turn_permutes_the_grid() {
    let tally = for_all(300, (drives(LIVELY), settings()), |(mut drive, settings), tally| {
        drop_rays_through_edges(&mut drive);
        let rules = rules_with(&settings, &["occlusion.rays=pixels"]);
        let (labels, turned) = (drive.label(&rules), turned_left(&drive).label(&rules));
        for [x, y, z] in voxels() {
            let (at, to) = ([x, y, z], [SHAPE[0] - 1 - y, x, z]);
            prop_assert_eq!(evidence_at(&labels, at), evidence_at(&turned, to), "{:?}", at);
            let [vx, vy, vz] = *labels.evidence().flow.at(at);
            let flow = *turned.evidence().flow.at(to);
            prop_assert!(is_same_flow([-vy, vx, vz], flow), "{:?}: {:?}", at, flow);
        }
        tally.record(&drive, &rules, &labels);
        Ok(())
    });
    tally.assert_rich(300, 10);
}

/// Drops points whose ray meets a face of x and one of y at once.
fn drop_rays_through_edges(drive: &mut Drive) {
    let middle = drive.scene.sweeps[drive.scene.keyframes[0].sweep].world_from_ego;
    for (sweep, cloud) in drive.scene.sweeps.iter().zip(&mut drive.clouds) {
        let grid_from_lidar = middle.inverse() * sweep.world_from_lidar();
        let lattice =
            |p: &Point3<f64>| (grid_from_lidar * p).coords.map(|m| (m * 4096.0).round() as i64);
        let origins: Vec<_> = cloud.origins.iter().map(lattice).collect();
        let mut kept = PointCloud::with_origins(cloud.origins.clone());
        for (i, p) in cloud.positions.iter().enumerate() {
            if !meets_an_edge(lattice(p), origins[cloud.origin_of[i] as usize]) {
                kept.push(*p, cloud.labels[i], cloud.origin_of[i]);
            }
        }
        *cloud = kept;
    }
}

/// Whether the way between two points, in lattice units, meets a face of x and one of y at one t.
fn meets_an_edge(a: Vector3<i64>, b: Vector3<i64>) -> bool {
    let way = b - a;
    let faces = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
        (low.div_euclid(2048) + 1..=high.div_euclid(2048)).map(move |face| face * 2048 - a[axis])
    };
    faces(0).any(|x| faces(1).any(|y| x * way.y == y * way.x))
}

// ---- In which order ----------------------------------------------------------------------------

#[test]
fn section_12_the_order_of_points_and_of_sweeps_does_not_matter() {
    let cases = (drives(LIVELY), settings(), 0..1_000_usize);
    let tally = for_all(300, cases, |(drive, settings, seed), tally| {
        let rules = rules_with(&settings, &[]);
        let labels = drive.label(&rules);
        same_arrays(&labels, &with_points_shuffled(&drive, seed).label(&rules), "points");
        same_arrays(&labels, &with_sweeps_shuffled(&drive, seed).label(&rules), "sweeps");
        tally.record(&drive, &rules, &labels);
        Ok(())
    });
    tally.assert_rich(300, 10);
}

/// The numbers below `count` in an order of no meaning.
fn shuffled(count: usize, seed: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|i| (i + seed) * 7_919 % 10_007);
    order
}

fn with_points_shuffled(drive: &Drive, seed: usize) -> Drive {
    let mut other = drive.clone();
    for cloud in &mut other.clouds {
        let mut mixed = PointCloud::with_origins(cloud.origins.clone());
        let order = shuffled(cloud.len(), seed);
        order
            .iter()
            .for_each(|&i| mixed.push(cloud.positions[i], cloud.labels[i], cloud.origin_of[i]));
        *cloud = mixed;
    }
    other
}

fn with_sweeps_shuffled(drive: &Drive, seed: usize) -> Drive {
    let mut other = drive.clone();
    let order = shuffled(drive.scene.sweeps.len(), seed);
    other.scene.sweeps = order.iter().map(|&i| drive.scene.sweeps[i].clone()).collect();
    for keyframe in &mut other.scene.keyframes {
        let place = order.iter().position(|&i| i == keyframe.sweep);
        keyframe.sweep = place.expect("every sweep is somewhere");
    }
    other
}

#[test]
fn section_12_the_number_of_shards_and_threads_does_not_show() {
    let tally = for_all(3, (drives(HEAVY), settings()), |(drive, settings), tally| {
        let rules = rules_with(&settings, &[]);
        let labels = drive.label(&rules);
        for threads in [1, 2, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("a pool").install(|| {
                for shards in [1, 2, 3, 7] {
                    let again = drive.labels_of(&rules, |_| true, shards).remove(0);
                    same_arrays(&labels, &again, &format!("{threads} threads, {shards} shards"));
                }
            });
        }
        tally.record(&drive, &rules, &labels);
        Ok(())
    });
    assert!(tally.cases == 3 && tally.occupied > 2_000 && tally.track_points > 500, "{tally:?}");
}

// ---- How much of it ----------------------------------------------------------------------------

/// Only labels of points and the first rule of section 9 decide here: under `ratio`, or once a nearer
/// neighbour turns a point into ground with its own rule of crossings, more can be less.
const ONLY_MORE: [&str; 4] = [
    "states.conflict=occupied-wins",
    "states.free_min_crossings=1",
    "raycast.flat_ignore_dz_m=0.0",
    "relabel.drop_ghosts=none",
];

#[test]
fn section_9_another_sweep_never_gives_unobserved_back() {
    let tally = for_all(300, (drives(LIVELY), settings()), |(mut drive, settings), tally| {
        drive.scene.tracks.clear();
        let rules = rules_with(&settings, &ONLY_MORE);
        let count = drive.clouds.len();
        let states_of = |sweeps: usize| {
            drive.labels_of(&rules, |sweep| sweep < sweeps, 1).remove(0).evidence.unwrap().state
        };
        let mut before = states_of(0);
        for sweeps in 1..=count {
            let after = states_of(sweeps);
            let pairs = before.values().iter().zip(after.values());
            let lost = pairs.filter(|(was, is)| **is == UNOBSERVED && **was != UNOBSERVED).count();
            prop_assert_eq!(lost, 0, "with sweep {} of {}", sweeps, count);
            let fell =
                before.values().iter().zip(after.values()).filter(|(was, is)| is < was).count();
            prop_assert_eq!(fell, 0, "occupied stays occupied");
            before = after;
        }
        tally.record(&drive, &rules, &drive.label(&rules));
        Ok(())
    });
    tally.assert_rich(300, 0);
}

/// For background rays, and for the world parts of tracks that do not stand at the keyframe.
#[test]
fn section_8_counts_of_two_halves_add_up_to_the_whole() {
    let cases = (drives(LIVELY), settings(), any::<u8>());
    let tally = for_all(300, cases, |(mut drive, settings, half), tally| {
        leave_the_keyframe(&mut drive);
        let rules =
            rules_with(&settings, &[&ONLY_MORE[..], &["relabel.unknown_class=taxonomy"]].concat());
        let in_half = |sweep: usize| half >> sweep & 1 == 1;
        let whole = drive.label(&rules);
        let one = drive.labels_of(&rules, in_half, 1).remove(0).evidence.unwrap();
        let other = drive.labels_of(&rules, |sweep| !in_half(sweep), 1).remove(0).evidence.unwrap();
        for at in voxels() {
            let [one, other] = [&one, &other].map(|e| [*e.hits.at(at), *e.crossings.at(at)]);
            let sum = [one[0] + other[0], one[1] + other[1]];
            let whole = [*whole.evidence().hits.at(at), *whole.evidence().crossings.at(at)];
            prop_assert_eq!(whole, sum, "{:?}", at);
        }
        prop_assert!(whole.evidence().instances.values().iter().all(|&id| id == 0));
        tally.record(&drive, &rules, &whole);
        Ok(())
    });
    tally.assert_rich(300, 10);
}

/// Moves the annotations of every track to after the keyframe, 50 ms and more.
fn leave_the_keyframe(drive: &mut Drive) {
    let keyframe = drive.scene.keyframes[0].time;
    for track in &mut drive.scene.tracks {
        let late = keyframe.0 + 50_000_000 - track.boxes[0].0.0;
        track.boxes.iter_mut().for_each(|(time, _)| *time = Timestamp(time.0 + late.max(0)));
    }
}

// ---- What is written ---------------------------------------------------------------------------

#[test]
fn section_11_the_arrays_agree_with_each_other() {
    let masked = RefCell::new([0; 2]);
    let tally = for_all(300, (drives(LIVELY), settings()), |(drive, settings), tally| {
        let rules = rules_with(&settings, &[]);
        let labels = drive.label(&rules);
        for at in voxels() {
            let [hits, crossings, state, class, lidar, camera, instance, bits] =
                evidence_at(&labels, at);
            prop_assert!(camera <= lidar, "mask_camera without mask_lidar at {:?}", at);
            prop_assert_eq!(lidar, u16::from(state != 0));
            prop_assert_eq!(camera, u16::from(bits != 0 && state != 0));
            prop_assert_eq!(class == 17, state != u16::from(OCCUPIED), "class {}", class);
            prop_assert!(hits > 0 || state != u16::from(OCCUPIED), "occupied by nothing");
            prop_assert!(crossings > 0 || state != u16::from(FREE), "free without a ray");
            prop_assert!(instance == 0 || state == u16::from(OCCUPIED), "a track in the air");
            let flow = *labels.evidence().flow.at(at);
            prop_assert!(instance > 0 || flow == [0.0; 3], "{:?} without a track", flow);
            masked.borrow_mut()[usize::from(camera)] += usize::from(lidar);
        }
        tally.record(&drive, &rules, &labels);
        Ok(())
    });
    tally.assert_rich(300, 10);
    let [unseen, seen] = masked.into_inner();
    assert!(seen > 10_000 && unseen > 10_000, "{seen} seen by a camera, {unseen} not");
    assert!(tally.boxed > 1_000, "{} voxels of tracks", tally.boxed);
}
