//! Scenes whose answer is geometry: a wall's shadow, a pillar's wedge, a car that leaves no trail.
//!
//! A lidar without noise looks at a known world of boxes; the whole pipeline labels what it saw. The
//! labels are judged twice: by sight lines in that world, which know no grid, and by pictures in
//! `tests/fixtures/goldens/geometry`, in which a change can be seen.

mod car;
mod comes_and_goes;
mod over_a_wall;
mod overlapping;
#[path = "../scenes/mod.rs"]
mod scenes;
mod still;

use std::collections::BTreeSet;

use occlabel_core::{OccupancyLabels, Pose};

use scenes::{Body, LEGEND, Stage, class_at, from_above, from_the_left, road_in_a_hall};

const SHAPE: [usize; 3] = [24, 16, 6];
const STILL: &dyn Fn(f64) -> Pose = &|_| Pose::identity();
/// Where the lidar stands over the ego, x and y.
const LIDAR_XY: [f64; 2] = [0.11, 0.13];

/// One sweep from where the ego stands.
fn one_look<'a>(world: &'a dyn Fn(f64) -> Vec<Body>) -> Stage<'a> {
    Stage { world, map_from_ego: STILL, sweeps_s: &[0.0], annotated_s: &[], step_deg: 0.5 }
}

/// The world of a road with more in it.
fn road_with(bodies: &[Body]) -> Vec<Body> {
    [road_in_a_hall(), bodies.to_vec()].concat()
}

fn picture(title: &str, views: &[String]) -> String {
    format!("{title}\n{LEGEND}{}", views.concat())
}

fn above(labels: &OccupancyLabels, z: usize) -> String {
    from_above(SHAPE, z, |voxel| class_at(labels, voxel))
}

fn beside(labels: &OccupancyLabels, y: usize) -> String {
    from_the_left(SHAPE, y, |voxel| class_at(labels, voxel))
}

fn voxels_above_ground() -> impl Iterator<Item = (usize, usize, usize)> {
    let [nx, ny, nz] = SHAPE;
    (0..nx).flat_map(move |x| (0..ny).flat_map(move |y| (2..nz).map(move |z| (x, y, z))))
}

fn instances_above_ground(labels: &OccupancyLabels, track: u16) -> BTreeSet<[usize; 3]> {
    let all = voxels_above_ground().map(|(x, y, z)| [x, y, z]);
    all.filter(|&voxel| *labels.evidence().instances.at(voxel) == track).collect()
}
