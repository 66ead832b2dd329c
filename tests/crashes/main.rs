//! The program is broken on purpose, in every way that a machine has: operations on files fail, the
//! process is killed, the disk is full, another process is at work in the same place. After each, what
//! the program promises (`docs/reliability.md`) is checked, and the same command ends in the same tree.
//!
//! Needs the cargo feature `faults`. A part is tried; with `OCCLABEL_CRASHES=all`, everything.
#![cfg(feature = "faults")]

#[path = "../support/mod.rs"]
mod support;

mod failing;
mod full_disk;
mod kills;
mod line;
mod operations;
mod promises;
mod reads;
mod writers;

/// Whether everything is to be tried.
fn is_all() -> bool {
    std::env::var("OCCLABEL_CRASHES").as_deref() == Ok("all")
}
