//! Labels as they are drawn.

use image::Rgb;
use occlabel_core::{GridSpec, Palette, VoxelGrid};

use crate::picture::color::{HIDDEN, mix};
use crate::{NO_LABEL, ShownKeyframe, ShownScene};

/// The labels of one keyframe, and their colours.
///
/// The grids must have the shape of `spec`; a picture of others panics.
#[derive(Clone, Copy, Debug)]
pub struct Painted<'a> {
    /// The grid.
    pub spec: &'a GridSpec,
    /// The class where occupied, `free` where nothing stands, or [`NO_LABEL`].
    pub semantics: &'a VoxelGrid<u8>,
    /// Not 0 where not unobserved; `None` if nobody tells, and all counts as observed.
    pub mask_lidar: Option<&'a VoxelGrid<u8>>,
    /// Not 0 where some camera sees it. If it is 0 everywhere, or nobody tells, nothing is drawn as
    /// hidden from cameras.
    pub mask_camera: Option<&'a VoxelGrid<u8>>,
    /// The value of a voxel where nothing stands.
    pub free: u8,
    /// The colours of the classes.
    pub palette: &'a Palette,
    /// Where the ego's forward points in the grid frame; without it, its mark is left out.
    pub heading_rad: Option<f64>,
}

impl<'a> Painted<'a> {
    /// A keyframe in the colours of its scene.
    pub fn of(keyframe: &'a ShownKeyframe, scene: &'a ShownScene) -> Self {
        Self {
            spec: &keyframe.spec,
            semantics: &keyframe.semantics,
            mask_lidar: keyframe.mask_lidar.as_ref(),
            mask_camera: keyframe.mask_camera.as_ref(),
            free: scene.free,
            palette: &scene.palette,
            heading_rad: keyframe.heading_rad,
        }
    }

    /// Stops a picture of grids that do not fit.
    pub(crate) fn check(&self) {
        let masks = [self.mask_lidar, self.mask_camera].into_iter().flatten();
        for grid in masks.chain([self.semantics]) {
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
        (value != self.free && value != NO_LABEL).then_some(value)
    }

    /// Whether it is known what is at a place of the flat array.
    pub(crate) fn observed(&self, flat: usize) -> bool {
        let told = self.semantics.values()[flat] != NO_LABEL;
        told && self.mask_lidar.is_none_or(|mask| mask.values()[flat] != 0)
    }

    /// Whether the file has no label of a place of the flat array.
    pub(crate) fn unlabelled(&self, flat: usize) -> bool {
        self.semantics.values()[flat] == NO_LABEL
    }

    /// Whether the labels tell what was not observed from what is free.
    pub(crate) fn tells_unobserved(&self) -> bool {
        self.mask_lidar.is_some()
    }

    /// What free voxels are called.
    pub(crate) fn free_name(&self) -> &'static str {
        if self.tells_unobserved() { "free" } else { "free or unobserved" }
    }

    /// Whether no camera sees a place of the flat array, though there are cameras
    /// ([`Painted::has_cameras`]).
    pub(crate) fn unseen(&self, flat: usize) -> bool {
        self.mask_camera.is_some_and(|mask| mask.values()[flat] == 0)
    }

    /// Whether there are cameras at all.
    pub(crate) fn has_cameras(&self) -> bool {
        self.mask_camera.is_some_and(|mask| mask.values().iter().any(|&seen| seen != 0))
    }

    /// The classes that occur, in id order.
    pub(crate) fn present(&self) -> Vec<u8> {
        let mut occurs = [false; 256];
        self.semantics.values().iter().for_each(|&class| occurs[usize::from(class)] = true);
        occurs[usize::from(self.free)] = false;
        (0..NO_LABEL).filter(|&class| occurs[usize::from(class)]).collect()
    }
}

/// What no camera sees, in its own colour made dull.
pub(crate) fn hidden(color: Rgb<u8>) -> Rgb<u8> {
    mix(color, HIDDEN, 0.58)
}
