//! What a column of voxels looks like from above.

use rayon::prelude::*;

use crate::picture::painted::Painted;

/// A column as seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    /// No ray reached any of its voxels.
    Unobserved,
    /// The file has no label of some of its voxels, and nothing is known of the others.
    Unlabelled,
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

    /// Of several columns drawn as one pixel the one with the greatest rank shows.
    pub(crate) fn rank(self) -> usize {
        match self {
            Self::Unobserved => 0,
            Self::Unlabelled => 1,
            Self::Free { .. } => 2,
            Self::Occupied { z, .. } => 3 + z,
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
    let unseen = |flat: usize| cameras && labels.unseen(flat);
    let bottom = voxels.start;
    let top = voxels.clone().rev().find_map(|flat| Some((flat, labels.class(flat)?)));
    match top {
        Some((flat, class)) => Column::Occupied { class, z: flat - bottom, hidden: unseen(flat) },
        None if voxels.clone().any(|flat| labels.observed(flat)) => {
            Column::Free { hidden: voxels.clone().all(unseen) }
        }
        None if voxels.clone().any(|flat| labels.unlabelled(flat)) => Column::Unlabelled,
        None => Column::Unobserved,
    }
}

#[cfg(test)]
mod tests {
    use occlabel_core::{GridSpec, Palette, VoxelGrid};

    use super::*;
    use crate::NO_LABEL;

    const FREE: u8 = 9;

    /// The look of one column of four voxels, bottom first.
    fn look(semantics: [u8; 4], lidar: [u8; 4], camera: [u8; 4], cameras: bool) -> Column {
        let spec = GridSpec::new([0.0; 3], [1.0, 2.0, 4.0], [1.0; 3]).unwrap();
        let grid = |values: [u8; 4], other: u8| {
            VoxelGrid::from_values(&spec, [values, [other; 4]].concat())
        };
        let labels = Painted {
            spec: &spec,
            semantics: &grid(semantics, FREE),
            mask_lidar: Some(&grid(lidar, 0)),
            mask_camera: Some(&grid(camera, u8::from(cameras))),
            free: FREE,
            palette: &Palette::of(&["a"]),
            heading_rad: Some(0.0),
        };
        columns(&labels)[0]
    }

    #[test]
    fn the_topmost_occupied_voxel_stands_for_its_column() {
        let column = |camera| look([3, FREE, 4, FREE], [1; 4], camera, true);
        let seen = Column::Occupied { class: 4, z: 2, hidden: false };
        assert_eq!(column([0, 0, 1, 0]), seen);
        assert_eq!(column([1, 1, 0, 1]), Column::Occupied { class: 4, z: 2, hidden: true });
        assert_eq!(seen.top(), Some(3));
    }

    #[test]
    fn an_empty_column_is_free_as_soon_as_one_voxel_was_observed() {
        let column = |lidar, camera| look([FREE; 4], lidar, camera, true);
        assert_eq!(column([0; 4], [0; 4]), Column::Unobserved);
        assert_eq!(column([0, 1, 0, 0], [0, 1, 0, 0]), Column::Free { hidden: false });
        assert_eq!(column([0, 1, 0, 0], [0; 4]), Column::Free { hidden: true });
    }

    #[test]
    fn a_column_without_labels_is_not_one_without_rays() {
        let column = |semantics| look(semantics, [0, 0, 1, 0], [0; 4], false);
        assert_eq!(column([NO_LABEL; 4]), Column::Unlabelled);
        assert_eq!(column([FREE, FREE, NO_LABEL, FREE]), Column::Unlabelled);
        assert_eq!(column([NO_LABEL, NO_LABEL, FREE, FREE]), Column::Free { hidden: false });
    }

    #[test]
    fn without_cameras_nothing_is_hidden_from_them() {
        let column = look([3, FREE, FREE, FREE], [1; 4], [0; 4], false);
        assert_eq!(column, Column::Occupied { class: 3, z: 0, hidden: false });
    }
}
