//! The reader of CODa's layout against logs whose answer is plain.

mod faults;
mod log;
mod scenes;
