//! Rays through the pixels of a camera.
//!
//! Most of them see nothing that others have not seen before them. So a few are cast first, and then
//! the rest in blocks: a beam around a block's rays goes as far as it surely sees nothing new; where
//! it may, its parts go on from there, and of those in the end single rays, each walked exactly.

use nalgebra::{Matrix3, Vector3};
use occlabel_core::{LATTICE, LatticePoint};

use crate::Eye;
use crate::beam::Beam;
use crate::cones::{Block, Cone, Cones, LEAF_PX};
use crate::look::Look;
use crate::march::{Front, march};

/// Of the rays of every so many-th row and column each is cast at first.
const FIRST_PX: usize = 8;

/// More than snapping moves the end of a ray against its start, voxels.
const SNAP: f64 = 4.0 / LATTICE as f64;

/// Rays of a smallest block: four quarters of four pixels.
type Ends = [[Option<LatticePoint>; 4]; 4];

/// Marks all that is seen by the rays through pixels, `depth_m` long.
pub(crate) fn cast_pixels(look: &mut Look, eye: &Eye, cones: &Cones, depth_m: f64) {
    let stretch = look.spec.size_m().map(|size| depth_m / size);
    let grid_from_camera = eye.grid_from_camera.rotation.to_rotation_matrix().into_inner();
    let start = Vector3::from(look.start.0.map(|q| q as f64 / LATTICE as f64));
    let is_bundled = look.is_bundled();
    let voxels_from_camera = Matrix3::from_diagonal(&stretch) * grid_from_camera;
    let mut rays = PixelRays { look, eye, cones, depth_m, start, stretch, voxels_from_camera };
    if is_bundled && rays.has_any() {
        rays.look.open_eye();
        rays.cast_some(FIRST_PX);
        cones.blocks().for_each(|block| rays.cast_block(block, None));
    } else if !is_bundled {
        rays.cast_some(1);
    }
}

struct PixelRays<'a, 'b> {
    look: &'a mut Look<'b>,
    eye: &'a Eye<'a>,
    cones: &'a Cones<'a>,
    depth_m: f64,
    /// Where the rays start, voxels.
    start: Vector3<f64>,
    /// Lengths of rays along each axis, voxels.
    stretch: Vector3<f64>,
    /// From unit directions to ways.
    voxels_from_camera: Matrix3<f64>,
}

impl PixelRays<'_, '_> {
    fn has_any(&self) -> bool {
        let (columns, rows) = self.cones.size();
        let mut places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        places.any(|(column, row)| self.end(column, row).is_some())
    }

    /// Casts the rays of every `step`-th row and column.
    fn cast_some(&mut self, step: usize) {
        let (columns, rows) = self.cones.size();
        for row in (0..rows).step_by(step) {
            for column in (0..columns).step_by(step) {
                if let Some(end) = self.end(column, row) {
                    self.look.along(end);
                }
            }
        }
    }

    fn cast_block(&mut self, block: Block, from: Option<Front>) {
        let Some(cone) = self.cones.at(block) else { return };
        let mut front = from;
        if let Some(beam) = self.beam(&cone, from.map(|front| front.axis)) {
            front = self.go_on(beam, from.as_ref());
            if front.is_none() {
                return;
            }
        }
        if block.level > 0 {
            block.parts().into_iter().for_each(|part| self.cast_block(part, front));
        } else {
            self.cast_smallest(&self.ends(block), front);
        }
    }

    fn beam(&self, cone: &Cone, axis: Option<usize>) -> Option<Beam> {
        let way = self.voxels_from_camera * Vector3::from(cone.centre).cast::<f64>();
        let spread = self.stretch * f64::from(cone.radius) + Vector3::repeat(SNAP);
        Beam::new(&self.start, &way, &spread, axis)
    }

    /// Lets a beam go on; `None` if none of its rays sees anything new.
    fn go_on(&self, beam: Beam, from: Option<&Front>) -> Option<Front> {
        let beam = from.map_or(Some(beam), |front| beam.within(&front.bounds))?;
        march(self.look, beam, from)
    }

    fn cast_smallest(&mut self, ends: &Ends, from: Option<Front>) {
        let Some(from) = from else {
            return ends.as_flattened().iter().flatten().for_each(|end| self.look.along(*end));
        };
        let Some(from) = self.go_on_to(ends.as_flattened(), from) else { return };
        for quarter in ends {
            let Some(from) = self.go_on_to(quarter, from) else { continue };
            for end in quarter {
                if let (Some(from), Some(end)) = (self.go_on_to(&[*end], from), end) {
                    self.look.along_after(*end, from.axis, from.sure);
                }
            }
        }
    }

    /// Lets rays to known ends go on; `None` if none of them sees anything new.
    fn go_on_to(&self, ends: &[Option<LatticePoint>], from: Front) -> Option<Front> {
        let mut ends = ends.iter().flatten().peekable();
        ends.peek()?;
        match Beam::to_ends(&self.look.start, ends, from.axis) {
            Some(beam) => self.go_on(beam, Some(&from)),
            None => Some(from),
        }
    }

    /// The ends of the rays of a smallest block.
    fn ends(&self, block: Block) -> Ends {
        let (left, upper) = block.corner();
        let half = LEAF_PX / 2;
        [(0, 0), (half, 0), (0, half), (half, half)].map(|(x, y)| {
            let (left, upper) = (left + x, upper + y);
            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| self.end(left + x, upper + y))
        })
    }

    /// The end of the ray through a pixel, counted by the stride.
    fn end(&self, column: u32, row: u32) -> Option<LatticePoint> {
        let (column, row) = self.cones.pixel(column, row)?;
        Some(self.look.spec.snap(&self.eye.pixel_end(column, row, self.depth_m)?))
    }
}
