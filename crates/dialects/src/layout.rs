//! Where the files of a keyframe stand, and what is in them: a closed set of kinds.

use occlabel_labels::NumberType;
use serde::Deserialize;

use crate::{Axes, Axis, Order};

/// What a keyframe's files look like.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Layout {
    /// One `.npz` file of arrays.
    Npz(Arrays),
    /// A file of bits or numbers for each array, without headers.
    VoxelFiles(Arrays),
    /// A file of (flat index, class) of what is not free, files of rows beside it, lists of indices.
    Indices(Arrays),
    /// One `.npy` file of rows: the coordinates of what is not free, and its class.
    Rows(Rows),
}

/// Arrays by their names in files.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arrays {
    /// The path of a keyframe's file from the set's root; see [`PathPattern`](crate::PathPattern).
    pub path: String,
    /// Files whose names end so are another dialect's.
    pub except: Option<String>,
    /// The axes of the arrays, the slowest first: `xyz` is our own order.
    #[serde(default)]
    pub axes: Axes,
    /// The axes along which index 0 lies at the upper end.
    #[serde(default)]
    pub reversed: Vec<Axis>,
    /// The arrays, as they follow each other in a file.
    pub arrays: Vec<Array>,
}

/// An array of a file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Array {
    /// Its name in the file, or in the path of its own file.
    pub name: String,
    /// What it says.
    pub holds: Holds,
    /// Of what it is written. (Any type that holds the values is read.)
    #[serde(rename = "type")]
    pub element: Element,
    /// Numbers for each voxel, in a last axis of their own; 0 means one, without such an axis.
    #[serde(default)]
    pub components: usize,
    /// Whether 1 says what is 0 everywhere else: an `invalid` is no `mask`.
    #[serde(default)]
    pub inverted: bool,
    /// Its shape, if it is none of voxels.
    pub shape: Option<Vec<usize>>,
    /// What is written everywhere if it is not known; without it, the array is left out then, and
    /// need not be there when read.
    pub neutral: Option<u8>,
}

/// What an array says.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(from = "String")]
pub enum Holds {
    /// The class of each voxel.
    Semantics,
    /// 1 where the lidars observed.
    MaskLidar,
    /// 1 where some camera sees it.
    MaskCamera,
    /// The number of the object.
    Instances,
    /// Velocity, metres per second.
    Flow,
    /// What only some dialects know, by the name that they share.
    Extra(String),
}

/// Of what an array is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
pub enum Element {
    /// A bit for each voxel, eight in a byte, the first in the highest.
    Bits(Bits),
    /// Numbers.
    Number(NumberType),
}

/// The one word `bits`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Bits {
    /// The word.
    Bits,
}

/// Rows of coordinates.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rows {
    /// The path of a keyframe's file from the set's root.
    pub path: String,
    /// The tables that there are, told apart by how many columns they have. The first without
    /// velocities is written, or the first with them where they are known.
    pub tables: Vec<Table>,
}

/// A table of rows.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// What stands in each column.
    pub columns: Vec<Column>,
    /// The type of every number.
    #[serde(rename = "type")]
    pub number: NumberType,
}

/// What stands in a column: an index along an axis, a velocity, a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "each is named for what it is")]
pub enum Column {
    X,
    Y,
    Z,
    Vx,
    Vy,
    Vz,
    Class,
}

impl Layout {
    /// The path of a keyframe's files.
    pub fn path(&self) -> &str {
        match self {
            Self::Npz(files) | Self::VoxelFiles(files) | Self::Indices(files) => &files.path,
            Self::Rows(rows) => &rows.path,
        }
    }

    /// How the names of files end that only look like this dialect's.
    pub(crate) fn except(&self) -> Option<&str> {
        match self {
            Self::Npz(files) | Self::VoxelFiles(files) | Self::Indices(files) => {
                files.except.as_deref()
            }
            Self::Rows(_) => None,
        }
    }

    /// The arrays; none where there are rows.
    pub fn arrays(&self) -> &[Array] {
        match self {
            Self::Npz(files) | Self::VoxelFiles(files) | Self::Indices(files) => &files.arrays,
            Self::Rows(_) => &[],
        }
    }

    /// The order of the voxels; ours where each has its coordinates.
    pub fn order(&self) -> Order {
        match self {
            Self::Npz(files) | Self::VoxelFiles(files) | Self::Indices(files) => files.order(),
            Self::Rows(_) => Order::default(),
        }
    }

    /// Whether every table of rows says where its voxels are and what they hold.
    pub(crate) fn has_all_columns(&self) -> bool {
        let needed = [Column::X, Column::Y, Column::Z, Column::Class];
        let is_whole = |table: &Table| needed.iter().all(|&it| table.column(it).is_some());
        match self {
            Self::Rows(rows) => !rows.tables.is_empty() && rows.tables.iter().all(is_whole),
            _ => true,
        }
    }

    /// The name of the array of classes.
    pub(crate) fn semantics_name(&self) -> &str {
        let array = self.arrays().iter().find(|array| array.holds == Holds::Semantics);
        array.map_or("", |array| &array.name)
    }
}

impl Arrays {
    /// The order of the voxels.
    pub fn order(&self) -> Order {
        Order { axes: self.axes, reversed: self.reversed.clone() }
    }
}

impl Array {
    /// Whether it must be there.
    pub fn is_required(&self) -> bool {
        self.holds == Holds::Semantics || self.neutral.is_some()
    }
}

impl Table {
    /// The place of a column.
    pub fn column(&self, column: Column) -> Option<usize> {
        self.columns.iter().position(|&at| at == column)
    }
}

impl From<String> for Holds {
    fn from(text: String) -> Self {
        match text.as_str() {
            "semantics" => Self::Semantics,
            "mask_lidar" => Self::MaskLidar,
            "mask_camera" => Self::MaskCamera,
            "instances" => Self::Instances,
            "flow" => Self::Flow,
            _ => Self::Extra(text),
        }
    }
}
