//! How well labels agree with sweeps that took no part in them.
//!
//! On a real drive nobody knows the truth, but a sweep that was kept out of the fusion is an honest
//! witness: where it returned, something should be; what its rays passed, should not be in the way.
//! Even perfect labels fail such a witness a little, for a voxel is taller than the ground in it; so
//! every figure stands beside the **floor**, the figure of the perfect labels of a flat ground that
//! the same rays see ([`flat_twin`]).
//!
//! [`held_out`] chooses the sweeps, [`place`] brings their rays to a keyframe, [`ask`] tallies,
//! [`HeldOutFigures`] are the shares. Tallies of keyframes and scenes add up.
//!
//! ```
//! use nalgebra::Point3;
//! use occlabel_core::{ClassId, ClassSet, GridSpec, VoxelGrid};
//! use occlabel_evaluate::held_out::{
//!     GroundRule, HeldOutRay, HeldOutSettings, Labels, Source, Verdict, ask,
//! };
//!
//! let spec = GridSpec::new([0.0; 3], [4.0, 1.0, 1.0], [1.0; 3])?;
//! let mut verdicts = VoxelGrid::filled(&spec, Verdict::Free);
//! verdicts.values_mut()[3] = Verdict::Occupied(ClassId(15));
//! let labels = Labels { spec: &spec, verdicts: &verdicts, standing: None };
//! let ray = HeldOutRay {
//!     origin: Point3::new(0.5, 0.5, 0.5),
//!     point: Point3::new(3.5, 0.5, 0.5),
//!     source: Source::Background(None),
//!     is_of_another_time: false,
//! };
//! let ground = GroundRule::Classes(ClassSet::default());
//! let tallies = ask(&labels, &[ray], &HeldOutSettings { ground, tolerance_m: 0.25 });
//! assert_eq!(tallies.labels.structure.hits, 1);
//! assert_eq!(tallies.labels.structure.depth.mean_m(), Some(0.5));
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod ask;
mod choose;
mod depth;
mod figures;
mod kind;
mod labels;
mod pass;
mod place;
mod slab;
mod table;
mod tally;
mod twin;

pub use ask::{HeldOutSettings, HeldOutTally, ask};
pub use choose::{held_out, nearest_keyframe};
pub use depth::DepthErrors;
pub use figures::{Figures, HeldOutFigures, KindFigures};
pub use kind::GroundRule;
pub use labels::{Labels, Verdict};
pub use place::{HeldOutRay, JudgedMoment, Source, place};
pub use table::table;
pub use tally::{KindTally, Tally};
pub use twin::{FlatTwin, flat_twin};
