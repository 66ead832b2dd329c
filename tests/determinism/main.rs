//! The same input, configuration and version give the same bytes (labels.md section 12): however many
//! threads, whatever the memory, the order, the parts, and on whichever build of the program.
//!
//! `OCCLABEL_MATRIX=all` tries every way of running on every case; without it the first case has them
//! all, and the others the ways that differ most. `OCCLABEL_BINARY` names another build of the program.

mod case;
mod commands;
mod goldens;
mod rows;
#[path = "../support/mod.rs"]
mod support;
mod ways;
