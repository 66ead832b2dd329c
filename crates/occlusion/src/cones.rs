//! Cones around the directions of blocks of pixels.

use nalgebra::{Point2, Vector3};
use occlabel_core::Camera;
use occlabel_core::camera::CameraModel;

/// Pixels along the side of the smallest blocks, counted by the stride.
pub(crate) const LEAF_PX: u32 = 4;

/// How often blocks are joined by four.
const LEVELS: u32 = 5;

/// Added to radii: far above what centres and radii lose as f32.
const ROUNDING: f32 = 1e-6;

/// A ball that holds the unit directions of a block of pixels, camera frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cone {
    pub(crate) centre: [f32; 3],
    pub(crate) radius: f32,
}

/// A block of pixels: its place among those of its level. At level 0 it has 4 x 4 pixels, each
/// level above doubles its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Block {
    pub(crate) level: u32,
    pub(crate) column: u32,
    pub(crate) row: u32,
}

/// The blocks of every `stride`-th pixel of each row and column of a camera.
pub(crate) struct Cones<'a> {
    camera: &'a Camera,
    stride: u32,
    /// From the smallest blocks up; none for a pinhole, whose blocks lie between their corners.
    levels: &'a [Level],
}

/// The cones of all blocks of a level; none where no pixel has a direction.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    columns: u32,
    rows: u32,
    cones: Vec<Option<Cone>>,
}

impl Block {
    /// Its four parts, of the level below.
    pub(crate) fn parts(self) -> [Self; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(column, row)| Self {
            level: self.level - 1,
            column: 2 * self.column + column,
            row: 2 * self.row + row,
        })
    }

    /// Pixels along its side, counted by the stride.
    fn side(self) -> u32 {
        LEAF_PX << self.level
    }

    /// Its first pixel, counted by the stride.
    pub(crate) fn corner(self) -> (u32, u32) {
        (self.column * self.side(), self.row * self.side())
    }
}

impl<'a> Cones<'a> {
    /// The cones of a camera, from what [`levels`] gave for it and the same stride.
    pub(crate) fn new(camera: &'a Camera, stride: usize, levels: &'a [Level]) -> Self {
        Self { camera, stride: u32::try_from(stride).unwrap_or(u32::MAX), levels }
    }

    /// All blocks of the highest level.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = Block> + use<> {
        blocks(self.size(), LEVELS - 1)
    }

    /// Columns and rows of the image, counted by the stride.
    pub(crate) fn size(&self) -> (u32, u32) {
        (self.camera.width.div_ceil(self.stride), self.camera.height.div_ceil(self.stride))
    }

    /// The pixel at a place counted by the stride, if it is on the image.
    #[inline]
    pub(crate) fn pixel(&self, column: u32, row: u32) -> Option<(u32, u32)> {
        let (columns, rows) = self.size();
        (column < columns && row < rows).then(|| (column * self.stride, row * self.stride))
    }

    /// The cone of a block, if it has any directions.
    pub(crate) fn at(&self, block: Block) -> Option<Cone> {
        match self.levels.get(block.level as usize) {
            Some(level) => level.at(block.column, block.row),
            None => self.between_corners(block),
        }
    }

    /// The cone of a block of a pinhole. Its pixels look between its corners, and a ball about the
    /// origin's sphere that holds the corners holds all directions between them.
    fn between_corners(&self, block: Block) -> Option<Cone> {
        let (columns, rows) = self.size();
        let (left, upper) = block.corner();
        let (right, lower) = (left + block.side() - 1, upper + block.side() - 1);
        let (right, lower) = (right.min(columns - 1), lower.min(rows - 1));
        let corners = [(left, upper), (right, upper), (left, lower), (right, lower)];
        let ways = corners.map(|(column, row)| {
            let (column, row) = self.pixel(column, row)?;
            let centre = Point2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            self.camera.model.unproject(&centre).map(|way| way.into_inner())
        });
        around(ways.into_iter().flatten())
    }

    fn smallest(&self) -> Level {
        let size = self.size();
        let places = (0..LEAF_PX).flat_map(|y| (0..LEAF_PX).map(move |x| (x, y)));
        let cone = |block: Block| {
            let (left, upper) = block.corner();
            around(places.clone().filter_map(|(x, y)| {
                let (column, row) = self.pixel(left + x, upper + y)?;
                self.camera.ray_of(column, row).map(|way| way.into_inner())
            }))
        };
        Level {
            columns: size.0.div_ceil(LEAF_PX),
            rows: size.1.div_ceil(LEAF_PX),
            cones: blocks(size, 0).map(cone).collect(),
        }
    }
}

/// The cones of all blocks of a camera, from the smallest up; none for a pinhole, which needs none.
pub(crate) fn levels(camera: &Camera, stride: usize) -> Vec<Level> {
    if matches!(camera.model, CameraModel::Pinhole(_)) {
        return Vec::new();
    }
    let smallest = Cones::new(camera, stride, &[]).smallest();
    let above = |level: &Level| Some(level.joined());
    std::iter::successors(Some(smallest), above).take(LEVELS as usize).collect()
}

