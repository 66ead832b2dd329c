//! A log in a temporary folder, the program run on it, and the tree it leaves. Each test file uses
//! its own part.
#![allow(dead_code, unused_imports)]

mod documented;
mod npz_dates;
mod program;
mod test_log;
mod tree;

pub(crate) use documented::Documented;
pub(crate) use npz_dates::npz_dates;
pub(crate) use program::{
    Ended, Label, SMALL, labelled_drive, occlabel, occlabel_within, program, text,
};
pub(crate) use test_log::{NAN, Point, SCENE, TestLog, VERSION, copy, nano_spec};
pub(crate) use tree::{
    Arrays, files_under, gts_files, leftovers, manifest, read_arrays, report, tree_hash,
};
