//! The benchmarks' own scores: predictions against truth, voxel by voxel.
//!
//! Labels come with canonical ids: class 0..n in the order of the class table, `n` for free,
//! [`UNLABELLED`] where the file says nothing. [`Scorer::score`] counts one keyframe; tallies of
//! keyframes add up in any order to the same sum, and [`ScoreTally::scores`] takes the ratios.
//! `docs/scores.md` has every formula with its source.
//!
//! ```
//! use occlabel_core::{GridSpec, VoxelGrid};
//! use occlabel_evaluate::scores::{
//!     Metrics, ScoreTally, ScoredLabels, ScoredPair, Scorer, ScoringRules,
//! };
//!
//! let spec = GridSpec::new([0.0; 3], [4.0, 1.0, 1.0], [1.0; 3])?;
//! let rules = ScoringRules::new(spec.clone(), vec!["car".into(), "road".into()]);
//! let scorer = Scorer::new(rules, Metrics { semantic: true, ..Metrics::default() })?;
//!
//! // A car, two of road, one free; the prediction takes the second of road for free.
//! let truth = VoxelGrid::from_values(&spec, vec![0, 1, 1, 2]);
//! let prediction = VoxelGrid::from_values(&spec, vec![0, 1, 2, 2]);
//! let pair = ScoredPair {
//!     truth: ScoredLabels::of(&truth),
//!     prediction: ScoredLabels::of(&prediction),
//!     mask: None,
//!     origins: &[],
//! };
//! let tally: ScoreTally = [scorer.score(&pair)?].into_iter().sum();
//! let semantic = tally.scores(scorer.rules()).semantic.unwrap();
//! assert_eq!(semantic.miou, Some(0.75));
//! assert_eq!(semantic.occupied.iou, Some(2.0 / 3.0));
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod attributes;
mod breakdown;
mod completion;
mod confusion;
mod detections;
mod distances;
mod door;
mod f_score;
mod pair_counts;
mod panoptic;
mod panoptic_scores;
mod ray_scores;
mod rings;
mod rules;
mod scorer;
mod segments;
mod semantic;
mod table;
mod tally;
mod velocity;

pub use attributes::SceneAttributes;
pub use breakdown::Breakdown;
pub use completion::CompletionScores;
pub use confusion::Confusion;
pub(crate) use confusion::ratio;
pub use f_score::{FScoreTally, FScores};
pub use panoptic::PanopticTally;
pub use panoptic_scores::{ClassPanoptic, PanopticMeans, PanopticScores};
pub use ray_scores::{RayScores, RayTallies};
pub use rules::{ScoringRules, UNLABELLED};
pub use scorer::{Metrics, ScoredLabels, ScoredPair, Scorer};
pub use semantic::{BinaryScores, ClassScores, SemanticScores};
pub use tally::{RingScores, ScoreTally, Scores};
pub use velocity::{ClassVelocity, VelocityScores, VelocityTally};
