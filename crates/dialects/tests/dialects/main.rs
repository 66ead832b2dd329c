//! The dialects by their files: what is written, read back, guessed and refused.

mod convert;
mod golden;
mod guess;
mod own_trees;
mod refusals;
mod round_trip;
mod support;
