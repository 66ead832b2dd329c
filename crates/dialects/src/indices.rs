//! Flat indices: (index, class) of each voxel that is not free, files of rows beside them, and lists
//! of the voxels of which something holds.

use occlabel_core::{Fault, VoxelGrid};
use occlabel_disk as disk;
use occlabel_labels::{NumberArray, read_npy};

use crate::decode::{Found, fault};
use crate::encode::Files;
use crate::values::{self, Refusal};
use crate::{Array, Holds, KeyframeLabels};

/// The numbers of a row of indices, and of the widest row beside it.
const MAX_ROW_BYTES: u64 = 24;

impl Found<'_> {
    /// The labels of a keyframe's files of indices.
    pub(crate) fn indices(&self, arrays: &[Array]) -> Result<KeyframeLabels, Fault> {
        let mut labels = self.empty();
        let places: Vec<usize> = self.order.places(self.spec.shape()).collect();
        let mut rows = Vec::new();
        for array in arrays {
            let place = (self.places)(&array.name);
            if !array.is_required() && !disk::exists(&place) {
                continue;
            }
            let numbers = read_npy(&place, self.spec.len() as u64 * MAX_ROW_BYTES)?;
            let taken = match array.holds {
                Holds::Semantics => {
                    self.classed(&mut labels, &places, &numbers).map(|voxels| rows = voxels)
                }
                Holds::Flow if self.wanted.flow => self.moving(&mut labels, &rows, &numbers),
                Holds::MaskLidar => self.listed(&mut labels, array, &places, &numbers),
                _ => Ok(()),
            };
            taken.map_err(|refusal| fault(&place, "", refusal))?;
        }
        Ok(labels)
    }

    /// The classes of the voxels of (index, class), and the voxel of each row.
    fn classed(
        &self,
        labels: &mut KeyframeLabels,
        places: &[usize],
        numbers: &NumberArray,
    ) -> Result<Vec<usize>, Refusal> {
        if !matches!(numbers.shape[..], [_, 2]) {
            return Err(("rows of index and class", format!("{:?}", numbers.shape)));
        }
        let pairs = values::whole(numbers)?;
        let (pairs, _) = pairs.as_chunks::<2>();
        let ids: Vec<i64> = pairs.iter().map(|[_, id]| *id).collect();
        let classes = values::classes(self.classes, &NumberArray::new(&[ids.len()], &ids))?;
        let voxels = pairs.iter().map(|[index, _]| voxel(places, *index));
        let voxels: Vec<usize> = voxels.collect::<Result<_, _>>()?;
        for (&flat, &class) in voxels.iter().zip(&classes) {
            labels.semantics.values_mut()[flat] = class;
        }
        Ok(voxels)
    }

    fn moving(
        &self,
        labels: &mut KeyframeLabels,
        rows: &[usize],
        numbers: &NumberArray,
    ) -> Result<(), Refusal> {
        let [count, components @ (2 | 3)] = numbers.shape[..] else {
            return Err(("rows of velocities", format!("{:?}", numbers.shape)));
        };
        if count != rows.len() {
            return Err(("a row for each voxel", format!("{count} for {} voxels", rows.len())));
        }
        let mut flow = VoxelGrid::filled(self.spec, [0.0; 3]);
        for (&flat, velocity) in rows.iter().zip(values::flow(numbers, components)) {
            flow.values_mut()[flat] = velocity;
        }
        labels.flow = Some(flow);
        Ok(())
    }

    /// A mask that is 1 in the voxels of a list, or 0 if it is inverted.
    fn listed(
        &self,
        labels: &mut KeyframeLabels,
        array: &Array,
        places: &[usize],
        numbers: &NumberArray,
    ) -> Result<(), Refusal> {
        let mut mask = VoxelGrid::filled(self.spec, u8::from(array.inverted));
        for index in values::whole(numbers)? {
            mask.values_mut()[voxel(places, index)?] = u8::from(!array.inverted);
        }
        labels.mask_lidar = Some(mask);
        Ok(())
    }
}

impl Files<'_> {
    /// The files of indices, in the file's order of voxels.
    pub(crate) fn indices(&mut self, arrays: &[Array]) -> Result<(), Fault> {
        let labels = self.labels;
        let places: Vec<usize> = self.order.places(labels.spec.shape()).collect();
        let semantics = labels.semantics.values();
        let written =
            |(_, flat): &(usize, &usize)| self.dialect.classes.is_written(semantics[**flat]);
        let rows: Vec<(usize, usize)> =
            places.iter().enumerate().filter(written).map(|(at, &flat)| (at, flat)).collect();
        for array in arrays {
            match self.index_file(array, &places, &rows) {
                Some(numbers) => self.add(&array.name, numbers.to_npy())?,
                None => self.left_out(array),
            }
        }
        Ok(())
    }

    fn index_file(
        &self,
        array: &Array,
        places: &[usize],
        rows: &[(usize, usize)],
    ) -> Option<NumberArray> {
        let labels = self.labels;
        let number = array.number();
        Some(match array.holds {
            Holds::Semantics => {
                let ids = values::ids(&self.dialect.classes, labels.semantics.values());
                let pairs = rows.iter().flat_map(|&(at, flat)| [at as f64, ids[flat] as f64]);
                NumberArray::of_floats(number, &[rows.len(), 2], &pairs.collect::<Vec<_>>())
            }
            Holds::Flow => {
                let flow = labels.flow.as_ref()?.values();
                let parts = rows.iter().flat_map(|&(_, flat)| &flow[flat][..array.components]);
                let parts: Vec<f64> = parts.map(|&part| f64::from(part)).collect();
                NumberArray::of_floats(number, &[rows.len(), array.components], &parts)
            }
            Holds::MaskLidar => {
                let mask = labels.mask_lidar.as_ref()?.values();
                let listed = u8::from(!array.inverted);
                let places = places.iter().enumerate();
                let indices = places.filter(|(_, flat)| mask[**flat] == listed);
                let indices: Vec<f64> = indices.map(|(at, _)| at as f64).collect();
                NumberArray::of_floats(number, &[indices.len()], &indices)
            }
            _ => return None,
        })
    }
}

/// The voxel of a flat index of the file.
fn voxel(places: &[usize], index: i64) -> Result<usize, Refusal> {
    let flat = usize::try_from(index).ok().and_then(|index| places.get(index));
    flat.copied().ok_or_else(|| ("indices of the grid", index.to_string()))
}
