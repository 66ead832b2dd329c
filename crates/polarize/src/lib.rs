//! Degree and angle of linear polarization, from four images behind polarizers.
//!
//! A polarization camera takes each picture through polarizers that let light through at 0, 45, 90 and 135
//! degrees. Glass, water and paint polarize what they reflect; so which way light swings, and how much of
//! it, tells of surfaces what a grey value does not. No label is made of it: it stands beside the labels,
//! for those who train on it. This crate is numbers in, numbers out; files are `cli`'s affair.
//!
//! ```
//! use occlabel_polarize::{Channels, polarize};
//!
//! // Two pixels: wholly polarized at 45 degrees, and not at all.
//! let channels = [[100, 60], [200, 60], [100, 60], [0, 60]];
//! let light = polarize(&Channels::new(channels.each_ref().map(|channel| &channel[..])).unwrap());
//! assert_eq!(light.degree, [65_535, 0]);
//! assert_eq!(light.angle, [16_384, 0]);
//! ```

mod channels;
mod polarized;
mod stokes;

pub use channels::Channels;
pub use polarized::{ANGLE_STEPS, DEGREE_STEPS, Polarized, polarize};
pub use stokes::{Linear, Stokes};
