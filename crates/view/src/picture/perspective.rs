//! Labels as lit cubes.

use image::{Rgb, RgbImage, imageops};
use nalgebra::{Point3, Vector3};
use occlabel_core::{GridSpec, VoxelIndex};
use rayon::prelude::*;

use crate::picture::canvas::At;
use crate::picture::cast::{Hit, Sight, cast};
use crate::picture::color::{FLOOR, PAPER, SKY, byte, mix};
use crate::picture::legend::Legend;
use crate::picture::lens::Lens;
use crate::picture::marks;
use crate::picture::orbit::Orbit;
use crate::picture::painted::{Painted, hidden};
use crate::picture::shade::{face_light, joint_light, sky_light};

/// The strip that the legend takes at the right of a picture.
const LEGEND_PX: u32 = 270;
/// Where in a pixel it is looked at: four places of different rows and columns.
const SAMPLES: [(f64, f64); 4] = [(0.125, 0.625), (0.375, 0.125), (0.625, 0.875), (0.875, 0.375)];

/// The occupied voxels as lit cubes, over a floor that shows where nothing stands.
///
/// Voxels that no camera sees are dull. Pictures too narrow for a legend have none.
///
/// # Panics
/// If the grids are not of the spec's shape.
pub fn perspective(labels: &Painted, orbit: &Orbit) -> RgbImage {
    labels.check();
    let cameras = labels.has_cameras();
    let lens = orbit.lens(scene_width_px(orbit.width));
    let cubes = Cubes {
        spec: labels.spec,
        line_m: marks::ring_step_m(labels.spec),
        solid: |flat| labels.class(flat).is_some(),
        color: |flat| color(labels, flat, cameras),
    };
    let mut scene = cubes.render(&lens, scene_width_px(orbit.width), orbit.height);
    mark_ego(&mut scene, &lens, labels.spec);
    with_legend(scene, &legend(labels, cameras), orbit)
}

/// How much of a picture's width is the scene's.
pub(crate) fn scene_width_px(width: u32) -> u32 {
    if width > 2 * LEGEND_PX { width - LEGEND_PX } else { width }
}

fn legend(labels: &Painted, cameras: bool) -> Legend {
    let legend = Legend::of(labels);
    if cameras { legend.with_hidden() } else { legend }
}

fn color(labels: &Painted, flat: usize, cameras: bool) -> Rgb<u8> {
    let color = labels.class(flat).map_or(FLOOR, |class| labels.color(class));
    if cameras && labels.unseen(flat) { hidden(color) } else { color }
}

fn with_legend(scene: RgbImage, legend: &Legend, orbit: &Orbit) -> RgbImage {
    if scene.width() == orbit.width {
        return scene;
    }
    let mut picture =
        RgbImage::from_fn(orbit.width, orbit.height, |_, y| backdrop(y, orbit.height));
    imageops::replace(&mut picture, &scene, 0, 0);
    let top = (f64::from(orbit.height) - legend.height_px()).max(0.0) / 2.0;
    legend.draw(&mut picture, At::new(f64::from(scene.width()) + 10.0, top));
    picture
}

/// What is behind everything, by the row.
fn backdrop(y: u32, height: u32) -> Rgb<u8> {
    mix(SKY, PAPER, f64::from(y) / f64::from(height))
}

fn mark_ego(scene: &mut RgbImage, lens: &Lens, spec: &GridSpec) {
    let extent_m = spec.max_m() - spec.min_m();
    let size_m = extent_m.x.max(extent_m.y) / 40.0;
    let dart = [(1.7, 0.0), (-1.0, 0.7), (-0.5, 0.0), (-1.0, -0.7)];
    let corners = dart.map(|(x, y)| lens.project(&Point3::new(x * size_m, y * size_m, 0.0)));
    if let [Some(nose), Some(left), Some(notch), Some(right)] = corners {
        marks::ego(scene, [nose, left, notch, right]);
    }
}

