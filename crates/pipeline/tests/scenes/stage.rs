//! A known world, driven through by a lidar.

use nalgebra::{Point3, Vector3};
use occlabel_core::{Box3, BoxTrack, OccupancyLabels, Pose, VoxelIndex};
use occlabel_pipeline::Rules;

use super::{
    Body, Drive, FREE, OCCUPIED, OTHERS, UNOBSERVED, at, directions, header, is_lit, look, overlap,
    track, upright,
};

/// Times are seconds; the map is the frame in which the test speaks, its grid the ego's at time 0.
pub(crate) struct Stage<'a> {
    /// What stands where at a time.
    pub(crate) world: &'a dyn Fn(f64) -> Vec<Body>,
    /// Where the ego is at a time.
    pub(crate) map_from_ego: &'a dyn Fn(f64) -> Pose,
    /// When there are sweeps.
    pub(crate) sweeps_s: &'a [f64],
    /// When each track is annotated, in order of ids.
    pub(crate) annotated_s: &'a [&'a [f64]],
    /// Between two rays, degrees.
    pub(crate) step_deg: f64,
}

impl Stage<'_> {
    /// The drive, with a keyframe at each of some sweeps. The log's world is not the map.
    pub(crate) fn drive(&self, keyframes_s: &[f64]) -> Drive {
        let mut drive = Drive::default();
        let directions = directions(self.step_deg);
        for &time in self.sweeps_s {
            let cloud = look(&(self.world)(time), &self.map_from_lidar(time), &directions);
            let world_from_ego = world_from_map() * (self.map_from_ego)(time);
            drive.add_sweep(header(time, world_from_ego, ego_from_lidar()), cloud);
        }
        drive.scene.tracks =
            (1..).zip(self.annotated_s).map(|(id, times)| self.track(id, times)).collect();
        for time in keyframes_s {
            let sweep = self.sweeps_s.iter().position(|other| other == time);
            drive.add_keyframe(sweep.expect("a keyframe has a sweep"), &[]);
        }
        drive
    }

    fn track(&self, id: u16, times: &[f64]) -> BoxTrack {
        let body = |time: f64| {
            let of_track = |body: &Body| body.track == Some(id);
            (self.world)(time).into_iter().find(of_track).expect("a track has a body")
        };
        let boxes = times.iter().map(|&time| (at(time), boxed(&body(time)))).collect();
        track(id, body(times[0]).class, boxes)
    }

    pub(crate) fn map_from_lidar(&self, time: f64) -> Pose {
        (self.map_from_ego)(time) * ego_from_lidar()
    }

    /// The voxels of a keyframe as bodies of the map, with their places.
    pub(crate) fn voxels(&self, rules: &Rules, keyframe_s: f64) -> Vec<([usize; 3], Body)> {
        let map_from_grid = (self.map_from_ego)(keyframe_s);
        let voxel = |index: VoxelIndex| {
            let centre = upright(rules.spec.centre(index).into(), 0.0);
            let half_m = rules.spec.size_m() / 2.0;
            let body = Body::new(OTHERS, map_from_grid * centre, half_m);
            (index.0.map(|i| i as usize), body)
        };
        rules.spec.voxels().map(voxel).collect()
    }

    /// Judges a still world by sight lines, without any grid. A voxel that no sweep could look into
    /// is unobserved; one that a sweep overlooked as a whole is observed; an occupied one holds a
    /// surface. Returns how many were dark, lit and occupied.
    #[track_caller]
    pub(crate) fn check_still(&self, labels: &OccupancyLabels, rules: &Rules) -> [usize; 3] {
        let world = (self.world)(0.0);
        let smaller: Vec<Body> = world.iter().map(shrunk).collect();
        let eyes: Vec<_> = self
            .sweeps_s
            .iter()
            .map(|&time| self.map_from_lidar(time) * Point3::origin())
            .collect();
        let mut counts = [0; 3];
        for (voxel, body) in self.voxels(rules, 0.0) {
            let state = *labels.evidence().state.at(voxel);
            let samples = samples(&body);
            let sees =
                |world: &[Body], eye| samples.iter().filter(|p| is_lit(world, eye, p)).count();
            if eyes.iter().all(|eye| sees(&smaller, eye) == 0) {
                counts[0] += 1;
                assert_eq!(state, UNOBSERVED, "{voxel:?} is dark");
                assert_eq!(*labels.evidence().crossings.at(voxel), 0, "{voxel:?} is dark");
            }
            if eyes.iter().any(|eye| sees(&world, eye) == samples.len()) {
                counts[1] += 1;
                assert_ne!(state, UNOBSERVED, "{voxel:?} is lit");
            }
            if state == OCCUPIED {
                counts[2] += 1;
                assert!(
                    solid(&world).any(|other| overlap(&body, other)),
                    "{voxel:?} holds nothing"
                );
            }
        }
        counts
    }

    /// Judges a keyframe by where everything stood then: nothing else is occupied, and of every
    /// class only what holds a surface of that class. Returns how many were occupied.
    #[track_caller]
    pub(crate) fn check_no_trail(
        &self,
        labels: &OccupancyLabels,
        rules: &Rules,
        keyframe_s: f64,
    ) -> usize {
        let world = (self.world)(keyframe_s);
        let mut occupied = 0;
        for (voxel, body) in self.voxels(rules, keyframe_s) {
            if *labels.evidence().state.at(voxel) == OCCUPIED {
                let class = *labels.semantics.at(voxel);
                let holds =
                    |other: &&Body| other.class.0 == class && overlap(&body, &other.grown(0.001));
                assert!(solid(&world).any(|other| holds(&other)), "{voxel:?} of class {class}");
                occupied += 1;
            }
        }
        occupied
    }

    /// How many voxels are free that moving bodies pass in some sweep, but not at the keyframe.
    pub(crate) fn free_on_the_way(
        &self,
        labels: &OccupancyLabels,
        rules: &Rules,
        keyframe_s: f64,
    ) -> usize {
        let moving = |time| (self.world)(time).into_iter().filter(|body| body.track.is_some());
        let now: Vec<Body> = moving(keyframe_s).collect();
        let passing: Vec<Body> = self.sweeps_s.iter().flat_map(|&time| moving(time)).collect();
        let is_on_the_way = |voxel: &Body| {
            let centre = voxel.map_from_body.translation.vector.into();
            passing.iter().any(|body| body.contains(&centre))
                && !now.iter().any(|body| overlap(voxel, body))
        };
        let voxels = self.voxels(rules, keyframe_s).into_iter();
        voxels
            .filter(|(voxel, body)| {
                *labels.evidence().state.at(*voxel) == FREE && is_on_the_way(body)
            })
            .count()
    }
}

