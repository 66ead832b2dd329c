//! MCAP logs, described and labelled by the program.

mod drive;
mod faults;
mod labelled;
#[path = "../support/mod.rs"]
mod support;
