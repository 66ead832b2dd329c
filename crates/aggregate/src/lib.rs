//! Sort each sweep into the world and the boxes that move through it, and put one instant together.
//!
//! A point inside a track's box moves with the track, so it is kept in box coordinates
//! ([`split_sweep`]); everything else is kept in world coordinates. At a keyframe each is placed
//! where it belongs at that instant ([`compose`]). This is what keeps moving objects sharp: summed
//! up in world coordinates they would smear into trails. Points of no time come sorted
//! ([`keep_timeless`]).
//!
//! ```
//! use nalgebra::{Point3, Vector3};
//! use occlabel_aggregate::{SplitSettings, TrackBox, split_sweep};
//! use occlabel_core::*;
//!
//! let header = SweepHeader {
//!     time: Timestamp(0),
//!     lidar: "TOP".into(),
//!     source_id: "s".into(),
//!     file: "s.bin".into(),
//!     world_from_ego: Pose::identity(),
//!     ego_from_lidar: Pose::identity(),
//!     labelled: false,
//!     points_of: PointsOf::Moment,
//! };
//! let positions = vec![Point3::new(10.0, 0.0, 0.0), Point3::new(20.0, 0.0, 0.0)];
//! let labels = vec![PointLabel::Unlabelled; 2];
//! let sweep = Sweep {
//!     header: &header,
//!     cloud: PointCloud::from_one_origin(LIDAR_ORIGIN, positions, labels),
//! };
//! let boxed = Box3 {
//!     world_from_box: Pose::translation(11.0, 0.0, 0.0),
//!     size_m: Vector3::new(4.0, 2.0, 1.5),
//! };
//! let car = TrackBox { track: TrackId(1), class: Some(ClassId(4)), boxed };
//! let settings = SplitSettings {
//!     ego_box_m: None,
//!     max_range_m: 1000.0,
//!     growth: BoxGrowth { scale: 1.0, margin_m: 0.1 },
//! };
//! let split = split_sweep(&sweep, &[car], &settings);
//! assert_eq!(split.objects[0].cloud.positions, [Point3::new(-1.0, 0.0, 0.0)]);
//! assert_eq!(split.background.cloud.positions, [Point3::new(20.0, 0.0, 0.0)]);
//! ```

mod accumulate;
mod beam_order;
mod cabinet;
mod compose;
mod split;
mod timeless;

pub use accumulate::accumulate;
pub use compose::{Moment, WindowSettings, compose};
pub use split::{SplitSettings, SplitSweep, TrackBox, split_sweep};
pub use timeless::keep_timeless;
