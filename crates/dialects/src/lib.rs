//! Label files of every dialect: their classes, their layouts, and what one can say that another
//! cannot.
//!
//! Label sets differ in frame, order of axes, resolution, class ids and the meaning of zero. A
//! [`Dialect`] says all that as data, in a file of `configs/dialects/`. A [`LabelSet`] is a folder of
//! keyframes in one of them; read, its labels are [`KeyframeLabels`], the same for all dialects:
//! `[x][y][z]` from the lower corner, classes counted from 0, free the number after the last.
//! [`Dialect::encode`] is the way back.

mod class_table;
mod decode;
mod dialect;
mod encode;
mod guess;
mod indices;
mod keyframe_labels;
mod label_set;
mod layout;
mod order;
mod path_pattern;
mod poses;
mod rows;
mod shipped;
mod values;

pub use class_table::{Class, ClassTable};
pub use dialect::{Dialect, DialectGrid};
pub use encode::{Encoded, Note};
pub use keyframe_labels::{IGNORED, KeyframeLabels, Wanted};
pub use label_set::{KeyframeKey, LabelSet};
pub use layout::{Array, Arrays, Bits, Column, Element, Holds, Layout, Rows, Table};
pub use order::{Axes, Axis, Order};
pub use path_pattern::PathPattern;
pub use poses::ScenePoses;
