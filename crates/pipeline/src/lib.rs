//! The order of the stages, and the configuration that drives them.
