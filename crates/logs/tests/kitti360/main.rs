//! The reader of KITTI-360's layout against logs whose answer is plain.

mod faults;
mod log;
mod scenes;
mod sweeps;
