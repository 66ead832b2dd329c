//! Labels against exactly known worlds, on grids drawn by hand.

mod cameras;
mod figures;
mod oracle;
mod output;
mod sums;
mod support;
