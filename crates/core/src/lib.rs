//! The words that every stage shares, and the geometry of the grid.
//!
//! All of it is values: no I/O, no threads, no logging. Each convention lives in one place and is
//! drawn there: where a voxel begins in `grid`, how a box stands in `boxes`, how a ray is walked in
//! `traverse`. Frames are bound to names, `let p_ego = ego_from_lidar * p_lidar`; units are SI and
//! radians.
//!
//! ```
//! use nalgebra::Point3;
//! use occlabel_core::{GridSpec, traverse};
//!
//! let spec = GridSpec::new([-40.0, -40.0, -1.0], [40.0, 40.0, 5.4], [0.4; 3])?;
//! let point = spec.snap(&Point3::new(3.0, 0.1, 0.5));
//! let lidar = spec.snap(&Point3::new(0.9, 0.1, 1.8));
//! let crossed = traverse(point, lidar).count();
//! assert_eq!(crossed, 8);
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod aggregated;
mod blocks;
mod body;
mod boxes;
mod brush;
mod bundles;
pub mod camera;
mod class;
mod cloud;
mod cloud_settings;
mod exposure;
mod fault;
mod grid;
mod instant;
mod keyframes;
mod mask;
mod mask_classes;
mod mcap_settings;
mod occupancy;
mod palette;
mod pose;
mod scene;
mod simd;
mod taxonomy;
mod time;
mod traverse;
mod truth;
mod walk;

pub use aggregated::{AggregatedScene, BackgroundSweep, ClassCounts, DropCounts, ObjectSweep};
pub use blocks::Blocks;
pub use body::{Body, BodyMotion, LoggedMesh, TriangleMesh};
pub use boxes::{Box3, BoxGrowth, BoxTrack, GrownBox, TrackId};
pub use brush::Brush;
pub use bundles::{BUNDLE, Bundles, Reach};
pub use camera::Camera;
pub use class::{ClassId, ClassSet};
pub use cloud::{PointCloud, PointLabel, is_finite};
pub use cloud_settings::{CloudSettings, OpacityScale, SizeScale};
pub use exposure::{EXPOSURE_WITHIN_S, nearest_exposure, nearest_exposure_within};
pub use fault::{Fault, printable};
pub use grid::{FAR_LANE, GridSpec, LATTICE, LatticePoint, VoxelGrid, VoxelIndex};
pub use instant::{Instant, PlacedObject, StandingBox};
pub use keyframes::{KeyframeSettings, KeyframeSource, reference_lidar};
pub use mask::ClassMask;
pub use mask_classes::{MaskClasses, MaskTable};
pub use mcap_settings::McapSettings;
pub use occupancy::{Evidence, OccupancyLabels, RayCounts, VoxelState, VoxelVote};
pub use palette::{ColorSet, Palette};
pub use pose::{Pose, RigidMap, slerp};
pub use scene::{
    Exposure, Keyframe, LIDAR_ORIGIN, Loss, NamedCamera, PointsOf, Refusal, Scene, Sweep,
    SweepHeader,
};
pub use simd::{Kernel, Level};
pub use taxonomy::{Meaning, Taxonomy, TaxonomyError};
pub use time::Timestamp;
pub use traverse::{Traverse, traverse};
pub use truth::VoxelTruth;
pub use walk::{walk, walk_after};
