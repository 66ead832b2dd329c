//! Logs as of the Waymo Open Dataset: v1 (TFRecord) and v2 (Parquet components).
//!
//! ```text
//!   v1   <scene>.tfrecord                 a `Frame` whenever a sweep begins
//!   v2   <component>/<scene>.parquet      the same, component by component
//! ```
//!
//! Every ray of a spinning lidar is a pixel: rows are its beams, columns its shots. Points come back
//! where they were measured but for the rounding of ranges, and of TOP's poses of pixels, to single
//! precision. For that, lidars are said to hang (`align`). Boxes stand upright in the vehicle.

mod align;
#[cfg(feature = "waymo-v2")]
mod component_columns;
#[cfg(feature = "waymo-v2")]
mod components;
mod frame;
mod ids;
mod message;
#[cfg(feature = "waymo-v2")]
mod parquet_table;
mod range_image;
mod rig;
mod rig_camera;
mod tfrecord;

use occlabel_core::Fault;

use crate::Drive;

use super::files::Output;
use super::written::Written;

#[cfg(feature = "waymo-v2")]
use components::Components;
use frame::frames;
use rig::Rig;
use tfrecord::write_record;

/// Writes a drive as v1. To be finished with the entry that is returned.
///
/// # Errors
/// If the format has no words for one of the world's sensors (rule `world`), or a file cannot be
/// written.
pub fn write_waymo(drive: &Drive, output: &Output) -> Result<(Written, String), Fault> {
    let rig = Rig::of(drive)?;
    let scene = drive.scene();
    let context = message::context(&scene.name, &rig);
    let name = format!("{}.tfrecord", scene.name);
    let mut file = output.stream(&name)?;
    let mut written = counts(drive);
    for frame in frames(drive, &rig) {
        write_record(&mut file, message::frame(&context, &rig, &frame).bytes())?;
        written += frame.counts();
    }
    file.finish()?;
    Ok((written, name))
}

/// Writes a drive as v2. To be finished with the entry that is returned.
///
/// # Errors
/// As [`write_waymo`]'s.
#[cfg(feature = "waymo-v2")]
pub fn write_waymo_v2(drive: &Drive, output: &Output) -> Result<(Written, String), Fault> {
    let rig = Rig::of(drive)?;
    let mut log = Components::create(&drive.scene().name, output)?;
    log.calibrations(&rig);
    let mut written = counts(drive);
    for frame in frames(drive, &rig) {
        log.frame(&rig, &frame)?;
        written += frame.counts();
    }
    log.finish()?;
    Ok((written, components::VEHICLE_POSE.to_owned()))
}

/// What is no frame's own.
fn counts(drive: &Drive) -> Written {
    Written { scenes: 1, keyframes: drive.scene().keyframes.len(), ..Written::default() }
}
