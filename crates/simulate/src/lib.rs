//! Exactly known worlds, and the drives recorded in them.
//!
//! No label generator can say how right it is on a real drive, for nobody knows the truth there.
//! Here the truth comes first: a [`World`] is a text file of solids and ways, everything in it has
//! a closed form or a checked mesh, and at any instant it answers what a ray meets and what a point
//! lies in. A [`Drive`] is what sensors record of it, in the words of `occlabel_core`, so that the
//! pipeline labels it as it would a log; an [`Annotator`] may come between and get things wrong.
//! [`render()`] shows what a camera saw. Chance is a hash of the ray's own number: the same world
//! gives the same bytes on any number of threads and any machine.
//!
//! ```
//! use nalgebra::{Point3, Vector3};
//! use occlabel_simulate::{Ray, What, World};
//!
//! let world = World::parse(
//!     r#"
//!     name = "wall"
//!     duration_s = 1.0
//!     taxonomy = "occ3d-nuscenes"
//!     keyframe_hz = 2.0
//!
//!     [ground]
//!     bands = [{ class = "flat.driveable_surface" }]
//!
//!     [ego.trajectory.straight]
//!     start = { x_m = 0.0, y_m = 0.0 }
//!     speed_mps = 5.0
//!
//!     [[static]]
//!     class = "static.manmade"
//!     pose = { position_m = [10.0, 0.0, 1.5] }
//!     shape.box.size_m = [1.0, 8.0, 3.0]
//!
//!     [[lidar]]
//!     name = "LIDAR_TOP"
//!     mounting = { position_m = [0.9, 0.0, 1.8] }
//!     pattern.spinning = { beams.even = { count = 16, min_rad = -0.5, max_rad = 0.2 }, azimuths = 360 }
//!     rate_hz = 10.0
//!     max_range_m = 70.0
//!     "#,
//!     "wall.toml",
//! )?;
//! let ahead = Ray { origin: Point3::new(0.0, 0.0, 1.0), direction: Vector3::x() };
//! let hit = world.at(0.0).cast(&ahead, 70.0).unwrap();
//! assert_eq!((hit.distance_m, hit.what), (9.5, What::Static(0)));
//! assert_eq!(world.at(0.0).contains(&Point3::new(3.0, 0.0, -0.1)), Some(What::Ground(0)));
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod annotator;
mod bodies;
mod body_mask;
mod camera;
mod check;
mod clip;
mod clock;
mod convert;
#[cfg(any(test, fuzzing))]
pub mod doors;
mod drive;
mod ego;
mod ground;
mod hull;
mod instant;
mod labels;
mod lidar;
mod mesh;
mod model;
mod mover;
mod nearest;
mod noise;
mod overrides;
mod pattern;
mod ray;
mod reconstruction;
mod render;
mod repeat;
mod rotation;
mod schedule;
mod shape;
mod shipped;
mod skin;
mod standing;
mod swing;
mod towed;
mod trajectory;
mod truth;
mod world;
mod world_file;
mod write;

pub use annotator::{Annotator, BoxTime, DrawnMesh, LabelledSweeps, LoggedPoses, Unboxed};
pub use camera::WorldCamera;
pub use clock::Clock;
pub use drive::Drive;
pub use ego::{Ego, EgoBody};
pub use ground::{Band, Ground};
pub use instant::{Hit, Instant, What};
pub use lidar::{Lidar, Return};
pub use mover::Mover;
pub use overrides::world_text_with;
pub use pattern::{Beams, Pattern};
pub use ray::{Impact, Ray};
pub use reconstruction::{CloudPoint, Reconstruction, exposure_cloud};
pub use render::{ClassImage, NO_CLASS, render};
pub use shape::{Shape, ShapeFile};
pub use shipped::{ShippedWorld, WORLDS, shipped_world};
pub use swing::Swing;
pub use trajectory::{Place, Trajectory, Waypoint};
pub use truth::{TrueRays, TruthAt, TruthSettings, dense_ends, keyframe_truth};
pub use world::World;
#[cfg(feature = "waymo-v2")]
pub use write::write_waymo_v2;
pub use write::{
    Images, MeshNames, Output, Written, write_cloud, write_coda, write_masks, write_mcap,
    write_meshes, write_nuscenes, write_semantickitti, write_waymo,
};
