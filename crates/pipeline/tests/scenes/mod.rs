//! Scenes in memory, for tests of the whole pipeline. Each test file uses its own part.
#![allow(dead_code, unused_imports)]

mod body;
mod drive;
mod lidar;
mod picture;
pub(crate) mod random;
mod settings;
mod stage;

pub(crate) use body::{Body, cast, is_lit, overlap, road_in_a_hall, slab};
pub(crate) use drive::{
    Drive, at, camera, header, looking_ahead, same_arrays, same_but_flow, track,
};
pub(crate) use lidar::{directions, look};
pub(crate) use picture::{LEGEND, class_at, from_above, from_the_left};
pub(crate) use settings::{large, rules, small};
pub(crate) use stage::{Stage, world_from_map};

use occlabel_core::{ClassId, Pose};

/// Classes of Occ3D-nuScenes.
pub(crate) const OTHERS: ClassId = ClassId(0);
pub(crate) const CAR: ClassId = ClassId(4);
pub(crate) const PEDESTRIAN: ClassId = ClassId(7);
pub(crate) const CONE: ClassId = ClassId(8);
pub(crate) const ROAD: ClassId = ClassId(11);
pub(crate) const TERRAIN: ClassId = ClassId(14);
pub(crate) const MANMADE: ClassId = ClassId(15);
pub(crate) const VEGETATION: ClassId = ClassId(16);

/// The states as they are written.
pub(crate) const UNOBSERVED: u8 = 0;
pub(crate) const FREE: u8 = 1;
pub(crate) const OCCUPIED: u8 = 2;

/// A pose on the ground: a place and a heading.
pub(crate) fn upright(place: [f64; 3], yaw_rad: f64) -> Pose {
    Pose::new(place.into(), [0.0, 0.0, yaw_rad].into())
}
