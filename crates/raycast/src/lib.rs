//! Measure, then judge: count the lidar rays through and into each voxel, then decide what it is.
//!
//! Every published rule for free, occupied and unobserved is a few keys of [`RaySettings`] and
//! [`StateSettings`]; the walk itself never changes. Rays live on an integer lattice, so counts are
//! the same on every machine and for any number of threads (labels.md section 8).
//!
//! ```
//! use nalgebra::Point3;
//! use occlabel_core::*;
//! use occlabel_raycast::{
//!     Casting, Crossings, ObjectRays, Outside, RayRules, RaySettings, RaySource, count,
//! };
//!
//! let wall = vec![Point3::new(3.5, 0.5, 0.5)];
//! let cloud = PointCloud::from_one_origin(Point3::new(0.5, 0.5, 0.5), wall, vec![ClassId(0)]);
//! let scene = AggregatedScene::new(vec![BackgroundSweep::new(Timestamp(0), cloud)], vec![]);
//! let settings = RaySettings {
//!     source: RaySource::Lidar,
//!     outside: Outside::Clip,
//!     ignore_near_hit_m: 0.0,
//!     ignore_near_origin_m: 0.0,
//!     flat_ignore_dz_m: 0.0,
//!     object_rays: ObjectRays::Own,
//!     same_time_s: 0.05,
//! };
//! let spec = GridSpec::new([0.0; 3], [4.0, 1.0, 1.0], [1.0; 3])?;
//! let rules = RayRules { settings: &settings, flat: &ClassSet::default() };
//! let counts = count(&Instant::still(&scene), &spec, &rules, &Casting::new(Crossings::HowMany, 1));
//! assert_eq!(counts.crossings.values(), [1, 1, 1, 0]);
//! assert_eq!(counts.hits.values(), [0, 0, 0, 1]);
//! # Ok::<(), Fault>(())
//! ```

mod caster;
mod cells;
mod classify;
mod count;
mod hits;
mod near;
mod object_rays;
mod seen;
mod settings;
mod sweep_rays;
mod walkers;
mod ways;
mod work;

pub use classify::{Conflict, StateSettings, classify};
pub use count::{Casting, Crossings, count};
pub use hits::count_hits;
pub use seen::seen;
pub use settings::{ObjectRays, Outside, RayRules, RaySettings, RaySource};
