//! What label files look like: their dialect, what they hold, and what is odd about it.

mod ground;
mod ids;
mod suspicion;
mod tally;

pub use ground::ColumnCounts;
pub use ids::IdCounts;
pub use suspicion::Suspicion;
pub use tally::{LidarCounts, VoxelTally};
