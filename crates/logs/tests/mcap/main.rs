//! MCAP logs. Those recorded by others lie beside the project; tests of these say so and pass where
//! they are missing.

mod recorded;
mod sources;
mod support;
