//! Labels as they are drawn.

use image::Rgb;
use occlabel_core::{GridSpec, Palette, VoxelGrid};

use crate::color::{HIDDEN, mix};

/// The labels of one keyframe, and their colours.
///
/// The grids must have the shape of `spec`; a picture of others panics.
#[derive(Clone, Copy, Debug)]
pub struct Painted<'a> {
    /// The grid.
    pub spec: &'a GridSpec,
    /// The class where occupied, `free` elsewhere.
    pub semantics: &'a VoxelGrid<u8>,
    /// Not 0 where not unobserved.
    pub mask_lidar: &'a VoxelGrid<u8>,
    /// Not 0 where some camera sees it. If it is 0 everywhere, there was no camera, and nothing is
    /// drawn as hidden from one.
    pub mask_camera: &'a VoxelGrid<u8>,
    /// The value of a voxel that is not occupied.
    pub free: u8,
    /// The colours of the classes.
    pub palette: &'a Palette,
}

impl Painted<'_> {
    /// Stops a picture of grids that do not fit.
    pub(crate) fn check(&self) {
        for grid in [self.semantics, self.mask_lidar, self.mask_camera] {
            assert_eq!(grid.shape(), self.spec.shape(), "grids of the spec's shape");
        }
    }

    /// The colour of a class.
    pub(crate) fn color(&self, class: u8) -> Rgb<u8> {
        Rgb(self.palette.color(class))
    }

    /// The class at a place of the flat array, if that is occupied.
    pub(crate) fn class(&self, flat: usize) -> Option<u8> {
        let value = self.semantics.values()[flat];
        (value != self.free).then_some(value)
    }

    /// Whether a ray told what is at a place of the flat array.
    pub(crate) fn observed(&self, flat: usize) -> bool {
        self.mask_lidar.values()[flat] != 0
    }

    /// Whether there are cameras at all.
    pub(crate) fn has_cameras(&self) -> bool {
        self.mask_camera.values().iter().any(|&seen| seen != 0)
    }

    /// The classes that occur, in id order.
    pub(crate) fn present(&self) -> Vec<u8> {
        let mut occurs = [false; 256];
        self.semantics.values().iter().for_each(|&class| occurs[usize::from(class)] = true);
        occurs[usize::from(self.free)] = false;
        (0..=255).filter(|&class| occurs[usize::from(class)]).collect()
    }
}

/// What no camera sees, in its own colour made dull.
pub(crate) fn hidden(color: Rgb<u8>) -> Rgb<u8> {
    mix(color, HIDDEN, 0.58)
}
