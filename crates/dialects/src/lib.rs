//! Label files of every dialect: their classes, their layouts, and what one can say that another
//! cannot.
//!
//! Label sets differ in frame, order of axes, resolution, class ids and the meaning of zero. A
//! [`Dialect`] says all that as data, in a file of `configs/dialects/`. A [`LabelSet`] is a folder of
//! keyframes in one of them; read, its labels are [`KeyframeLabels`], the same for all dialects:
//! `[x][y][z]` from the lower corner, classes counted from 0, free the number after the last.
//! [`Dialect::encode`] is the way back.
//!
//! ```
//! use occlabel_core::VoxelGrid;
//! use occlabel_dialects::{Dialect, KeyframeLabels, LabelSet};
//! use occlabel_labels::LabelTree;
//!
//! let dialect = Dialect::named("surroundocc")?;
//! let spec = dialect.grid.spec()?;
//! let mut semantics = VoxelGrid::filled(&spec, dialect.classes.free_index());
//! semantics.values_mut()[7] = 4; // the class of index 4: car
//!
//! let folder = tempfile::tempdir().unwrap();
//! let labels = KeyframeLabels::of_semantics(spec, semantics);
//! for (path, bytes) in dialect.encode(&labels, "scene-0061", "3e8750f3")?.files {
//!     LabelTree::new(folder.path()).write(&path, &bytes)?;
//! }
//!
//! let set = LabelSet::open(folder.path(), None)?;
//! assert_eq!(set.dialect().name, "surroundocc");
//! assert_eq!(set.read(&set.keyframes()[0])?, labels);
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod annotations;
mod class_map;
mod class_table;
mod concepts;
mod decode;
pub mod describe;
mod dialect;
#[cfg(any(test, fuzzing))]
pub mod doors;
mod encode;
mod guess;
mod indices;
mod keyframe_labels;
mod label_set;
mod layout;
mod order;
mod path_pattern;
mod poses;
mod remark;
mod rows;
mod shipped;
mod values;

pub use annotations::{Annotations, CameraInfo, KeyframeInfo, scene_infos};
pub use class_map::{ClassMap, Reason};
pub use class_table::{Class, ClassTable};
pub use concepts::Concepts;
pub use dialect::{Dialect, DialectGrid};
pub use encode::{Encoded, Note};
pub use keyframe_labels::{IGNORED, KeyframeLabels, Wanted};
pub use label_set::{KeyframeKey, LabelSet};
pub use layout::{Array, Arrays, Bits, Column, Element, Holds, Layout, Rows, Table};
pub use order::{Axes, Axis, Order};
pub use path_pattern::PathPattern;
pub use poses::ScenePoses;
pub use remark::{Remark, RemarkKind};
