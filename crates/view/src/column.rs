//! What a column of voxels looks like from above.

use rayon::prelude::*;

use crate::painted::Painted;

/// A column as seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    /// No ray reached any of its voxels.
    Unobserved,
    /// Nothing stands in it, as far as is known; hidden if no camera sees any of it.
    Free { hidden: bool },
    /// Its topmost occupied voxel; hidden if no camera sees that.
    Occupied { class: u8, z: usize, hidden: bool },
}

impl Column {
    /// How many voxels reach up to its top, if it has one.
    pub(crate) fn top(self) -> Option<usize> {
        match self {
            Self::Occupied { z, .. } => Some(z + 1),
            _ => None,
        }
    }
}

/// All columns, `[x][y]`.
pub(crate) fn columns(labels: &Painted) -> Vec<Column> {
    let [nx, ny, nz] = labels.spec.shape();
    let cameras = labels.has_cameras();
    let column = |at: usize| look_down(labels, at * nz..(at + 1) * nz, cameras);
    (0..nx * ny).into_par_iter().map(column).collect()
}

fn look_down(labels: &Painted, voxels: std::ops::Range<usize>, cameras: bool) -> Column {
    let unseen = |flat: usize| cameras && labels.mask_camera.values()[flat] == 0;
    let bottom = voxels.start;
    let top = voxels.clone().rev().find_map(|flat| Some((flat, labels.class(flat)?)));
    match top {
        Some((flat, class)) => Column::Occupied { class, z: flat - bottom, hidden: unseen(flat) },
        None if voxels.clone().any(|flat| labels.observed(flat)) => {
            Column::Free { hidden: voxels.clone().all(unseen) }
        }
        None => Column::Unobserved,
    }
}
