//! A page about a whole run: what it labelled, how that went, and what strays from the rest.
//!
//! ```text
//!   labels, keyframe by keyframe -> VoxelTotals --+
//!   report, manifest, quality ------------------- Run -> Attention -> which thumbnails -> page
//! ```

mod attention;
mod charts;
mod html;
mod page;
mod remarks;
mod run;
mod scenes;
mod strays;
mod summary;
mod totals;
mod words;

pub use attention::KeyframeAt;
pub use page::report_page;
pub use run::{QualityTable, Remark, Run, RunClass, RunKeyframe, RunScene, Thumbnail};
pub use totals::VoxelTotals;
