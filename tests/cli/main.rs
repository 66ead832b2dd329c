//! The command line as the contract has it: what goes in, what comes out, and how it ends.

mod also;
mod arrays;
mod compare;
mod configuration;
mod convert;
mod dialect;
#[cfg(unix)]
mod hanging_up;
#[cfg(unix)]
mod interrupted;
mod labelled;
mod lines;
#[cfg(unix)]
mod logging;
mod memory;
mod parts;
mod plan;
mod polarization;
mod records;
mod reports;
mod resume;
mod streams;
#[path = "../support/mod.rs"]
mod support;
mod unwritable;
mod verify;
