//! Which voxels the cameras of a keyframe see: the rays end at the first voxel that blocks.
//!
//! The published recipes differ only in which rays are cast and which voxels block; both are keys of
//! [`OcclusionSettings`]. Each camera looks from where it stood at its own exposure, through its own
//! lens model (labels.md section 10).
//!
//! ```
//! use nalgebra::{Point3, Rotation3, Vector3};
//! use occlabel_core::camera::{Camera, CameraModel, Intrinsics, Pinhole};
//! use occlabel_core::*;
//! use occlabel_occlusion::*;
//!
//! let k = [[50.0, 0.0, 50.0], [0.0, 50.0, 50.0], [0.0, 0.0, 1.0]];
//! let model = CameraModel::Pinhole(Pinhole::new(Intrinsics::from_matrix(&k)?));
//! let camera = Camera { model, width: 100, height: 100, body_mask: None, rolling_shutter: None };
//! // z of the camera looks along x of the grid.
//! let forward = Rotation3::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
//! let grid_from_camera = Pose::from_parts(Vector3::new(0.5, 0.5, 0.5).into(), forward.into());
//! let eye = Eye { bit: 0, camera: &camera, grid_from_camera };
//!
//! let spec = GridSpec::new([0.0; 3], [5.0, 1.0, 1.0], [1.0; 3])?;
//! let mut things = VoxelGrid::filled(&spec, Matter::Air);
//! things.values_mut()[3] = Matter::Solid;
//! let settings = OcclusionSettings {
//!     rays: CameraRays::AllCenters,
//!     occluders: Occluders::All,
//!     pixel_stride: 1,
//!     depth_max_m: 100.0,
//! };
//! let bits = visible(&[eye], &Lenses::default(), &spec, &things, &settings);
//! assert_eq!(bits.values(), [1, 1, 1, 1, 0], "the voxel behind the solid one is hidden");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod beam;
mod bit_columns;
mod cones;
mod eye;
mod fan;
mod lenses;
mod look;
mod march;
mod matter;
mod pixel_rays;
mod settings;
mod view;
mod visible;

pub use eye::Eye;
pub use lenses::Lenses;
pub use matter::{Matter, matter};
pub use settings::{CameraRays, Occluders, OcclusionSettings};
pub use view::in_view;
pub use visible::visible;
