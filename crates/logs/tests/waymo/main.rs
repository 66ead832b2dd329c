//! The Waymo reader against a drive that an independent program wrote (fixtures/README.md).

#[cfg(feature = "waymo-v2")]
mod components;
mod faults;
mod log;
mod message;
mod mutations;
mod points;
mod scenes;
