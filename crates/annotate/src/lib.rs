//! Carry what was annotated at keyframes to every sweep.
//!
//! Two annotations come at keyframes only: boxes and point labels. Boxes are interpolated between
//! their annotated times ([`box_at`]), labels spread to the points around them ([`relabel`]). Where
//! images have class masks, points without a label take the classes of the pixels they fall on before
//! ([`paint`]). All happens once per scene, so a point's class does not depend on the keyframe that
//! uses it.
//!
//! ```
//! use nalgebra::{Point3, Vector3};
//! use occlabel_annotate::{BoxSettings, BoxSource, box_at};
//! use occlabel_core::{Box3, BoxTrack, ClassId, Meaning, Pose, Timestamp, TrackId};
//!
//! let at = |x: f64| Box3 {
//!     world_from_box: Pose::translation(x, 0.0, 0.0),
//!     size_m: Vector3::new(4.0, 2.0, 1.5),
//! };
//! let car = BoxTrack {
//!     id: TrackId(1),
//!     source_id: "a".into(),
//!     category: "vehicle.car".into(),
//!     meaning: Meaning::Class(ClassId(4)),
//!     boxes: vec![(Timestamp(0), at(0.0)), (Timestamp(500_000_000), at(5.0))],
//! };
//! let settings = BoxSettings { max_gap_s: 0.6, extrapolate_s: 0.0 };
//! let (boxed, source) = box_at(&car, Timestamp(100_000_000), &settings).unwrap();
//! assert_eq!(boxed.world_from_box * Point3::origin(), Point3::new(1.0, 0.0, 0.0));
//! assert_eq!(source, BoxSource::Interpolated);
//! ```

mod ballot;
mod bounds;
mod box_at;
mod depth_buffer;
mod groups;
mod labelled_tree;
mod paint;
mod poll;
mod relabel;
mod unlabelled;
mod vote;

pub use box_at::{BoxSettings, BoxSource, box_at};
pub use paint::{PaintSettings, View, paint};
pub use relabel::{GhostClasses, RelabelSettings, relabel};
