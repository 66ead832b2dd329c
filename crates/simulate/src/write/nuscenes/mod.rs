//! Logs in the layout of nuScenes v1.0.
//!
//! ```text
//!   samples/LIDAR_TOP/street__LIDAR_TOP__500000.pcd.bin     key sweeps; others in sweeps/
//!   samples/CAM_FRONT/street__CAM_FRONT__510000.png         exposures; masks/CAM_FRONT/… classes
//!   lidarseg/v1.0-sim/street-LIDAR_TOP-500000000_lidarseg.bin
//!   v1.0-sim/*.json                                         the tables
//! ```
//!
//! Times are the drive's own, from 0. Tokens are names: a sample is `<scene>-<nanoseconds>`.

mod calibrations;
mod captures;
mod images;
mod scene;
mod shared;
mod tables;
mod tracks;

use occlabel_core::{Fault, Taxonomy};

use crate::Drive;

use super::files::Output;
use super::raw_names::RawNames;
use super::written::{Images, Written};

pub(super) use calibrations::add_optics;
use tables::Tables;

pub(super) use scene::sample_token;

/// The folder of the tables, which makes the log one.
const VERSION: &str = "v1.0-sim";

/// Writes drives as the scenes of one log; the taxonomy is theirs. To be finished with the entry
/// that is returned.
///
/// # Errors
/// If a scene's name begins another's, a drive has no keyframe, or a file cannot be written.
pub fn write_nuscenes(
    drives: &[Drive],
    taxonomy: &Taxonomy,
    images: Images,
    output: &Output,
) -> Result<(Written, &'static str), Fault> {
    check_names(drives)?;
    let names = RawNames::new(drives, taxonomy)?;
    let labels = drives.iter().any(|drive| drive.scene().has_point_labels());
    let mut tables = Tables::create(output, labels)?;
    shared::push_shared_rows(&mut tables, &names, output)?;
    let mut written = Written::default();
    for drive in drives {
        written += scene::write_scene(drive, &names, images, &mut tables, output)?;
    }
    tables.finish()?;
    Ok((written, VERSION))
}

/// Tokens of two scenes differ if neither name begins the other.
fn check_names(drives: &[Drive]) -> Result<(), Fault> {
    let mut names: Vec<&str> = drives.iter().map(|drive| drive.scene().name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[1].starts_with(pair[0])) {
        None => Ok(()),
        Some(pair) => {
            let found = format!("`{}` and `{}`", pair[0], pair[1]);
            Err(Fault::new("world", "name", "scenes of which no name begins another's", found))
        }
    }
}
