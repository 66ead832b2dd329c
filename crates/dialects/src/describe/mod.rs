//! What label files look like: their dialect, what they hold, and what is odd about it.
//!
//! A file is first looked at ([`Sight`]): what arrays there are. That tells the dialects that it may be
//! in. Taken for the likeliest, its voxels are counted ([`Examined`]), and the counts are judged by
//! rules with names ([`Suspicion`]).

mod description;
mod examined;
mod fit;
mod ground;
mod ids;
mod motion;
mod raw;
mod sight;
mod suspicion;
mod table;
mod tally;

pub use description::{ClassCount, Contents, Description, States};
pub use examined::Examined;
pub use ground::{ColumnCounts, GroundLevels};
pub use ids::IdCounts;
pub use motion::MotionCounts;
pub use sight::{Packing, SeenArray, Sight};
pub use suspicion::Suspicion;
pub use tally::{LidarCounts, VoxelTally};
