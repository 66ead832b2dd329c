//! What stays the same from keyframe to keyframe.

use std::sync::OnceLock;

use crate::Eye;
use crate::cones::{Cones, Level, levels};

/// What is found out about a scene's cameras once and used for all of its keyframes: bounds on where
/// blocks of pixels look, at most 2 bytes a pixel.
///
/// They are the bounds of one set of cameras, known by their bits, and of one `pixel_stride`. Found
/// when first asked; labels do not depend on it.
#[derive(Clone, Debug, Default)]
pub struct Lenses([OnceLock<Vec<Level>>; 16]);

impl Lenses {
    /// The cones of a camera's blocks of pixels.
    pub(crate) fn cones<'a>(&'a self, eye: &Eye<'a>, stride: usize) -> Cones<'a> {
        let levels = self.0[eye.bit].get_or_init(|| levels(eye.camera, stride));
        Cones::new(eye.camera, stride, levels)
    }
}
