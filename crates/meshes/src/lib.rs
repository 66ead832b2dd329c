//! Bodies that are known by their surface: a person's fitted mesh at a keyframe.
//!
//! A lidar sees one side of a person, some tens of points; a mesh fitted to images knows all of them,
//! but stands some centimetres off. [`align`] moves it onto the points and says how well they fit,
//! [`motion_between`] tells how it moved since another keyframe, [`solid_voxels`] are those that it
//! reaches into. Nothing here knows what a body is: any closed surface will do (labels.md section 9a).
//!
//! ```
//! use nalgebra::Point3;
//! use occlabel_core::{GridSpec, Pose, TriangleMesh};
//! use occlabel_meshes::solid_voxels;
//!
//! let corner = |x, y, z| Point3::new(x, y, z);
//! let corners = vec![
//!     corner(0.1, 0.1, 0.1), corner(1.9, 0.1, 0.1), corner(0.1, 1.9, 0.1), corner(0.1, 0.1, 1.9),
//! ];
//! let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let tetrahedron = TriangleMesh::new(corners, faces)?;
//! let spec = GridSpec::new([0.0; 3], [2.0; 3], [1.0; 3])?;
//! // The voxel in the corner, and the three beside it.
//! assert_eq!(solid_voxels(&tetrahedron, &Pose::identity(), &spec), [0, 1, 2, 4]);
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod align;
mod column;
mod motion;
mod nudge;
mod solid;
mod surface;

pub use align::{AlignSettings, Alignment, View, align};
pub use motion::motion_between;
pub use solid::solid_voxels;
