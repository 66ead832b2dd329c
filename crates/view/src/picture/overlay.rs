//! Labels over the images of the cameras.

use image::{Rgb, RgbImage, imageops};
use occlabel_core::{Camera, Pose};

use crate::picture::color::{INK, PAPER, mix};
use crate::picture::cubes::Cubes;
use crate::picture::legend::Legend;
use crate::picture::painted::Painted;
use crate::picture::plate::Plate;
use crate::picture::tiles::Tiles;

/// How much of the labels' colour there is over an image, and where there is no image.
const OVER_IMAGE: f64 = 0.55;
const OVER_NOTHING: f64 = 0.9;

/// A camera at its exposure.
#[derive(Clone, Debug)]
pub struct CameraView<'a> {
    /// Its channel.
    pub name: &'a str,
    /// Its model and its image's size.
    pub camera: &'a Camera,
    /// Where it stood in the keyframe's grid when it was exposed.
    pub grid_from_camera: Pose,
    /// What it saw, at any resolution, if the log has it.
    pub image: Option<&'a RgbImage>,
}

impl CameraView<'_> {
    /// Over each pixel the first occupied voxel on its line of sight, half transparent, with the
    /// edges of large ones; pixels of the vehicle itself and beyond the model's range are bare.
    ///
    /// # Panics
    /// If the grids are not of the spec's shape.
    pub fn overlay(&self, labels: &Painted, (width, height): (u32, u32)) -> RgbImage {
        labels.check();
        let mut picture = match self.image {
            Some(image) if image.dimensions() == (width, height) => image.clone(),
            Some(image) => imageops::resize(image, width, height, imageops::FilterType::Triangle),
            None => RgbImage::from_pixel(width, height, mix(PAPER, Rgb([0; 3]), 0.5)),
        };
        let cubes = Cubes {
            spec: labels.spec,
            solid: |flat| labels.class(flat).is_some(),
            color: |flat| labels.class(flat).map_or(INK, |class| labels.color(class)),
            floor: false,
            opacity: if self.image.is_some() { OVER_IMAGE } else { OVER_NOTHING },
        };
        cubes.render(&self.gaze((width, height)), &mut picture);
        picture
    }
}

impl Plate<'_> {
    /// The labels over what cameras saw: one large, several as a sheet.
    ///
    /// # Panics
    /// If the grids are not of the spec's shape.
    pub fn overlay(&self, labels: &Painted, views: &[CameraView]) -> RgbImage {
        let aspects: Vec<f64> = views.iter().map(CameraView::aspect).collect();
        let mut tiles = Tiles::new(&aspects, self.body_px());
        for (place, view) in views.iter().enumerate() {
            let size = tiles.size_px(view.aspect());
            let bare = if view.image.is_some() { "" } else { " (no image at this keyframe)" };
            let caption = format!("{}{bare}", view.name);
            tiles.put(place as u32, &view.overlay(labels, size), &caption);
        }
        self.around(&tiles.into_picture(), &Legend::of(labels))
    }
}
