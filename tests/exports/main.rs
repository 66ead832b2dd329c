//! What `view` writes for other programs: recordings and meshes.

mod meshes;
mod outside;
mod recordings;
mod street;
#[path = "../support/mod.rs"]
mod support;
