//! The reader of SemanticKITTI's layout against logs whose answer is plain, and a recorded one.

mod faults;
mod log;
mod mutations;
mod recorded;
mod scenes;
