//! Writers: a drive as a log on disk, in the formats that readers know.
//!
//! Each writes what the drive's scene says, faults of its annotator included, and nothing that a
//! real log would not hold. All files go through [`Output`]: a log that looks whole is whole.

mod cloud;
mod coda;
mod exposures;
mod files;
mod masks;
mod mcap;
mod meshes;
mod nuscenes;
mod png;
mod points;
mod raw_names;
mod semantickitti;
mod waymo;
mod wire;
mod written;

pub use cloud::write_cloud;
pub use coda::write_coda;
pub use files::Output;
pub use masks::write_masks;
pub use mcap::write_mcap;
pub use meshes::{MeshNames, write_meshes};
pub use nuscenes::write_nuscenes;
pub use semantickitti::write_semantickitti;
pub use waymo::write_waymo;
#[cfg(feature = "waymo-v2")]
pub use waymo::write_waymo_v2;
pub use written::{Images, Written};
