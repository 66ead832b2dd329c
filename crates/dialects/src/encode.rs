//! From labels to the files of a keyframe.

use std::collections::BTreeSet;
use std::fmt;

use occlabel_core::{Fault, VoxelGrid};
use occlabel_labels::{NumberArray, NumberType, TreePath, npz};

use crate::{
    Array, Dialect, Element, Holds, IGNORED, KeyframeLabels, Layout, Order, PathPattern, values,
};

/// The files of a keyframe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Encoded {
    /// The bytes of each.
    pub files: Vec<(TreePath, Vec<u8>)>,
    /// What the files do not say as the labels do.
    pub notes: BTreeSet<Note>,
}

/// What files do not say as the labels do.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Note {
    /// An array that the dialect needs and the labels do not know has this value everywhere.
    Assumed {
        /// Its name in the file.
        array: String,
        /// The value, as the file has it.
        value: u8,
    },
    /// An array of the dialect that the labels do not know is not there.
    LeftOut {
        /// Its name in the file.
        array: String,
    },
    /// The labels know something that the dialect has no array for.
    Lost {
        /// What it is.
        what: String,
    },
    /// Voxels without a label became free, as the dialect has no id for them.
    Unlabelled,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Assumed { array, value } => {
                write!(f, "{array}: not known, written as {value} everywhere")
            }
            Self::LeftOut { array } => write!(f, "{array}: not known, left out"),
            Self::Lost { what } => write!(f, "{what}: the dialect has no words for it, left out"),
            Self::Unlabelled => write!(f, "semantics: voxels without a label are written as free"),
        }
    }
}

impl Dialect {
    /// The files that say these labels: the same bytes each time.
    ///
    /// # Errors
    /// If the scene or the token is no plain name, or an extra has another shape than the dialect's.
    ///
    /// # Panics
    /// If `semantics` holds an index of no class of this dialect.
    pub fn encode(
        &self,
        labels: &KeyframeLabels,
        scene: &str,
        token: &str,
    ) -> Result<Encoded, Fault> {
        let order = self.layout.order();
        let encoded = Encoded { files: Vec::new(), notes: self.lost(labels) };
        let mut files = Files { dialect: self, labels, order, scene, token, encoded };
        match &self.layout {
            Layout::Npz(arrays) => files.npz(&arrays.arrays)?,
            Layout::VoxelFiles(arrays) => files.voxel_files(&arrays.arrays)?,
            Layout::Indices(arrays) => files.indices(&arrays.arrays)?,
            Layout::Rows(rows) => {
                let table = rows.table_for(labels).encode(labels, &self.classes);
                files.add("", table.to_npy())?;
            }
        }
        Ok(files.encoded)
    }

    /// The file that says the classes of a keyframe.
    ///
    /// # Errors
    /// If the scene or the token is no plain name.
    pub fn semantics_path(&self, scene: &str, token: &str) -> Result<TreePath, Fault> {
        let layout = &self.layout;
        PathPattern::new(layout.path(), layout.semantics_name()).tree_path(scene, token)
    }

    /// What the labels know and the dialect cannot say.
    fn lost(&self, labels: &KeyframeLabels) -> BTreeSet<Note> {
        let named = [
            (labels.mask_lidar.is_some(), Holds::MaskLidar, "mask_lidar"),
            (labels.mask_camera.is_some(), Holds::MaskCamera, "mask_camera"),
            (labels.instances.is_some(), Holds::Instances, "instances"),
            (labels.flow.is_some(), Holds::Flow, "flow"),
        ];
        let named =
            named.into_iter().filter(|(is_known, holds, _)| *is_known && !self.can_say(holds));
        let extras = labels.extras.keys();
        let extras = extras.filter(|name| !self.can_say(&Holds::Extra((*name).clone())));
        let lost = named.map(|(_, _, what)| what.to_owned()).chain(extras.cloned());
        let mut notes: BTreeSet<Note> = lost.map(|what| Note::Lost { what }).collect();
        if self.classes.no_label.is_none() && labels.semantics.values().contains(&IGNORED) {
            notes.insert(Note::Unlabelled);
        }
        notes
    }
}

/// The files of a keyframe being written.
pub(crate) struct Files<'a> {
    pub(crate) dialect: &'a Dialect,
    pub(crate) labels: &'a KeyframeLabels,
    pub(crate) order: Order,
    scene: &'a str,
    token: &'a str,
    encoded: Encoded,
}

