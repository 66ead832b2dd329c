//! The nuScenes reader against small logs, rule by rule and fault by fault.

mod cameras;
mod recorded;
mod scenes;
mod sweeps;
mod tables;
mod tiny_log;
mod tracks;