/// The grid's ego pose at time 0 is the map's origin; the log's world is elsewhere and turned.
pub(crate) fn world_from_map() -> Pose {
    upright([120.0, -40.0, 3.0], 0.7)
}

/// The lidar stands 1.6 m above the ground, turned and off every symmetry.
fn ego_from_lidar() -> Pose {
    upright([0.11, 0.13, 1.6], 0.3)
}

fn boxed(body: &Body) -> Box3 {
    Box3 { world_from_box: world_from_map() * body.map_from_body, size_m: body.half_m * 2.0 }
}

/// Everything but the hall around.
fn solid(world: &[Body]) -> impl Iterator<Item = &Body> {
    world.iter().filter(|body| !body.is_hall)
}

/// Smaller by more than rays move when they are snapped. The hall stays.
fn shrunk(body: &Body) -> Body {
    if body.is_hall { body.clone() } else { body.grown(-0.002) }
}

/// Centre, corners, and middles of edges and faces, a hair inside.
fn samples(voxel: &Body) -> Vec<Point3<f64>> {
    let sides = |i: usize| Vector3::new(i / 9, i / 3 % 3, i % 3).map(|side| side as f64 - 1.0);
    let place =
        |i| voxel.map_from_body * Point3::from(voxel.half_m.component_mul(&sides(i)) * 0.999);
    (0..27).map(place).collect()
}
