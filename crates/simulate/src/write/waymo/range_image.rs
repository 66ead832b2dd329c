//! Range images of a drive's sweeps.

use occlabel_core::Pose;

use crate::Drive;
use crate::rotation::roll_pitch_yaw;
use crate::write::points::{LoggedPoint, logged_points};

use super::ids;
use super::rig::RigLidar;

/// Values of a pixel: range, intensity, elongation, and whether it lies in a no-label zone.
pub(super) const PIXEL: usize = 4;
/// Values of a pixel's pose: roll, pitch, yaw, x, y, z of the vehicle in world.
pub(super) const POSE: usize = 6;
/// Values of a pixel's label: instance, class.
pub(super) const LABEL: usize = 2;

/// What the format has where there is no return, and in the last value where there is no zone.
const NONE: f32 = -1.0;
/// The intensity of every return: materials have none here.
const INTENSITY: f32 = 0.5;

/// One lidar's sweep as an image, all arrays by rows. There is one return a pixel.
pub(super) struct RangeImage {
    pub(super) lidar: u64,
    pub(super) size: [usize; 2],
    pub(super) pixels: Vec<f32>,
    /// Of TOP.
    pub(super) poses: Option<Vec<f32>>,
    /// Of TOP, where its sweep is labelled.
    pub(super) labels: Option<Vec<i32>>,
    /// Pixels with a return.
    pub(super) points: usize,
}

impl RangeImage {
    /// The image of a sweep of the drive's scene.
    pub(super) fn of(drive: &Drive, sweep: usize, lidar: &RigLidar) -> Self {
        let points = logged_points(drive, sweep);
        let labelled = lidar.is_top() && drive.scene().sweeps[sweep].labelled;
        Self {
            lidar: lidar.number,
            size: [lidar.rows.len(), lidar.columns.len()],
            pixels: pixels(&points, lidar),
            poses: lidar.is_top().then(|| poses(drive, sweep, lidar)),
            labels: labelled.then(|| labels(drive, &points, lidar)),
            points: points.len(),
        }
    }

    /// The second return of every pixel: none.
    pub(super) fn second_pixels(&self) -> Vec<f32> {
        vec![NONE; self.pixels.len()]
    }
}

fn pixels(points: &[LoggedPoint], lidar: &RigLidar) -> Vec<f32> {
    let returns = points.iter().map(|point| (point, [point.range_m, INTENSITY, 0.0, NONE]));
    image(returns, [NONE; PIXEL], lidar)
}

fn labels(drive: &Drive, points: &[LoggedPoint], lidar: &RigLidar) -> Vec<i32> {
    let label = |point: &LoggedPoint| {
        let track = point.mover.and_then(|mover| drive.track_of(mover));
        [track.map_or(0, |track| i32::from(track.0)), ids::class(point.label)]
    };
    image(points.iter().map(|point| (point, label(point))), [0; LABEL], lidar)
}

/// An image with the values of each point in its pixel.
fn image<'a, T: Copy, const N: usize>(
    points: impl Iterator<Item = (&'a LoggedPoint<'a>, [T; N])>,
    empty: [T; N],
    lidar: &RigLidar,
) -> Vec<T> {
    let width = lidar.columns.len();
    let mut pixels = vec![empty; lidar.rows.len() * width];
    for (point, values) in points {
        let (row, column) = (lidar.rows[usize::from(point.ring)], lidar.columns[point.shot]);
        pixels[row * width + column] = values;
    }
    pixels.concat()
}

/// Where the vehicle stood at each pixel, as far as the recorder moves points: pixels of a shot alike.
fn poses(drive: &Drive, sweep: usize, lidar: &RigLidar) -> Vec<f32> {
    let mut row = vec![[0.0; POSE]; lidar.columns.len()];
    for (shot, &column) in lidar.columns.iter().enumerate() {
        row[column] = pose_values(&world_from_ego(drive, sweep, shot));
    }
    row.concat().repeat(lidar.rows.len())
}

fn world_from_ego(drive: &Drive, sweep: usize, shot: usize) -> Pose {
    let header = &drive.scene().sweeps[sweep];
    let (lidar, number) = drive.taken_by(sweep);
    match drive.sweep_from_shot(sweep, lidar.shot_time(number, shot)) {
        None => header.world_from_ego,
        Some(now_from_then) => {
            header.world_from_lidar() * now_from_then * header.ego_from_lidar.inverse()
        }
    }
}

fn pose_values(pose: &Pose) -> [f32; POSE] {
    let [roll, pitch, yaw] = roll_pitch_yaw(&pose.rotation);
    let place = pose.translation.vector;
    [roll, pitch, yaw, place.x, place.y, place.z].map(|value| value as f32)
}
