//! Two label sets, voxel by voxel: where they differ, and how much.
//!
//! Neither is the truth: the first is only the one that is compared with. [`Comparer::compare`] counts
//! one keyframe; a [`Difference`] adds up over keyframes, and [`Difference::comparison`] takes the
//! ratios.
//!
//! ```
//! use occlabel_core::{GridSpec, VoxelGrid};
//! use occlabel_evaluate::compare::{ComparedLabels, Comparer, Difference};
//!
//! let spec = GridSpec::new([0.0; 3], [4.0, 1.0, 1.0], [1.0; 3])?;
//! let comparer = Comparer::new(spec.clone(), vec!["car".into(), "road".into()])?;
//!
//! // The second set takes a voxel of road for free, and does not know another.
//! let a = VoxelGrid::from_values(&spec, vec![0, 1, 1, 2]);
//! let b = VoxelGrid::from_values(&spec, vec![0, 1, 2, 2]);
//! let observed = VoxelGrid::from_values(&spec, vec![1, 1, 1, 1]);
//! let fewer = VoxelGrid::from_values(&spec, vec![1, 1, 1, 0]);
//! let labels = |semantics, mask| ComparedLabels {
//!     mask_lidar: Some(mask),
//!     ..ComparedLabels::of(semantics)
//! };
//! let difference = comparer.compare(&labels(&a, &observed), &labels(&b, &fewer), &[])?;
//! let comparison = difference.comparison(&comparer);
//! assert_eq!(comparison.differing_share, Some(0.5), "two of four");
//! assert_eq!(comparison.mask_lidar.unwrap().only_a, 1);
//! assert_eq!(comparison.states.unwrap().occupied_to_free, 1);
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod arrays;
mod comparer;
mod comparison;
mod difference;
mod mask_agreement;
mod state_changes;
mod table;

pub use arrays::ArrayDifferences;
pub use comparer::{ComparedLabels, Comparer};
pub use comparison::Comparison;
pub use difference::Difference;
pub use mask_agreement::{MaskAgreement, MaskCounts};
pub use state_changes::{StateChanges, StateCounts};
