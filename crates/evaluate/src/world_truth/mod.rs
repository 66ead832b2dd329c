//! How right labels are, against an exactly known world.

mod camera;
mod door;
mod figures;
mod histogram;
mod judge;
mod limits;
mod objects;
mod people;
mod quality;
mod scale;
mod share;
mod table;
mod tally;

pub use figures::{Figures, Value};
pub use judge::{JudgedLabels, KnownWorld, judge};
pub use limits::{COSTLY_FIGURES, Limits, Miss};
pub use quality::{ClassQuality, Quality, RingQuality, WorstObject};
pub use scale::{RINGS_M, Scale};
pub use tally::Tally;
