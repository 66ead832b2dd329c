//! From the files of a keyframe to its labels.

use std::path::{Path, PathBuf};

use occlabel_core::{Fault, GridSpec, VoxelGrid};
use occlabel_disk as disk;
use occlabel_labels::{NpzFile, NumberArray, NumberType, read_bounded};

use crate::values::{self, Refusal};
use crate::{
    Array, ClassTable, Dialect, DialectGrid, Element, Holds, KeyframeLabels, Layout, Order, Wanted,
};

/// Largest npz file per voxel: numbers of 8 bytes, flow and extras, undeflated.
const MAX_FILE_BYTES_PER_VOXEL: u64 = 128;

/// What an npz file may hold beside arrays of voxels.
const MAX_OTHER_BYTES: u64 = 1 << 26;

/// Most voxels of a grid whose shape only a file tells: 1.6 times those of Occ3D-Waymo's fine one.
const MAX_TOLD_VOXELS: usize = 1 << 28;

/// Where the file of an array stands, by the array's name.
pub(crate) type Places<'a> = &'a dyn Fn(&str) -> PathBuf;

impl Dialect {
    /// The labels in the files of a keyframe.
    pub(crate) fn decode(
        &self,
        places: Places<'_>,
        spec: &GridSpec,
        wanted: &Wanted,
    ) -> Result<KeyframeLabels, Fault> {
        let order = self.layout.order();
        let found = Found { places, spec, wanted, classes: &self.classes, order: &order };
        match &self.layout {
            Layout::Npz(files) => found.npz(&files.arrays),
            Layout::VoxelFiles(files) => found.voxel_files(&files.arrays),
            Layout::Indices(files) => found.indices(&files.arrays),
            Layout::Rows(rows) => found.rows(rows),
        }
    }

    /// The published limits, in as many voxels as a keyframe's file tells.
    pub(crate) fn told_spec(&self, places: Places<'_>) -> Result<GridSpec, Fault> {
        let published = self.grid.spec()?;
        let shape = self.shape_in(places)?.unwrap_or(published.shape());
        if shape == published.shape() {
            return Ok(published);
        }
        let DialectGrid { min_m, max_m, .. } = self.grid;
        let size_m = |axis: usize| (max_m[axis] - min_m[axis]) / shape[axis] as f64;
        let spec = GridSpec::new(min_m, max_m, [0, 1, 2].map(size_m))?;
        if spec.len() <= MAX_TOLD_VOXELS {
            return Ok(spec);
        }
        let (expected, found) = (format!("at most {MAX_TOLD_VOXELS} voxels"), format!("{shape:?}"));
        Err(Fault::new("grid", places("").display().to_string(), expected, found))
    }

    /// The shape of a keyframe's grid, where the file tells it.
    fn shape_in(&self, places: Places<'_>) -> Result<Option<[usize; 3]>, Fault> {
        let (Layout::Npz(_), name) = (&self.layout, self.layout.semantics_name()) else {
            return Ok(None);
        };
        let place = places(name);
        let header = NpzFile::open(&place, u64::MAX)?.header(name)?;
        let told =
            header.as_ref().map_or("none".to_owned(), |header| format!("{:?}", header.shape));
        match header.and_then(|header| <[usize; 3]>::try_from(header.shape).ok()) {
            Some(shape) => Ok(Some(self.layout.order().grid_shape(shape))),
            None => Err(fault(&place, name, ("an array of three axes", told))),
        }
    }
}

/// What it takes to read a keyframe.
pub(crate) struct Found<'a> {
    pub(crate) places: Places<'a>,
    pub(crate) spec: &'a GridSpec,
    pub(crate) wanted: &'a Wanted,
    pub(crate) classes: &'a ClassTable,
    pub(crate) order: &'a Order,
}

