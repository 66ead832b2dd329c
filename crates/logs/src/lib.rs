//! Readers: logged drives to scenes.
//!
//! A log is somebody else's file, so this crate is the door at which everything is checked. What
//! stands behind it (a [`Scene`], a point cloud) is in our own frames, units and words, and no stage
//! asks again. A reader delivers a scene's tables at once but its points sweep by sweep, so that
//! memory is the caller's to bound. What is wrong comes back as a [`Fault`] that says where; a reader
//! never decides what to do about it: what can be lived with are warnings, what had to be left out
//! are refusals of the scene, and only what spoils a scene as a whole is an error.
//!
//! ```
//! use std::path::Path;
//! use occlabel_logs::NuScenesLog;
//!
//! let fault = NuScenesLog::format_defaults(Path::new("no/such/log"), None).unwrap_err();
//! assert_eq!(fault.rule, "missing-file");
//! assert!(fault.to_string().starts_with("no/such/log: expected "));
//! ```
//!
//! [`Scene`]: occlabel_core::Scene
//! [`Fault`]: occlabel_core::Fault

mod argoverse2;
mod check;
mod cloud;
mod coda;
#[cfg(any(test, fuzzing))]
pub mod doors;
mod files;
mod formats;
mod image_files;
mod inventory;
mod keyframes;
mod kitti360;
mod kitti_labels;
mod masks;
mod mcap;
mod meshes;
#[cfg(test)]
mod mutation_tests;
mod names;
mod notes;
mod number_rows;
mod nuscenes;
mod options;
mod points;
mod raw_labels;
mod sampled_points;
mod semantickitti;
mod source;
mod tracks;
mod transform;
mod waymo;
mod wire;

pub use argoverse2::Argoverse2Log;
pub use check::{Finding, SceneSurvey, Severity, SweepSurvey, UnknownSum, check_poses};
pub use cloud::{CloudLog, CloudOptions};
pub use coda::CodaLog;
pub use formats::looks_like;
pub use image_files::{ImageFile, check_images};
pub use inventory::{Inventory, MissingFile};
pub use kitti360::Kitti360Log;
pub use masks::{MaskFile, Masks, SceneMasks};
pub use mcap::{McapLog, McapOptions, TimeSource};
pub use meshes::{MeshFile, MeshFolder};
pub use nuscenes::{NuScenesLog, NuScenesOptions, QuaternionOrder};
pub use options::{ReadOptions, unknown_hint, without_stand_in};
pub use points::PointColumns;
pub use raw_labels::UnknownLabels;
pub use semantickitti::SemanticKittiLog;
pub use source::{ReaderDefaults, SceneSource, SweepPoints};
pub use waymo::WaymoLog;
