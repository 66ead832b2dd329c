//! Voxels as lit cubes, through any lens.

use image::{Rgb, RgbImage};
use nalgebra::Vector3;
use occlabel_core::{GridSpec, VoxelIndex};
use rayon::prelude::*;

use crate::picture::canvas::At;
use crate::picture::cast::{Hit, Sight, cast};
use crate::picture::color::{FLOOR, byte};
use crate::picture::gaze::Gaze;
use crate::picture::marks;
use crate::picture::shade::{face_light, joint_light, sky_light};

/// Where in a pixel it is looked at: four places of different rows and columns.
const SAMPLES: [(f64, f64); 4] = [(0.125, 0.625), (0.375, 0.125), (0.625, 0.875), (0.875, 0.375)];

/// Voxels to be drawn: which of them, by the place in the flat array, and how coloured.
pub(crate) struct Cubes<'a, S, C> {
    pub(crate) spec: &'a GridSpec,
    pub(crate) solid: S,
    pub(crate) color: C,
    /// Whether the floor under the grid is drawn.
    pub(crate) floor: bool,
    /// 1 hides what is behind.
    pub(crate) opacity: f64,
}

/// What one sample of a pixel shows, and on which face of which voxel.
struct Look {
    face: Option<([i64; 3], usize)>,
    color: Vector3<f64>,
}

impl<S: Fn(usize) -> bool + Sync, C: Fn(usize) -> Rgb<u8> + Sync> Cubes<'_, S, C> {
    /// Draws them over a picture. The voxel that holds the eye is not drawn.
    pub(crate) fn render(&self, gaze: &impl Gaze, picture: &mut RgbImage) {
        let (width, eye) = (picture.width() as usize, gaze.eye());
        let own = self.spec.flat_of(&eye);
        let view = View {
            cubes: self,
            gaze,
            origin: self.spec.to_voxel_units(&eye),
            own,
            line_m: marks::ring_step_m(self.spec),
        };
        picture.par_chunks_mut(3 * width.max(1)).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
                let behind = Vector3::new(pixel[0], pixel[1], pixel[2]).map(f64::from);
                pixel.copy_from_slice(&view.pixel(x, y, behind));
            }
        });
    }
}

/// Cubes as seen from one eye.
struct View<'a, G, S, C> {
    cubes: &'a Cubes<'a, S, C>,
    gaze: &'a G,
    /// The eye, voxel units.
    origin: Vector3<f64>,
    /// The voxel that holds the eye.
    own: Option<usize>,
    /// How far apart the floor's lines are.
    line_m: f64,
}

impl<G: Gaze, S: Fn(usize) -> bool, C: Fn(usize) -> Rgb<u8>> View<'_, G, S, C> {
    /// The mean of a pixel's samples. Two are enough where they meet the same face.
    fn pixel(&self, x: usize, y: usize, behind: Vector3<f64>) -> [u8; 3] {
        let sample =
            |(dx, dy): (f64, f64)| self.look(At::new(x as f64 + dx, y as f64 + dy), behind);
        let [a, b] = [SAMPLES[0], SAMPLES[3]].map(sample);
        if a.face == b.face {
            return ((a.color + b.color) / 2.0).map(byte).into();
        }
        let [c, d] = [SAMPLES[1], SAMPLES[2]].map(sample);
        ((a.color + b.color + c.color + d.color) / 4.0).map(byte).into()
    }

    /// What is at a point of the picture.
    fn look(&self, at: At, behind: Vector3<f64>) -> Look {
        let spec = self.cubes.spec;
        let seen = self.gaze.direction(at).and_then(|direction| {
            let along = direction.component_div(&spec.size_m());
            let sight = Sight { origin: self.origin, along };
            let hit = cast(spec.shape(), &sight, |flat| self.is_drawn(flat))?;
            (hit.flat.is_some() || self.cubes.floor).then_some((hit, sight))
        });
        match seen {
            None => Look { face: None, color: behind },
            Some((hit, sight)) => {
                let lit = self.lit(&hit, &sight, self.gaze.focal_px() / hit.t);
                let color = behind.lerp(&lit, self.cubes.opacity);
                Look { face: Some((hit.voxel, hit.axis)), color }
            }
        }
    }

    /// The colour of a face where it was met; a metre is drawn `metre_px` large there.
    fn lit(&self, hit: &Hit, sight: &Sight, metre_px: f64) -> Vector3<f64> {
        let spec = self.cubes.spec;
        let at = sight.origin + sight.along * hit.t;
        let sky = sky_light(hit, &at, |voxel| self.is_solid(voxel));
        let (color, lines) = match hit.flat {
            Some(flat) => {
                let joints = joint_light(hit, &at, spec.size_m().min() * metre_px);
                ((self.cubes.color)(flat), joints)
            }
            None => (FLOOR, self.floor_light(&at, metre_px)),
        };
        Vector3::from(color.0.map(f64::from)) * (face_light(hit) * sky * lines)
    }

    /// Lines on the floor, as far apart as the rings of the picture from above.
    fn floor_light(&self, at: &Vector3<f64>, metre_px: f64) -> f64 {
        let spec = self.cubes.spec;
        let p_m = spec.min_m() + at.component_mul(&spec.size_m());
        let off_m = |p_m: f64| (p_m - (p_m / self.line_m).round() * self.line_m).abs();
        let off_px = off_m(p_m.x).min(off_m(p_m.y)) * metre_px;
        1.0 + 0.25 * (1.2 - off_px).clamp(0.0, 1.0)
    }

    fn is_drawn(&self, flat: usize) -> bool {
        Some(flat) != self.own && (self.cubes.solid)(flat)
    }

    fn is_solid(&self, voxel: [i64; 3]) -> bool {
        self.cubes.spec.flat(VoxelIndex(voxel)).is_some_and(|flat| self.is_drawn(flat))
    }
}
