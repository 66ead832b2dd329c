//! The order of the stages, and the configuration that drives them.
//!
//! [`aggregate_scene`] runs once per scene, [`label_keyframe`] once per keyframe; both read like the
//! method they implement, one line a stage. All that decides a voxel comes in as [`Rules`], made
//! from a [`Config`] that was checked at the door.
//!
//! ```
//! use occlabel_pipeline::{Autos, Config, Rules, parse_taxonomy, preset, shipped_taxonomy};
//!
//! let autos = Autos {
//!     ego_box_m: None,
//!     taxonomy: "occ3d-nuscenes".into(),
//!     reference_lidar: "LIDAR_TOP".into(),
//! };
//! let mut config = Config::parse(preset("precise").unwrap(), "precise")?;
//! let text = shipped_taxonomy("occ3d-nuscenes").unwrap();
//! let taxonomy = parse_taxonomy(text, "occ3d-nuscenes")?;
//! config.resolve(&autos, &taxonomy);
//! let rules = Rules::new(&config, taxonomy.into())?;
//! assert_eq!(rules.spec.shape(), [200, 200, 16]);
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod aggregate_scene;
mod bodies;
mod check;
mod config;
mod cost;
#[cfg(any(test, fuzzing))]
pub mod doors;
mod flow;
mod label_keyframe;
mod laid_over;
mod layers;
mod memory;
mod own_sensors;
mod paint_scene;
mod presets;
mod rules;
mod scene_work;
mod standing;

pub use aggregate_scene::{aggregate_painted_scene, aggregate_scene, boxes_at, sort_scene};
pub use bodies::{Fit, KeyframeMeshes, MeshFit, MeshTracks, embody, mesh_tracks};
pub use config::{
    Autos, Config, EgoBox, GridFrame, GridTable, Limit, MeshFrame, MeshTable, PaintTable,
    ReaderTables, VoxelSize,
};
pub use cost::Cost;
pub use label_keyframe::{LabelOptions, LabelledKeyframe, Stage, label_keyframe};
pub use memory::MemoryModel;
pub use occlabel_occlusion::Lenses;
pub use occlabel_raycast::RaySource;
pub use own_sensors::{own_points, own_view};
pub use paint_scene::{MaskedExposures, paint_scene};
pub use presets::{
    MASK_TABLES, PRESETS, TAXONOMIES, parse_taxonomy, preset, shipped_masks, shipped_taxonomy,
};
pub use rules::{MeshRules, Rules};
pub use scene_work::{CastingCost, SceneWork};
pub use standing::standing_at;
