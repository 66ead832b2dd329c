//! Logs in the layout of SemanticKITTI: one lidar, no boxes, no images.
//!
//! ```text
//!   sequences/00/velodyne/000000.bin     f32 x, y, z, remission
//!   sequences/00/labels/000000.label     u32 id | u32::from(instance) << 16, of labelled sweeps only
//!   sequences/00/poses.txt               camera_0 <- camera_i, 3 x 4 by rows
//!   sequences/00/calib.txt               Tr: camera <- lidar
//!   sequences/00/times.txt               seconds of the drive
//! ```
//!
//! The camera is a nominal one: above the ego's origin, as high as KITTI's own, looking ahead. So
//! `inverse(Tr) P Tr` moves points of a sweep into the first sweep's lidar frame, as everywhere in
//! KITTI, and Tr alone tells how the lidar is mounted.

mod ids;

use nalgebra::{Matrix4, Translation3};
use occlabel_core::{Fault, Pose, SweepHeader, Timestamp};

use crate::Drive;
use crate::camera::body_from_optical;

use super::files::Output;
use super::points::{LoggedPoint, logged_points, reference_sweeps};
use super::written::Written;

/// The entry that makes the log one.
const SEQUENCES: &str = "sequences";
/// How high KITTI's camera 0 stands above the road, metres (KITTI's drawing of the sensors' setup).
const CAMERA_HEIGHT_M: f64 = 1.65;
/// The remission of every return: materials have none here.
const REMISSION: f32 = 0.5;
/// What never leaves its first place by more is parked, metres.
const PARKED_M: f64 = 0.1;

/// Writes the sweeps of a drive's reference lidar. To be finished with the entry that is
/// returned.
///
/// # Errors
/// If the drive has no keyframe, or a file cannot be written.
pub fn write_semantickitti(
    drive: &Drive,
    output: &Output,
) -> Result<(Written, &'static str), Fault> {
    let sweeps = reference_sweeps(drive)?;
    let moving = moving(drive);
    let mut written = Written { scenes: 1, ..Written::default() };
    for (number, &sweep) in sweeps.iter().enumerate() {
        let points = logged_points(drive, sweep);
        output.write(&file("velodyne", number, "bin"), &cloud_bytes(&points))?;
        if drive.scene().sweeps[sweep].labelled {
            let labels = label_bytes(&points, drive, &moving);
            output.write(&file("labels", number, "label"), &labels)?;
            written.labelled += 1;
        }
        written.points += points.len();
    }
    written.sweeps = sweeps.len();
    written.keyframes = drive.scene().keyframes.len();
    let headers: Vec<_> = sweeps.iter().map(|&sweep| &drive.scene().sweeps[sweep]).collect();
    write_texts(&headers, output)?;
    Ok((written, SEQUENCES))
}

/// Whether each mover leaves its first place during the drive.
fn moving(drive: &Drive) -> Vec<bool> {
    let (world, sweeps) = (drive.world(), &drive.scene().sweeps);
    let moves = |mover: &crate::Mover| {
        let place_m = |sweep: &SweepHeader| {
            let time_s = sweep.time.seconds_since(Timestamp(0));
            mover.box_at(time_s, &world.ground).world_from_box.translation.vector
        };
        let first_m = sweeps.first().map(place_m);
        let left =
            |sweep| first_m.is_some_and(|first_m| (place_m(sweep) - first_m).norm() > PARKED_M);
        sweeps.iter().any(left)
    };
    world.movers.iter().map(moves).collect()
}

fn file(folder: &str, number: usize, ending: &str) -> String {
    format!("{SEQUENCES}/00/{folder}/{number:06}.{ending}")
}

fn cloud_bytes(points: &[LoggedPoint]) -> Vec<u8> {
    let columns = points.iter().flat_map(|point| {
        let [x, y, z] = point.position_m.into();
        [x, y, z, REMISSION]
    });
    columns.flat_map(f32::to_le_bytes).collect()
}

fn label_bytes(points: &[LoggedPoint], drive: &Drive, moving: &[bool]) -> Vec<u8> {
    let label = |point: &LoggedPoint| {
        let moves = point.mover.is_some_and(|mover| moving[mover]);
        let instance = point.mover.and_then(|mover| drive.track_of(mover)).map_or(0, |id| id.0);
        u32::from(ids::id(point.label, moves)) | u32::from(instance) << 16
    };
    points.iter().map(label).flat_map(u32::to_le_bytes).collect()
}

fn write_texts(sweeps: &[&SweepHeader], output: &Output) -> Result<(), Fault> {
    let ego_from_camera = Translation3::new(0.0, 0.0, CAMERA_HEIGHT_M) * body_from_optical();
    let camera_from_ego = ego_from_camera.inverse();
    let Some(first) = sweeps.first() else { return Ok(()) };
    let mut calib = String::new();
    for camera in 0..4 {
        calib += &format!("P{camera}: {}\n", row_text(&Pose::identity()));
    }
    calib += &format!("Tr: {}\n", row_text(&(camera_from_ego * first.ego_from_lidar)));
    let first_from_world = first.world_from_ego.inverse();
    let pose = |sweep: &&SweepHeader| {
        let first_from_now = first_from_world * sweep.world_from_ego;
        row_text(&(camera_from_ego * first_from_now * camera_from_ego.inverse())) + "\n"
    };
    let time = |sweep: &&SweepHeader| format!("{:e}\n", sweep.time.seconds_since(Timestamp(0)));
    let write = |name: &str, text: String| {
        output.write(&format!("{SEQUENCES}/00/{name}.txt"), text.as_bytes())
    };
    write("calib", calib)?;
    write("times", sweeps.iter().map(time).collect())?;
    write("poses", sweeps.iter().map(pose).collect())
}

/// The first three rows of a pose's matrix, each number with all its digits.
fn row_text(pose: &Pose) -> String {
    let matrix: Matrix4<f64> = pose.to_homogeneous();
    let numbers = (0..12).map(|at| format!("{:e}", matrix[(at / 4, at % 4)]));
    numbers.collect::<Vec<_>>().join(" ")
}
