//! A label grid that rays are cast into.

use occlabel_core::{Fault, GridSpec, VoxelGrid};

use super::columns::Columns;

/// A label grid that rays are cast into.
///
/// A voxel is occupied if its class is below `free`. What has no label (255) stops no ray.
#[derive(Clone, Debug)]
pub struct RayGrid<'a> {
    pub(super) spec: &'a GridSpec,
    pub(super) semantics: &'a [u8],
    pub(super) free: u8,
    pub(super) columns: Columns,
}

impl<'a> RayGrid<'a> {
    /// Makes a grid of classes ready; `free` is the class of free voxels, and the number of classes.
    ///
    /// # Errors
    /// If the grid is not of the shape that `spec` says.
    pub fn new(spec: &'a GridSpec, semantics: &'a VoxelGrid<u8>, free: u8) -> Result<Self, Fault> {
        if semantics.shape() != spec.shape() {
            let [expected, found] = [spec.shape(), semantics.shape()];
            let found = format!("{found:?}");
            return Err(Fault::new("ray-grid", "semantics", format!("{expected:?} voxels"), found));
        }
        let semantics = semantics.values();
        Ok(Self { spec, semantics, free, columns: Columns::new(spec, semantics, free) })
    }

    /// The class of the voxel at a place of the flat array.
    #[inline]
    pub fn class(&self, flat: usize) -> u8 {
        self.semantics[flat]
    }

    #[inline]
    pub(super) fn is_occupied(&self, flat: usize) -> bool {
        self.semantics[flat] < self.free
    }
}
