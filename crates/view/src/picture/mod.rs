//! Pictures, drawn by the processor alone: no display, no graphics card, no fonts.

mod birds_eye;
mod canvas;
mod cast;
mod color;
mod column;
mod font;
mod legend;
mod lens;
mod marks;
mod orbit;
mod painted;
mod perspective;
mod png;
mod shade;
mod thumbnail;

pub use birds_eye::{BirdsEye, birds_eye};
pub use orbit::Orbit;
pub use painted::Painted;
pub use perspective::perspective;
pub use png::png;
pub use thumbnail::thumbnail;
