//! The class and the instance of each voxel, by counting the points in it; and of larger voxels, by
//! counting the voxels in them.
//!
//! Published generators let the last written point decide, a race on a GPU; counting makes the
//! label independent of the order of points, and ties are broken by the taxonomy's `priority`.
//!
//! ```
//! use nalgebra::Point3;
//! use occlabel_core::*;
//! use occlabel_voxelize::{Vote, VoteRules, voxelize};
//!
//! let positions = vec![Point3::new(0.5, 0.5, 0.5); 3];
//! let labels = vec![ClassId(0), ClassId(1), ClassId(1)];
//! let cloud = PointCloud::from_one_origin(Point3::new(5.0, 0.0, 0.0), positions, labels);
//! let scene = AggregatedScene::new(vec![BackgroundSweep::new(Timestamp(0), cloud)], vec![]);
//! let spec = GridSpec::new([0.0; 3], [2.0; 3], [1.0; 3])?;
//! let rules = VoteRules { vote: Vote::Majority, movers: &ClassSet::default(), rank: &[0, 1] };
//! let votes = voxelize(&Instant::still(&scene), &spec, &rules);
//! assert_eq!(votes.at([0, 0, 0]).unwrap().class, ClassId(1));
//! assert_eq!(*votes.at([1, 1, 1]), None);
//! # Ok::<(), Fault>(())
//! ```

mod ballot;
mod pool;
mod voxelize;

pub use pool::pool;
pub use voxelize::{Surfels, Vote, VoteRules, VoteSettings, voxelize};
