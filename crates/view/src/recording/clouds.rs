//! Points: the centres of occupied voxels, and sweeps.

use foxglove::messages::PointCloud as CloudMessage;
use occlabel_core::{Palette, PointCloud, PointLabel, Pose, SweepHeader, Timestamp};

use crate::rows::{COLOR, Kind, POSITION, Rows, occupied_rows};
use crate::{NO_LABEL, ShownKeyframe, ShownScene};

use super::GRID;
use super::common::{fields, pose, stamp};

/// The colour of points without a class.
const GREY: [u8; 3] = [128; 3];

/// The centres of a keyframe's occupied voxels.
pub(super) fn voxels(
    time: Timestamp,
    keyframe: &ShownKeyframe,
    scene: &ShownScene,
) -> CloudMessage {
    cloud(time, GRID, occupied_rows(keyframe, scene))
}

/// A sweep's points in the frame of its lidar.
pub(super) fn sweep(
    header: &SweepHeader,
    cloud_of: &PointCloud<PointLabel>,
    palette: &Palette,
) -> CloudMessage {
    let label = header.labelled.then_some([("label", Kind::U8)].into_iter().chain(COLOR));
    let mut rows = Rows::new(POSITION.into_iter().chain(label.into_iter().flatten()));
    for (position, label) in cloud_of.positions.iter().zip(&cloud_of.labels) {
        rows.position(position.coords.into());
        if header.labelled {
            let (class, color) = match label {
                PointLabel::Class(class) => (class.0, palette.color(class.0)),
                PointLabel::Ignored | PointLabel::Unlabelled => (NO_LABEL, GREY),
            };
            rows.byte(class);
            rows.color(color);
        }
    }
    cloud(header.time, &header.lidar, rows)
}

fn cloud(time: Timestamp, frame: &str, rows: Rows) -> CloudMessage {
    CloudMessage {
        timestamp: Some(stamp(time)),
        frame_id: frame.to_owned(),
        pose: Some(pose(&Pose::identity())),
        point_stride: rows.stride(),
        fields: fields(&rows.columns),
        data: rows.bytes.into(),
    }
}