impl Level {
    fn at(&self, column: u32, row: u32) -> Option<Cone> {
        let is_there = column < self.columns && row < self.rows;
        is_there.then(|| self.cones[(row * self.columns + column) as usize]).flatten()
    }

    /// The level above.
    fn joined(&self) -> Self {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let blocks = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let cones = blocks.map(|(column, row)| {
            let parts = Block { level: 1, column, row }.parts();
            join(parts.iter().filter_map(|part| self.at(part.column, part.row)))
        });
        Self { columns, rows, cones: cones.collect() }
    }
}

/// All blocks of a level of an image, by rows.
fn blocks((columns, rows): (u32, u32), level: u32) -> impl Iterator<Item = Block> + use<> {
    let side = LEAF_PX << level;
    let columns = columns.div_ceil(side);
    (0..rows.div_ceil(side))
        .flat_map(move |row| (0..columns).map(move |column| Block { level, column, row }))
}

/// The cone around unit directions, if there are any.
fn around(ways: impl Iterator<Item = Vector3<f64>>) -> Option<Cone> {
    let ways: Vec<Vector3<f64>> = ways.collect();
    let middle = ways.iter().sum::<Vector3<f64>>() / ways.len().max(1) as f64;
    let radius = ways.iter().map(|way| (way - middle).norm()).reduce(f64::max)?;
    Some(cone(middle, radius))
}

/// The cone around cones, if there are any.
fn join(cones: impl Iterator<Item = Cone> + Clone) -> Option<Cone> {
    let centre = |cone: Cone| Vector3::from(cone.centre).cast::<f64>();
    let middle =
        cones.clone().map(centre).sum::<Vector3<f64>>() / cones.clone().count().max(1) as f64;
    let reach = |cone: Cone| (centre(cone) - middle).norm() + f64::from(cone.radius);
    let radius = cones.map(reach).reduce(f64::max)?;
    Some(cone(middle, radius))
}

fn cone(centre: Vector3<f64>, radius: f64) -> Cone {
    Cone { centre: centre.map(|c| c as f32).into(), radius: radius as f32 + ROUNDING }
}

#[cfg(test)]
mod tests {
    use super::*;
    use occlabel_core::camera::{BrownConrady, Intrinsics, Mei, Ocam, Pinhole};

    fn cameras() -> [Camera; 4] {
        let k = [[70.0, 0.5, 40.0], [0.0, 65.0, 31.0], [0.0, 0.0, 1.0]];
        let plane = Intrinsics::from_matrix(&k).unwrap();
        let bend = [-0.3, 0.1, 0.001, -0.0005, 0.0];
        let ray = [70.0, 0.0, -0.003];
        [
            CameraModel::Pinhole(Pinhole::new(plane)),
            CameraModel::BrownConrady(BrownConrady::new(plane, &bend).unwrap()),
            CameraModel::Mei(Mei::new(plane, &[0.9, -0.1, 0.05, 0.0003, 0.0002]).unwrap()),
            CameraModel::Ocam(Ocam::new(&ray, [40.0, 30.0], [1.0, 0.0, 0.0], 0.5).unwrap()),
        ]
        .map(|model| Camera {
            model,
            width: 83,
            height: 59,
            body_mask: None,
            rolling_shutter: None,
        })
    }

    /// How far a pixel's direction lies within each cone over it, the nearest.
    fn room(cones: &Cones, column: u32, row: u32) -> Option<f64> {
        let (x, y) = cones.pixel(column, row)?;
        let way = cones.camera.ray_of(x, y)?.into_inner();
        let levels = (0..LEVELS).map(|level| {
            let side = LEAF_PX << level;
            let block = Block { level, column: column / side, row: row / side };
            let cone = cones.at(block).expect("a cone over every direction");
            let away = (way - Vector3::from(cone.centre).cast::<f64>()).norm();
            f64::from(cone.radius) - away
        });
        levels.reduce(f64::min)
    }

    #[test]
    fn a_block_holds_the_directions_of_all_its_pixels() {
        for (camera, stride) in cameras().iter().flat_map(|c| [1, 3].map(|stride| (c, stride))) {
            let levels = levels(camera, stride);
            let cones = Cones::new(camera, stride, &levels);
            let (columns, rows) = cones.size();
            let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
            let rooms: Vec<f64> = places.filter_map(|(c, r)| room(&cones, c, r)).collect();
            let least = rooms.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(least >= 0.0, "{} by {stride}: {least}", camera.model.name());
            let rays = (columns * rows) as usize;
            assert!(rooms.len() > rays / 3, "{} of {rays}", rooms.len());
        }
    }

    #[test]
    fn the_highest_blocks_cover_the_image() {
        let [camera, ..] = cameras();
        let blocks: Vec<Block> = Cones::new(&camera, 1, &[]).blocks().collect();
        assert_eq!(
            blocks.iter().map(|block| block.corner()).collect::<Vec<_>>(),
            [(0, 0), (64, 0)]
        );
    }
}
