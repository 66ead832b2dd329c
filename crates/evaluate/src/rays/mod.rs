//! RayIoU and its kin: what a lidar would see of two label grids, compared ray by ray.
//!
//! A [`RaySet`] is cast from a few [`choose_origins`] into the truth and, where that stops a ray, into
//! the prediction; [`ray_pairs`] does so for a keyframe. Tallies count pairs ([`RayTally`],
//! [`FlowTally`], [`PanopticTally`]) and add up over keyframes in any order, in integers; ratios come
//! last. `docs/scores.md` says what each score asks.
//!
//! Rays of one azimuth cross the same columns of voxels whatever their pitch. So the columns are
//! walked once for all pitches, and a ray is looked at closely only where the occupied voxels of a
//! column reach into its heights. [`first_hit`] does the same for one ray, voxel by voxel;
//! [`textbook_first_hit`] as the textbook has it.

mod climb;
mod columns;
mod fan;
mod figures;
mod flow;
mod grid;
mod hit;
mod origins;
mod pairs;
mod panoptic;
mod panoptic_frame;
mod path;
mod ray;
mod set;
mod tally;
mod textbook;
mod walk;

pub use figures::{RayIou, RayIouAt};
pub use flow::{FlowScore, FlowTally, challenge_score};
pub use grid::RayGrid;
pub use hit::{RayEnd, RayHit, first_hit};
pub use origins::{MOST_ORIGINS, ORIGIN_REACH_M, choose_origins};
pub use pairs::{RayPair, cast_rays, ray_pairs};
pub use panoptic::{PanopticTally, RayPq, RayPqAt, RayPqClass};
pub use panoptic_frame::{InstanceGrids, MIN_RAYS};
pub use set::RaySet;
pub use tally::{RayTally, THRESHOLDS_M};
pub use textbook::textbook_first_hit;
