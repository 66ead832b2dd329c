//! Labels as one can look at them.
//!
//! A label that nobody looked at is not trusted, and the machine that labels often has no screen, no
//! graphics card and no fonts. So the pictures are drawn on the processor alone, and their letters are
//! drawn here as well (`picture/font.rs`). All that is made here is a function of the labels and a few
//! settings: the same bytes on any number of threads and any machine.
//!
//! Every way to show a scene takes a [`ShownScene`] and its [`ShownKeyframe`]s, whatever dialect they
//! were read from. [`Recording`] lays a scene on a time line for Foxglove and Rerun; [`glb`],
//! [`ply_cubes`] and [`ply_points`] are for programs that show solids. In pictures, what a voxel looks
//! like is [`Painted`]'s affair; where it stands is that of [`Plate`]'s methods, one a kind of picture.
//!
//! ```
//! use occlabel_core::{GridSpec, Palette, VoxelGrid};
//! use occlabel_view::{BirdsEye, Orbit, Painted, birds_eye, perspective, png};
//!
//! let spec = GridSpec::new([0.0; 3], [4.0, 4.0, 2.0], [1.0; 3])?;
//! let mut semantics = VoxelGrid::filled(&spec, 17);
//! semantics.values_mut()[5] = 1;
//! let seen = VoxelGrid::filled(&spec, 1);
//! let palette = Palette::of(&["others", "car"]);
//! let labels = Painted {
//!     spec: &spec,
//!     semantics: &semantics,
//!     mask_lidar: Some(&seen),
//!     mask_camera: Some(&seen),
//!     free: 17,
//!     palette: &palette,
//!     heading_rad: Some(0.0),
//! };
//! let above = birds_eye(&labels, &BirdsEye { map_px: 200 });
//! let behind = perspective(&labels, &Orbit::behind(&spec, 320, 180));
//! assert!(png(&above).starts_with(b"\x89PNG") && png(&behind).starts_with(b"\x89PNG"));
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod mesh;
mod page;
mod picture;
mod recording;
mod report;
mod rows;
mod shown;
#[cfg(test)]
mod testing;

pub use mesh::{glb, ply_cubes, ply_points};
pub use page::{PageKeyframe, page};
pub use picture::{
    Across, Aim, BirdsEye, CameraView, Change, ChangeCounts, Difference, Orbit, Painted, Plate,
    Strip, birds_eye, perspective, png, thumbnail,
};
pub use recording::{EGO, GRID, Recording, ShownBox, WORLD};
pub use report::{
    KeyframeAt, QualityTable, Remark, Run, RunClass, RunKeyframe, RunScene, Thumbnail, VoxelTotals,
    report_page,
};
pub use shown::{NO_LABEL, ShownEvidence, ShownKeyframe, ShownScene, ShownTrack};
