//! The truth about voxels, tested where geometry gives the answer.

mod matter;
mod motion;
mod rays;
mod sight;
mod support;
