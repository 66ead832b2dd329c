//! Label files of every dialect: their classes, their layouts, and what one can say that another
//! cannot.
//!
//! Label sets differ in frame, order of axes, resolution, class ids and the meaning of zero. A
//! [`Dialect`] says all that as data, in a file of `configs/dialects/`. A [`LabelSet`] is a folder of
//! keyframes in one of them; read, its labels are [`KeyframeLabels`], the same for all dialects:
//! `[x][y][z]` from the lower corner, classes counted from 0, free the number after the last.

mod class_map;
mod class_table;
mod concepts;
pub mod describe;
mod dialect;
mod keyframe_labels;
mod label_set;
mod remark;

pub use class_map::{ClassMap, Reason};
pub use class_table::{Class, ClassTable};
pub use concepts::Concepts;
pub use dialect::{Dialect, DialectGrid};
pub use keyframe_labels::{IGNORED, KeyframeLabels};
pub use label_set::{KeyframeKey, LabelSet};
pub use remark::{Remark, RemarkKind};
