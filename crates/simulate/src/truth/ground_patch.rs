//! The ground about a grid, as a surface of triangles.

use std::ops::RangeInclusive;

use nalgebra::Point3;
use parry3d_f64::math::{Pose as ParryPose, Vector};
use parry3d_f64::shape::{Cuboid, TriMesh};

use crate::Ground;
use crate::convert::{from_parry, to_parry};
use crate::mesh::surface_gap_m;
use crate::nearest::Nearest;

/// A rectangle of the map, metres of the world.
#[derive(Clone, Debug)]
pub(super) struct Window {
    pub(super) x_m: RangeInclusive<f64>,
    pub(super) y_m: RangeInclusive<f64>,
}

/// The ground within a window, in world. What it says of places farther from a point than the
/// window's border is not true.
#[derive(Clone, Debug)]
pub(super) struct GroundPatch<'a> {
    ground: &'a Ground,
    surface: Option<TriMesh>,
    /// The band of each triangle.
    bands: Vec<usize>,
}

/// Triangles in the making.
#[derive(Default)]
struct Quads {
    corners: Vec<Vector>,
    faces: Vec<[u32; 3]>,
    bands: Vec<usize>,
}

impl<'a> GroundPatch<'a> {
    pub(super) fn new(ground: &'a Ground, window: &Window) -> Self {
        let mut quads = Quads::default();
        let xs = cuts(&window.x_m, ground.profile_m.iter().map(|point| point[0]));
        for x in xs.windows(2) {
            for band in 0..ground.bands.len() {
                lay(ground, window, [x[0], x[1]], band, &mut quads);
            }
        }
        let Quads { corners, faces, bands } = quads;
        Self { ground, surface: TriMesh::new(corners, faces).ok(), bands }
    }

    /// The nearest place of the surface, and its band.
    pub(super) fn nearest(&self, p: &Point3<f64>) -> (Nearest, usize) {
        let (band, plane) = self.ground.piece(p);
        let normal = plane.normal();
        let distance_m = plane.gap_m(p) * normal.z;
        let border_m = self.ground.border_m(p);
        let over_one = Nearest { distance_m, normal, flat_m: border_m - distance_m.abs() };
        match &self.surface {
            // No other piece comes as near as the border does.
            Some(surface) if distance_m.abs() > border_m => {
                let inside = self.contains(p);
                let (nearest, face) = Nearest::of_surface(surface, p, Some(inside));
                (nearest, self.bands[face])
            }
            _ => (over_one, band),
        }
    }

    pub(super) fn contains(&self, p: &Point3<f64>) -> bool {
        self.ground.contains(p).is_some()
    }

    pub(super) fn gap_m(&self, cuboid: &Cuboid, world_from_cuboid: &ParryPose) -> f64 {
        let centre = Point3::from(from_parry(world_from_cuboid.translation));
        match &self.surface {
            _ if self.contains(&centre) => 0.0,
            Some(surface) => surface_gap_m(surface, cuboid, world_from_cuboid),
            None => f64::INFINITY,
        }
    }
}

/// The ends of a range, and what cuts it between them.
fn cuts(range: &RangeInclusive<f64>, at: impl Iterator<Item = f64>) -> Vec<f64> {
    let (start, end) = (*range.start(), *range.end());
    let within = at.filter(|&cut| start < cut && cut < end);
    [start].into_iter().chain(within).chain([end]).collect()
}

/// Lays one piece of a band, and the kerb to the next.
fn lay(ground: &Ground, window: &Window, x: [f64; 2], band: usize, quads: &mut Quads) {
    let middle_m = (x[0] + x[1]) / 2.0;
    let [begin, end] = [band.checked_sub(1), Some(band)].map(|border| {
        let until = border.map_or(f64::NEG_INFINITY, |border| ground.bands[border].until_y_m);
        until.clamp(*window.y_m.start(), *window.y_m.end())
    });
    let corner = |x: f64, y: f64, band: usize| {
        let height_m = -ground.plane(middle_m, band).gap_m(&Point3::new(x, y, 0.0));
        Point3::new(x, y, height_m)
    };
    if begin < end {
        let [a, b] = x.map(|x| corner(x, begin, band));
        let [d, c] = x.map(|x| corner(x, end, band));
        quads.push([a, b, c, d], band);
    }
    let border_m = ground.bands[band].until_y_m;
    let rise_m =
        ground.bands.get(band + 1).map_or(0.0, |next| next.raise_m) - ground.bands[band].raise_m;
    if !window.y_m.contains(&border_m) || band + 1 == ground.bands.len() || rise_m == 0.0 {
        return;
    }
    let [a, b] = x.map(|x| corner(x, border_m, band));
    let [d, c] = x.map(|x| corner(x, border_m, band + 1));
    // A kerb belongs to the band above it, as for rays.
    quads.push([a, b, c, d], if rise_m > 0.0 { band + 1 } else { band });
}

impl Quads {
    /// Adds two triangles; corners counter-clockwise seen from outside.
    fn push(&mut self, corners: [Point3<f64>; 4], band: usize) {
        let first = self.corners.len() as u32;
        self.corners.extend(corners.iter().map(to_parry));
        self.faces.extend([[0, 1, 2], [0, 2, 3]].map(|face| face.map(|at| first + at)));
        self.bands.extend([band; 2]);
    }
}
