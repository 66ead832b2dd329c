//! Logs and label trees in a store of objects, on a real server, which fails: whatever it does, a run
//! there leaves what a run on a disk leaves.
//!
//! Needs the cargo feature `stores`, and the servers that `tests/outside/install` brings.
#![cfg(feature = "stores")]

#[path = "../support/mod.rs"]
mod support;

mod bucket;
mod http;
mod proxy;
mod refusals;
mod runs;
mod server;
mod trees;
