//! Labels as a dense grid.

use foxglove::messages::VoxelGrid as GridMessage;
use occlabel_core::{Pose, Timestamp};

use crate::rows::{COLOR, Column, Kind};
use crate::{ShownKeyframe, ShownScene};

use super::GRID;
use super::common::{fields, pose, stamp, vector};

const COLUMNS: [Column; 5] = [("label", Kind::U8), COLOR[0], COLOR[1], COLOR[2], COLOR[3]];

/// Every voxel: its label and colour; free and unlabelled ones are clear.
///
/// The message has x fastest and z slowest, where labels have z fastest.
pub(super) fn grid(time: Timestamp, keyframe: &ShownKeyframe, scene: &ShownScene) -> GridMessage {
    let cell: u32 = COLUMNS.iter().map(|(_, kind)| kind.bytes()).sum();
    let [columns, rows, _] = keyframe.spec.shape().map(|n| n as u32);
    GridMessage {
        timestamp: Some(stamp(time)),
        frame_id: GRID.to_owned(),
        pose: Some(pose(&Pose::translation(
            keyframe.spec.min_m().x,
            keyframe.spec.min_m().y,
            keyframe.spec.min_m().z,
        ))),
        row_count: rows,
        column_count: columns,
        cell_size: Some(vector(&keyframe.spec.size_m())),
        slice_stride: rows * columns * cell,
        row_stride: columns * cell,
        cell_stride: cell,
        fields: fields(&COLUMNS),
        data: cells(keyframe, scene).into(),
    }
}

fn cells(keyframe: &ShownKeyframe, scene: &ShownScene) -> Vec<u8> {
    let looks: Vec<[u8; 5]> = (0..=255).map(|label| look(label, scene)).collect();
    let [nx, ny, nz] = keyframe.spec.shape();
    let mut cells = Vec::with_capacity(keyframe.spec.len() * COLUMNS.len());
    for (z, y) in (0..nz).flat_map(|z| (0..ny).map(move |y| (z, y))) {
        let row = (0..nx).map(|x| looks[usize::from(*keyframe.semantics.at([x, y, z]))]);
        cells.extend(row.flatten());
    }
    cells
}

fn look(label: u8, scene: &ShownScene) -> [u8; 5] {
    match scene.is_occupied(label) {
        true => {
            let [red, green, blue] = scene.palette.color(label);
            [label, red, green, blue, 255]
        }
        false => [label, 0, 0, 0, 0],
    }
}

#[cfg(test)]
mod tests {
    use occlabel_core::{GridSpec, VoxelGrid, VoxelIndex};

    use super::*;
    use crate::testing::{shown_keyframe, shown_scene};

    #[test]
    fn cells_stand_where_the_schema_says_with_their_label_and_color() {
        let spec = GridSpec::new([1.0, -2.0, 0.0], [4.0, 2.0, 1.0], [1.0, 2.0, 0.5]).unwrap();
        let numbers = (0..spec.len() as u8).map(|flat| [0, 1, 2, 255][usize::from(flat) % 4]);
        let semantics = VoxelGrid::from_values(&spec, numbers.collect());
        let (scene, keyframe) = (shown_scene(), shown_keyframe(&spec, semantics.clone()));
        let message = grid(Timestamp(1_500_000_000), &keyframe, &scene);
        assert_eq!(message.timestamp.map(|at| (at.sec(), at.nsec())), Some((1, 500_000_000)));
        let (slice, row, cell) = (message.slice_stride, message.row_stride, message.cell_stride);
        for (byte, cells) in (0..).step_by(5).zip(message.data.chunks(5)) {
            let voxel = [byte % row / cell, byte % slice / row, byte / slice].map(i64::from);
            let label = semantics.values()[spec.flat(VoxelIndex(voxel)).unwrap()];
            let [red, green, blue] = scene.palette.color(label);
            let expected =
                if label < 2 { [label, red, green, blue, 255] } else { [label, 0, 0, 0, 0] };
            assert_eq!(cells, expected, "{voxel:?}");
        }
        assert_eq!((message.data.len(), message.column_count, message.row_count), (5 * 12, 3, 2));
    }
}