/// What one sample of a pixel shows, and on which face of which voxel.
struct Look {
    face: Option<([i64; 3], usize)>,
    color: Vector3<f64>,
}

/// Voxels to be drawn: which of them, by the place in the flat array, and how coloured.
struct Cubes<'a, S, C> {
    spec: &'a GridSpec,
    solid: S,
    color: C,
    /// How far apart the floor's lines are.
    line_m: f64,
}

impl<S: Fn(usize) -> bool + Sync, C: Fn(usize) -> Rgb<u8> + Sync> Cubes<'_, S, C> {
    fn render(&self, lens: &Lens, width: u32, height: u32) -> RgbImage {
        let row = |y: u32| -> Vec<u8> {
            let behind = backdrop(y, height);
            (0..width).flat_map(|x| self.pixel(lens, x, y, behind)).collect()
        };
        let rows: Vec<_> = (0..height).into_par_iter().map(row).collect();
        RgbImage::from_vec(width, height, rows.concat()).expect("three bytes a pixel")
    }

    /// The mean of a pixel's samples. Two are enough where they meet the same face.
    fn pixel(&self, lens: &Lens, x: u32, y: u32, behind: Rgb<u8>) -> [u8; 3] {
        let sample = |(dx, dy): (f64, f64)| {
            self.look(lens, At::new(f64::from(x) + dx, f64::from(y) + dy), behind)
        };
        let [a, b] = [SAMPLES[0], SAMPLES[3]].map(sample);
        if a.face == b.face {
            return ((a.color + b.color) / 2.0).map(byte).into();
        }
        let [c, d] = [SAMPLES[1], SAMPLES[2]].map(sample);
        ((a.color + b.color + c.color + d.color) / 4.0).map(byte).into()
    }

    /// What is at a point of the picture.
    fn look(&self, lens: &Lens, at: At, behind: Rgb<u8>) -> Look {
        let sight = Sight {
            origin: self.spec.to_voxel_units(&lens.eye),
            along: lens.direction(at).component_div(&self.spec.size_m()),
        };
        let hit = cast(self.spec.shape(), &sight, &self.solid);
        let color = hit.map(|hit| self.lit(&hit, &sight, lens.focal_px / hit.t));
        Look {
            face: hit.map(|hit| (hit.voxel, hit.axis)),
            color: color.unwrap_or(channels(behind)),
        }
    }

    /// The colour of a face where it was met; a metre is drawn `metre_px` large there.
    fn lit(&self, hit: &Hit, sight: &Sight, metre_px: f64) -> Vector3<f64> {
        let at = sight.origin + sight.along * hit.t;
        let sky = sky_light(hit, &at, |voxel| self.is_solid(voxel));
        let (color, lines) = match hit.flat {
            Some(flat) => {
                let joints = joint_light(hit, &at, self.spec.size_m().min() * metre_px);
                ((self.color)(flat), joints)
            }
            None => (FLOOR, self.floor_light(&at, metre_px)),
        };
        channels(color) * (face_light(hit) * sky * lines)
    }

    /// Lines on the floor, as far apart as the rings of the picture from above.
    fn floor_light(&self, at: &Vector3<f64>, metre_px: f64) -> f64 {
        let p_m = self.spec.min_m() + at.component_mul(&self.spec.size_m());
        let off_m = |p_m: f64| (p_m - (p_m / self.line_m).round() * self.line_m).abs();
        let off_px = off_m(p_m.x).min(off_m(p_m.y)) * metre_px;
        1.0 + 0.25 * (1.2 - off_px).clamp(0.0, 1.0)
    }

    fn is_solid(&self, voxel: [i64; 3]) -> bool {
        self.spec.flat(VoxelIndex(voxel)).is_some_and(&self.solid)
    }
}

fn channels(color: Rgb<u8>) -> Vector3<f64> {
    Vector3::from(color.0.map(f64::from))
}
