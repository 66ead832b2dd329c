//! Pictures of labels, drawn without a display.
//!
//! A label that nobody looked at is not trusted, and the machine that labels often has no screen, no
//! graphics card and no fonts. So the pictures are drawn by a few hundred lines on the processor
//! alone, and their letters are drawn here as well (`font.rs`). A picture is a function of the labels
//! and a few settings: the same bytes on any number of threads and any machine.
//!
//! What a voxel looks like is [`Painted`]'s affair; where it stands in the picture is that of
//! [`birds_eye`] and [`perspective`]. Whatever else is to be drawn needs a new painter only.
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
//!     mask_lidar: &seen,
//!     mask_camera: &seen,
//!     free: 17,
//!     palette: &palette,
//! };
//! let above = birds_eye(&labels, &BirdsEye { map_px: 200 });
//! let behind = perspective(&labels, &Orbit::behind(&spec, 320, 180));
//! assert!(png(&above).starts_with(b"\x89PNG") && png(&behind).starts_with(b"\x89PNG"));
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod birds_eye;
mod canvas;
mod cast;
mod color;
mod column;
mod font;
mod legend;
mod lens;
mod marks;
mod orbit;
mod painted;
mod perspective;
mod png;
mod shade;

pub use birds_eye::{BirdsEye, birds_eye};
pub use orbit::Orbit;
pub use painted::Painted;
pub use perspective::perspective;
pub use png::png;
