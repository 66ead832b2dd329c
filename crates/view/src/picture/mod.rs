//! Pictures, drawn by the processor alone: no display, no graphics card, no fonts.

mod birds_eye;
mod canvas;
mod cast;
mod color;
mod column;
mod cubes;
mod difference;
mod font;
mod gaze;
mod legend;
mod lens;
mod marks;
mod orbit;
mod overlay;
mod painted;
mod perspective;
mod plate;
mod png;
mod shade;
mod sheet;
mod slices;
mod strip;
mod thumbnail;
mod tiles;

pub use birds_eye::{BirdsEye, birds_eye};
pub use difference::{Change, ChangeCounts, Difference};
pub use orbit::{Aim, Orbit};
pub use overlay::CameraView;
pub use painted::Painted;
pub use perspective::perspective;
pub use plate::Plate;
pub use png::png;
pub use slices::Across;
pub use strip::Strip;
pub use thumbnail::thumbnail;
