//! The Waymo reader against a drive that an independent program wrote (fixtures/README.md).

mod faults;
mod log;
mod message;
mod mutations;
mod points;
mod scenes;
