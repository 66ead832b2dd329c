//! The keyframes of a scene, side by side.

use image::RgbImage;
use occlabel_core::{GridSpec, Palette};

use crate::picture::birds_eye::{map, map_size, mark_ego, with_states};
use crate::picture::column::{Column, columns};
use crate::picture::legend::Legend;
use crate::picture::painted::Painted;
use crate::picture::plate::Plate;
use crate::picture::tiles::Tiles;

/// A sheet of keyframes from above, drawn one at a time, so that no two have to be held.
pub struct Strip<'a> {
    plate: Plate<'a>,
    palette: &'a Palette,
    tiles: Tiles,
    drawn: u32,
    present: [bool; 256],
    /// One column of each state that occurs, and what free ones are called.
    states: Vec<Column>,
    free_name: &'static str,
    has_cameras: bool,
}

impl<'a> Strip<'a> {
    /// A strip for a number of keyframes of one palette, in grids like this.
    pub fn new(plate: Plate<'a>, palette: &'a Palette, spec: &GridSpec, keyframes: usize) -> Self {
        Self {
            plate,
            palette,
            tiles: Tiles::new(&vec![aspect(spec); keyframes], plate.body_px()),
            drawn: 0,
            present: [false; 256],
            states: Vec::new(),
            free_name: "free",
            has_cameras: false,
        }
    }

    /// Draws the next keyframe.
    ///
    /// # Panics
    /// If the grids are not of the spec's shape.
    pub fn add(&mut self, labels: &Painted, caption: &str) {
        labels.check();
        let columns = columns(labels);
        let size = map_size(labels.spec, self.tiles.size_px(aspect(labels.spec)));
        let mut tile = map(labels, &columns, size);
        mark_ego(&mut tile, labels, (f64::from(size.0) / 700.0).clamp(0.35, 1.0));
        self.tiles.put(self.drawn, &tile, caption);
        self.drawn += 1;
        self.note(labels, &columns);
    }

    /// What the legend will have to tell.
    fn note(&mut self, labels: &Painted, columns: &[Column]) {
        labels.present().into_iter().for_each(|class| self.present[usize::from(class)] = true);
        self.free_name = labels.free_name();
        self.has_cameras |= labels.has_cameras();
        for column in columns {
            if column.top().is_none() && !self.states.contains(column) {
                self.states.push(*column);
            }
        }
    }

    /// The picture.
    pub fn finish(self) -> RgbImage {
        let classes: Vec<u8> = (0..255).filter(|&id| self.present[usize::from(id)]).collect();
        let legend = Legend::default().with_classes(self.palette, &classes);
        let legend = with_states(legend, self.free_name, &self.states);
        let legend = if self.has_cameras { legend.with_hidden() } else { legend };
        self.plate.around(&self.tiles.into_picture(), &legend)
    }
}

/// Width by height of a map.
fn aspect(spec: &GridSpec) -> f64 {
    let extent_m = spec.max_m() - spec.min_m();
    extent_m.y / extent_m.x
}