impl Files<'_> {
    fn npz(&mut self, arrays: &[Array]) -> Result<(), Fault> {
        let mut written = Vec::new();
        for array in arrays {
            match self.numbers(array)? {
                Some(numbers) => written.push((array.name.as_str(), numbers)),
                None => self.left_out(array),
            }
        }
        self.add("", npz(written.iter().map(|(name, numbers)| (*name, numbers))))
    }

    fn voxel_files(&mut self, arrays: &[Array]) -> Result<(), Fault> {
        for array in arrays {
            match (self.numbers(array)?, array.element) {
                (Some(bits), Element::Bits(_)) => {
                    self.add(&array.name, values::pack(&bits.bytes))?
                }
                (Some(numbers), Element::Number(_)) => self.add(&array.name, numbers.bytes)?,
                (None, _) => self.left_out(array),
            }
        }
        Ok(())
    }

    /// Adds a file, for an array of a name.
    pub(crate) fn add(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), Fault> {
        let pattern = PathPattern::new(self.dialect.layout.path(), name);
        self.encoded.files.push((pattern.tree_path(self.scene, self.token)?, bytes));
        Ok(())
    }

    /// Notes that an array is not known.
    pub(crate) fn left_out(&mut self, array: &Array) {
        self.encoded.notes.insert(Note::LeftOut { array: array.name.clone() });
    }

    /// The numbers of an array in the file's order, or the neutral ones; `None` to leave it out.
    fn numbers(&mut self, array: &Array) -> Result<Option<NumberArray>, Fault> {
        let numbers = match (self.known(array), array.neutral) {
            (Some(numbers), _) => numbers,
            (None, Some(neutral)) => {
                let value = neutral ^ u8::from(array.inverted);
                let array_name = array.name.clone();
                self.encoded.notes.insert(Note::Assumed { array: array_name, value });
                self.everywhere(array, value)
            }
            (None, None) => return Ok(None),
        };
        self.check(array, &numbers)?;
        let item = numbers.number.size() * array.components.max(1);
        Ok(Some(match array.shape {
            Some(_) => numbers,
            None => {
                let shape = self.labels.spec.shape();
                let sides = self.order.file_shape(shape);
                let bytes = self.order.to_file(shape, item, numbers.bytes);
                let shape = [&sides[..], &numbers.shape[3..]].concat();
                NumberArray { bytes, shape, ..numbers }
            }
        }))
    }

    /// What the labels know of an array, in our order.
    fn known(&self, array: &Array) -> Option<NumberArray> {
        let labels = self.labels;
        let shape = labels.spec.shape();
        let mask = |mask: &VoxelGrid<u8>| {
            let flip = u8::from(array.inverted);
            let mask: Vec<u8> = mask.values().iter().map(|value| value ^ flip).collect();
            NumberArray::new(&shape, &mask)
        };
        match &array.holds {
            Holds::Semantics => {
                let ids = values::ids(&self.dialect.classes, labels.semantics.values());
                Some(NumberArray::of_whole(array.number(), &shape, &ids))
            }
            Holds::MaskLidar => labels.mask_lidar.as_ref().map(mask),
            Holds::MaskCamera => labels.mask_camera.as_ref().map(mask),
            Holds::Instances => {
                labels.instances.as_ref().map(|grid| NumberArray::new(&shape, grid.values()))
            }
            Holds::Flow => {
                let flow = labels.flow.as_ref()?.values();
                let parts: Vec<f32> =
                    flow.iter().flat_map(|flow| &flow[..array.components]).copied().collect();
                Some(NumberArray::new(&array.shape_of(shape), &parts))
            }
            Holds::Extra(name) => labels.extras.get(name).cloned(),
        }
    }

    fn everywhere(&self, array: &Array, value: u8) -> NumberArray {
        let shape = array.shape_of(self.labels.spec.shape());
        let count = shape.iter().product();
        NumberArray::of_whole(array.number(), &shape, &vec![i64::from(value); count])
    }

    /// Refuses an extra that has another shape here than where it came from.
    fn check(&self, array: &Array, numbers: &NumberArray) -> Result<(), Fault> {
        let shape = array.shape_of(self.labels.spec.shape());
        if numbers.shape == shape {
            return Ok(());
        }
        let (expected, found) = (format!("{shape:?}"), format!("{:?}", numbers.shape));
        Err(Fault::new("extra", &self.dialect.name, expected, found).record(&array.name))
    }
}

impl Array {
    /// The type of its numbers; bits are bytes until they are packed.
    pub(crate) fn number(&self) -> NumberType {
        match self.element {
            Element::Bits(_) => NumberType::U8,
            Element::Number(number) => number,
        }
    }

    /// Its shape in our order.
    fn shape_of(&self, shape: [usize; 3]) -> Vec<usize> {
        match (&self.shape, self.components) {
            (Some(shape), _) => shape.clone(),
            (None, 0) => shape.to_vec(),
            (None, components) => [&shape[..], &[components]].concat(),
        }
    }
}
