//! How right labels are: against an exactly known world, and against held-out sweeps.

pub mod held_out;
