//! Meshes of bodies, beside any log: fitted people, one mesh for each at a keyframe.
//!
//! ```text
//!   FOLDER/<scene>/<keyframe token>/<track>.obj    or .ply: the name of the file is the track's
//!   FOLDER/<scene>/<keyframe token>.npz            vertices [people][v][3], faces [f][3], track_ids [people]
//! ```

mod arrays;
#[cfg(any(test, fuzzing))]
pub(crate) mod doors;
mod folder;
mod obj;
mod ply;
mod polygon;

pub use folder::{MeshFile, MeshFolder};
