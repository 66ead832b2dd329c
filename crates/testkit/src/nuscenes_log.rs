//! Writes a simulated drive as a nuScenes v1.0 log.

use crate::categories::category_index;
use crate::drive::Drive;
use crate::lidar::{Return, sweep};
use crate::log_spec::{LogSpec, SweepSlot};
use crate::scene_rows::{PointCounts, push_scene_rows};
use crate::shared_rows::push_shared_rows;
use crate::table_set::TableSet;
use std::fs;
use std::io;
use std::path::Path;

/// The folder of the tables.
pub const VERSION: &str = "v1.0-mini";
/// The intensity of every return.
const INTENSITY: f32 = 40.0;

/// Writes a log under `root`, over what may be there. The same specification gives the same bytes.
pub fn write_log(root: &Path, spec: &LogSpec) -> io::Result<()> {
    let mut tables = TableSet::create(&root.join(VERSION), spec.labels)?;
    push_shared_rows(&mut tables, spec)?;
    for number in 0..spec.scenes {
        let drive = Drive::new(spec, number);
        let counts = if spec.point_scenes.contains(&number) {
            write_clouds(root, &drive)?
        } else {
            vec![vec![0; drive.street.tracks.len()]; spec.keyframes]
        };
        push_scene_rows(&mut tables, &drive, &counts)?;
    }
    tables.finish()
}

/// Writes the point and label files of a scene.
fn write_clouds(root: &Path, drive: &Drive) -> io::Result<PointCounts> {
    let mut counts = PointCounts::new();
    for (number, slot) in drive.slots.iter().enumerate() {
        let returns = returns_of(drive, slot);
        write_file(&root.join(drive.cloud_file(slot)), &cloud_bytes(&returns))?;
        if slot.is_key {
            counts.push(count_by_track(&returns, drive.street.tracks.len()));
        }
        if slot.is_key && drive.spec.labels {
            write_file(&root.join(drive.label_file(number)), &label_bytes(&returns))?;
        }
    }
    Ok(counts)
}

fn returns_of(drive: &Drive, slot: &SweepSlot) -> Vec<Return> {
    let world_from_ego = drive.world_from_ego(slot.offset_us);
    let street = drive.street.at(slot.time_s(), &world_from_ego);
    sweep(&street, &world_from_ego, &drive.spec.lidar)
}

/// Little-endian f32: x, y, z, intensity, ring.
fn cloud_bytes(returns: &[Return]) -> Vec<u8> {
    let fields = returns.iter().flat_map(|found| {
        let [x, y, z] = found.point_m;
        [x, y, z, INTENSITY, found.ring as f32]
    });
    fields.flat_map(f32::to_le_bytes).collect()
}

/// One byte a point: the lidarseg index.
fn label_bytes(returns: &[Return]) -> Vec<u8> {
    returns.iter().map(|found| category_index(found.hit.category) as u8).collect()
}

fn count_by_track(returns: &[Return], track_count: usize) -> Vec<usize> {
    let mut counts = vec![0; track_count];
    for track in returns.iter().filter_map(|found| found.hit.track) {
        counts[track] += 1;
    }
    counts
}

fn write_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, bytes)
}