impl Found<'_> {
    fn npz(&self, arrays: &[Array]) -> Result<KeyframeLabels, Fault> {
        let place = (self.places)("");
        let voxels = self.spec.len() as u64;
        let mut file = NpzFile::open(&place, voxels * MAX_FILE_BYTES_PER_VOXEL + MAX_OTHER_BYTES)?;
        self.collect(arrays, |array| file.array(&array.name, self.max_bytes(array)))
    }

    fn voxel_files(&self, arrays: &[Array]) -> Result<KeyframeLabels, Fault> {
        self.collect(arrays, |array| {
            let place = (self.places)(&array.name);
            match disk::exists(&place) {
                true => self.voxel_file(array, &place).map(Some),
                false => Ok(None),
            }
        })
    }

    /// The labels of arrays that `read` brings.
    fn collect(
        &self,
        arrays: &[Array],
        mut read: impl FnMut(&Array) -> Result<Option<NumberArray>, Fault>,
    ) -> Result<KeyframeLabels, Fault> {
        let mut labels = self.empty();
        for array in arrays.iter().filter(|array| self.wants(array)) {
            let place = (self.places)(&array.name);
            let told = |refusal| fault(&place, &array.name, refusal);
            match read(array)? {
                Some(numbers) => self.take(&mut labels, array, numbers).map_err(told)?,
                None if array.is_required() => {
                    return Err(told(("an array of this name", "none".to_owned())));
                }
                None => {}
            }
        }
        Ok(labels)
    }

    /// Labels that are free everywhere, and say nothing else.
    pub(crate) fn empty(&self) -> KeyframeLabels {
        let free = VoxelGrid::filled(self.spec, self.classes.free_index());
        KeyframeLabels::of_semantics(self.spec.clone(), free)
    }

    fn wants(&self, array: &Array) -> bool {
        match array.holds {
            Holds::Semantics | Holds::MaskLidar | Holds::MaskCamera => true,
            Holds::Instances => self.wanted.instances,
            Holds::Flow => self.wanted.flow,
            Holds::Extra(_) => self.wanted.extras,
        }
    }

    /// What the numbers of an array may take at most.
    fn max_bytes(&self, array: &Array) -> u64 {
        let voxels = self.spec.len() * array.components.clamp(1, 3);
        let numbers = array.shape.as_ref().map_or(voxels, |shape| shape.iter().product());
        // Two components are declared where files may have three.
        (numbers * 8 * if array.components == 2 { 2 } else { 1 }) as u64
    }

    fn voxel_file(&self, array: &Array, place: &Path) -> Result<NumberArray, Fault> {
        let bytes = read_bounded(place, self.spec.len() as u64 * 8)?;
        let size = match array.element {
            Element::Bits(_) => self.spec.len().div_ceil(8),
            Element::Number(number) => self.spec.len() * number.size(),
        };
        if bytes.len() != size {
            let found = format!("{} bytes", bytes.len());
            let expected = format!("{size} bytes for {:?} voxels", self.spec.shape());
            return Err(Fault::new("voxel-file", place.display().to_string(), expected, found));
        }
        let shape = self.order.file_shape(self.spec.shape()).to_vec();
        Ok(match array.element {
            Element::Number(number) => NumberArray { number, shape, bytes },
            Element::Bits(_) => {
                let mut bytes = values::unpack(&bytes);
                bytes.truncate(self.spec.len());
                NumberArray { number: NumberType::U8, shape, bytes }
            }
        })
    }

    /// Takes the numbers of an array for what they mean.
    fn take(
        &self,
        labels: &mut KeyframeLabels,
        array: &Array,
        numbers: NumberArray,
    ) -> Result<(), Refusal> {
        let numbers = match array.shape {
            None => self.in_our_order(array, numbers)?,
            Some(_) => numbers,
        };
        let grid = |values| VoxelGrid::from_values(self.spec, values);
        match &array.holds {
            Holds::Semantics => labels.semantics = grid(values::classes(self.classes, &numbers)?),
            Holds::MaskLidar => {
                labels.mask_lidar = Some(grid(values::mask(numbers, array.inverted)?))
            }
            Holds::MaskCamera => {
                labels.mask_camera = Some(grid(values::mask(numbers, array.inverted)?));
            }
            Holds::Instances => {
                let instances = values::instances(&numbers)?;
                labels.instances = Some(VoxelGrid::from_values(self.spec, instances));
            }
            Holds::Flow => {
                let flow = values::flow(&numbers, numbers.shape[3]);
                labels.flow = Some(VoxelGrid::from_values(self.spec, flow));
            }
            Holds::Extra(name) => drop(labels.extras.insert(name.clone(), numbers)),
        }
        Ok(())
    }

    /// An array of voxels, its shape checked, in our own order.
    fn in_our_order(&self, array: &Array, numbers: NumberArray) -> Result<NumberArray, Refusal> {
        let sides = self.order.file_shape(self.spec.shape());
        let (voxels, last) = numbers.shape.split_at(numbers.shape.len().min(3));
        let components = match (array.components, last) {
            (0, []) => 1,
            (2 | 3, [two_or_three @ (2 | 3)]) => *two_or_three,
            _ => 0,
        };
        if voxels != sides || components == 0 {
            let expected = "an array of the grid's shape, with the components that the dialect has";
            return Err((expected, format!("{:?} for {sides:?}", numbers.shape)));
        }
        let item = numbers.number.size() * components;
        let shape = self.spec.shape();
        let bytes = self.order.to_ours(shape, item, numbers.bytes);
        Ok(NumberArray { bytes, shape: [&shape[..], last].concat(), ..numbers })
    }
}

/// A file whose numbers have no meaning.
pub(crate) fn fault(place: &Path, name: &str, (expected, found): Refusal) -> Fault {
    let fault = Fault::new("label-file", place.display().to_string(), expected, found);
    if name.is_empty() { fault } else { fault.record(name) }
}
