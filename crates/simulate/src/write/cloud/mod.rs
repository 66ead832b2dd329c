//! Logs of reconstructed clouds: what a drive's cameras make of it, without any lidar.
//!
//! ```text
//!   <scene>/cloud.ply            f32 x, y, z in world, u8 class
//!   <scene>/objects/<track>.ply  the same in the coordinates of the track's box
//!   <scene>/classes.json         names of classes by number
//!   <scene>/poses.txt            keyframes: timestamp tx ty tz qx qy qz qw
//!   <scene>/cameras.json         lenses, mountings, all exposures
//!   <scene>/tracks.json          boxes
//! ```

mod clouds;
mod tables;

use occlabel_core::{Fault, Taxonomy};

use super::files::Output;
use super::raw_names::RawNames;
use super::written::Written;
use crate::Drive;
use clouds::Clouds;
use tables::{cameras, classes, poses, tracks};

/// Writes the clouds of a drive, and what belongs to them. To be finished with the entry that is returned.
///
/// What moves without a box stays where each exposure saw it.
///
/// # Errors
/// If a byte cannot number the taxonomy's names, or a file cannot be written.
pub fn write_cloud(
    drive: &Drive,
    taxonomy: &Taxonomy,
    output: &Output,
) -> Result<(Written, String), Fault> {
    let scene = drive.scene();
    let names = RawNames::new(std::slice::from_ref(drive), taxonomy)?;
    let points = Clouds::of(drive, &names).write(drive, output)?;
    let file = |name: &str| format!("{}/{name}", scene.name);
    let text = |value: serde_json::Value| format!("{value:#}\n").into_bytes();
    output.write(&file("classes.json"), &text(classes(&names)))?;
    output.write(&file("cameras.json"), &text(cameras(drive, output)?))?;
    output.write(&file("tracks.json"), &text(tracks(drive)))?;
    output.write(&file("poses.txt"), poses(drive).as_bytes())?;
    let boxes = scene.tracks.iter().map(|track| track.boxes.len()).sum();
    let keyframes = scene.keyframes.len();
    let written = Written { scenes: 1, points, keyframes, boxes, ..Written::default() };
    Ok((written, scene.name.clone()))
}
