//! Bad inputs, and how the program ends on them: one test or more for each case of the list of faults.

mod asserts;
mod boxes;
mod cameras;
mod files;
mod grids;
mod labels;
#[cfg(unix)]
mod links;
mod names;
mod points;
mod policy;
mod poses;
#[path = "../support/mod.rs"]
mod support;
mod table;
mod times;
