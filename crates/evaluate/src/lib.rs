//! How right labels are: against an exactly known world, against held-out sweeps, and, in [`scores`],
//! predictions against labels.
//!
//! Judging is counting: [`judge`] puts its questions to every voxel of a keyframe and returns a
//! [`Tally`] of integers. Tallies of keyframes and scenes add up in any order; only [`Tally::quality`]
//! takes ratios. `docs/quality.md` says what each figure asks, and what it cannot tell.
//!
//! ```
//! use occlabel_core::{ClassId, ClassSet, GridSpec, VoxelGrid, VoxelTruth};
//! use occlabel_evaluate::{JudgedLabels, KnownWorld, RINGS_M, Scale, Tally, judge};
//!
//! // Four voxels in a row: air, air, a wall, and what lies behind it.
//! let spec = GridSpec::new([0.0; 3], [4.0, 1.0, 1.0], [1.0; 3])?;
//! let air = VoxelTruth { crossed: true, surface_distance: 1.0, ..VoxelTruth::default() };
//! let wall = VoxelTruth {
//!     solid: 0.5,
//!     surface: true,
//!     surface_distance: 0.0,
//!     class: Some(ClassId(0)),
//!     ends: 7,
//!     ..VoxelTruth::default()
//! };
//! let hidden = VoxelTruth { crossed: false, ..air };
//! let truth = VoxelGrid::from_values(&spec, vec![air, air, wall, hidden]);
//!
//! // The labels call the second voxel occupied too.
//! let semantics = VoxelGrid::from_values(&spec, vec![17, 0, 0, 17]);
//! let observed = VoxelGrid::from_values(&spec, vec![1, 1, 1, 0]);
//! let labels = JudgedLabels {
//!     semantics: &semantics,
//!     mask_lidar: &observed,
//!     mask_camera: &observed,
//!     flow: None,
//! };
//! let known = KnownWorld { scene: "wall", truth: &truth, eyes: &[], occlusion: None };
//! let scale = Scale {
//!     spec,
//!     classes: vec!["building".into()],
//!     free: 17,
//!     flat: ClassSet::default(),
//!     deformable: ClassSet::default(),
//!     ring_m: RINGS_M.to_vec(),
//!     noise_sigma_m: 0.0,
//! };
//!
//! let tally: Tally = [judge(&labels, &known, &scale)?].into_iter().sum();
//! let quality = tally.quality();
//! let value = |name: &str| quality.all.get(name).and_then(|figure| figure.value);
//! assert_eq!(value("occupied_precision"), Some(0.5), "one of two");
//! assert_eq!(value("surface_recall"), Some(1.0), "the wall is there");
//! assert_eq!(value("free_recall"), Some(0.5), "one of the two crossed voxels");
//! assert_eq!(value("mask_lidar_iou"), Some(1.0));
//! assert_eq!(value("trail_rate"), None, "nothing moved");
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

pub mod compare;
mod exact_mean;
mod exact_sum;
pub mod held_out;
pub mod painted;
pub mod rays;
pub mod scores;
mod world_truth;

pub use world_truth::{
    COSTLY_FIGURES, ClassQuality, Figures, JudgedLabels, KnownWorld, Limits, Miss, Quality,
    RINGS_M, RingQuality, Scale, Tally, Value, WorstObject, judge,
};
