//! Convex hulls, as the half-spaces of their faces.

use nalgebra::{Point3, Vector3};
use occlabel_core::Fault;
use parry3d_f64::math::Vector;
use parry3d_f64::shape::{SupportMap, TriMesh};
use parry3d_f64::transformation::try_convex_hull;

use crate::check::{metres, need};
use crate::clip::Clip;
use crate::convert::{from_parry, to_parry};
use crate::nearest::Nearest;
use crate::{Impact, Ray};

/// A point this far beyond a plane still counts as on it, metres.
const FLAT_M: f64 = 1e-9;
/// So many points a hull has at most: its faces are found by trying every three of them.
const MOST_POINTS: usize = 64;

/// A convex solid.
#[derive(Clone, Debug)]
pub(crate) struct Hull {
    points: Vec<Point3<f64>>,
    faces: Vec<Face>,
    surface: TriMesh,
}

/// All that lies in the solid has `normal * p <= reach_m`.
#[derive(Clone, Debug, PartialEq)]
struct Face {
    normal: Vector3<f64>,
    reach_m: f64,
}

impl Hull {
    /// The hull of points that do not all lie in one plane.
    pub(crate) fn new(points_m: &[[f64; 3]]) -> Result<Self, Fault> {
        const KEY: &str = "hull.points_m";
        let count = points_m.len();
        need(KEY, (4..=MOST_POINTS).contains(&count), "4 to 64 points", count)?;
        metres(KEY, points_m.as_flattened())?;
        let points: Vec<_> = points_m.iter().map(|&p| Point3::from(p)).collect();
        let faces = faces(&points);
        let solid = faces.len() >= 4 && faces.iter().all(|face| face.has_depth(&points));
        need(KEY, solid, "points that span a solid", "points in one plane")?;
        let surface =
            surface(&points).map_err(|found| Fault::new("world", KEY, "a solid", found))?;
        Ok(Self { points, faces, surface })
    }

    pub(crate) fn cast(&self, ray: &Ray) -> Option<Impact> {
        let cut = |clip: Clip, face: &Face| clip.half_space(ray, &face.normal, face.reach_m);
        self.faces.iter().fold(Clip::whole(), cut).impact(ray)
    }

    pub(crate) fn contains(&self, p: &Point3<f64>) -> bool {
        self.faces.iter().all(|face| face.beyond_m(p) <= 0.0)
    }

    pub(crate) fn nearest(&self, p: &Point3<f64>) -> Nearest {
        Nearest::of_surface(&self.surface, p, Some(self.contains(p))).0
    }

    /// The corners and the triangles of its surface.
    pub(crate) fn triangles(&self) -> (Vec<Vector>, Vec<[u32; 3]>) {
        (self.surface.vertices().to_vec(), self.surface.indices().to_vec())
    }

    pub(crate) fn bounds(&self) -> [Point3<f64>; 2] {
        let first = self.points[0];
        [
            self.points.iter().fold(first, |a, b| a.inf(b)),
            self.points.iter().fold(first, |a, b| a.sup(b)),
        ]
    }
}

impl SupportMap for Hull {
    fn local_support_point(&self, dir: Vector) -> Vector {
        let reach = |p: &&Point3<f64>| p.coords.dot(&from_parry(dir));
        let farthest = self.points.iter().max_by(|a, b| reach(a).total_cmp(&reach(b)));
        farthest.map_or(Vector::ZERO, to_parry)
    }
}

impl Face {
    fn beyond_m(&self, p: &Point3<f64>) -> f64 {
        self.normal.dot(&p.coords) - self.reach_m
    }

    fn has_depth(&self, points: &[Point3<f64>]) -> bool {
        points.iter().any(|p| self.beyond_m(p) < -1e3 * FLAT_M)
    }
}

fn surface(points: &[Point3<f64>]) -> Result<TriMesh, String> {
    let corners: Vec<Vector> = points.iter().map(to_parry).collect();
    let (corners, faces) = try_convex_hull(&corners).map_err(|error| error.to_string())?;
    TriMesh::new(corners, faces).map_err(|error| error.to_string())
}

/// Every plane through three of the points that has no point beyond it, each once.
fn faces(points: &[Point3<f64>]) -> Vec<Face> {
    let mut faces: Vec<Face> = Vec::new();
    for a in 0..points.len() {
        for b in a + 1..points.len() {
            for c in (b + 1..points.len()).flat_map(|c| [[b, c], [c, b]]) {
                let Some(face) = plane(&points[a], &points[c[0]], &points[c[1]]) else { continue };
                let known = faces.iter().any(|known| (known.normal - face.normal).norm() < FLAT_M);
                if !known && points.iter().all(|p| face.beyond_m(p) <= FLAT_M) {
                    faces.push(face);
                }
            }
        }
    }
    faces
}

fn plane(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>) -> Option<Face> {
    let normal = (b - a).cross(&(c - a)).try_normalize(FLAT_M * FLAT_M)?;
    Some(Face { normal, reach_m: normal.dot(&a.coords) })
}
