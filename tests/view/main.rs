//! What `view` and `report` make, read by other people's programs and compared with the arrays.

mod meshes;
mod outside;
mod page;
mod pictures;
mod recordings;
mod report;
mod street;
#[path = "../support/mod.rs"]
mod support;
