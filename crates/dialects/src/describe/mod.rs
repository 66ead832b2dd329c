//! What label files look like: their dialect, what they hold, and what is odd about it.

mod fit;
mod ground;
mod ids;
mod sight;
mod suspicion;
mod tally;

pub use fit::Fit;
pub use ground::ColumnCounts;
pub use ids::IdCounts;
pub use sight::{Packing, SeenArray, Sight};
pub use suspicion::Suspicion;
pub use tally::{LidarCounts, VoxelTally};
