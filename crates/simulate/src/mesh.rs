//! Closed surfaces of triangles, and what they enclose.

use std::collections::BTreeSet;

use nalgebra::Point3;
use occlabel_core::Fault;
use parry3d_f64::math::{Pose as ParryPose, Vector};
use parry3d_f64::query::details::distance_composite_shape_shape;
use parry3d_f64::query::{DefaultQueryDispatcher, PointQuery, RayCast};
use parry3d_f64::shape::{Cuboid, TriMesh, TriMeshFlags};

use crate::check::{metres, need};
use crate::convert::{from_parry, ray_to_parry, to_parry};
use crate::nearest::Nearest;
use crate::{Impact, Ray};

/// A solid within a closed surface. Surfaces that pass through themselves are not refused.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    surface: TriMesh,
    across_m: f64,
}

impl Mesh {
    /// A solid from its surface: every edge has two triangles, normals point outwards.
    pub(crate) fn new(vertices_m: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Self, Fault> {
        metres("mesh.vertices_m", vertices_m.as_flattened())?;
        check_faces(vertices_m, faces)?;
        let corners = vertices_m.iter().map(|&v| to_parry(&v.into())).collect();
        let surface = TriMesh::with_flags(corners, faces.to_vec(), TriMeshFlags::ORIENTED)
            .map_err(|error| Fault::new("world", "mesh.faces", "a surface", error.to_string()))?;
        let across_m = surface.local_aabb().extents().length();
        Ok(Self { surface, across_m })
    }

    pub(crate) fn cast(&self, ray: &Ray, max_m: f64) -> Option<Impact> {
        // As far as the surface reaches, so that a ray from inside always finds its way out.
        let reach_m = max_m.max(self.across_m);
        let line = ray_to_parry(ray);
        let hit = self.surface.cast_local_ray_and_get_normal(&line, reach_m, false)?;
        let outside = Impact { distance_m: hit.time_of_impact, normal: from_parry(hit.normal) };
        Some(if self.surface.is_backface(hit.feature) { Impact::inside(ray) } else { outside })
    }

    pub(crate) fn contains(&self, p: &Point3<f64>) -> bool {
        self.surface.contains_local_point(to_parry(p))
    }

    pub(crate) fn nearest(&self, p: &Point3<f64>) -> Nearest {
        Nearest::of_surface(&self.surface, p, None).0
    }

    pub(crate) fn gap_m(&self, cuboid: &Cuboid, mesh_from_cuboid: &ParryPose) -> f64 {
        let centre = Point3::from(from_parry(mesh_from_cuboid.translation));
        if self.contains(&centre) {
            return 0.0;
        }
        surface_gap_m(&self.surface, cuboid, mesh_from_cuboid)
    }

    /// The corners and the triangles of its surface.
    pub(crate) fn triangles(&self) -> (Vec<Vector>, Vec<[u32; 3]>) {
        (self.surface.vertices().to_vec(), self.surface.indices().to_vec())
    }

    pub(crate) fn bounds(&self) -> [Point3<f64>; 2] {
        let aabb = self.surface.local_aabb();
        [aabb.mins, aabb.maxs].map(|corner| Point3::from(from_parry(corner)))
    }
}

/// From a cuboid to the nearest triangle of a surface.
pub(crate) fn surface_gap_m(
    surface: &TriMesh,
    cuboid: &Cuboid,
    surface_from_cuboid: &ParryPose,
) -> f64 {
    let dispatcher = DefaultQueryDispatcher;
    distance_composite_shape_shape(&dispatcher, surface_from_cuboid, surface, cuboid).distance
}

fn check_faces(vertices_m: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<(), Fault> {
    const KEY: &str = "mesh.faces";
    let known = |&corner: &u32| (corner as usize) < vertices_m.len();
    let stray = faces.as_flattened().iter().find(|corner| !known(corner));
    let expected = format!("corners below {}", vertices_m.len());
    need(KEY, stray.is_none(), &expected, stray.copied().unwrap_or(0))?;
    need(KEY, is_closed(faces), "two triangles at every edge, turning alike", "an open surface")?;
    let corner = |at: u32| Point3::from(vertices_m[at as usize]).coords;
    let six_volumes: f64 =
        faces.iter().map(|&[a, b, c]| corner(a).dot(&corner(b).cross(&corner(c)))).sum();
    let flat = faces
        .iter()
        .any(|&[a, b, c]| (corner(b) - corner(a)).cross(&(corner(c) - corner(a))).norm() < 1e-12);
    need(KEY, !flat, "triangles with an area", "a triangle without")?;
    need(KEY, six_volumes > 0.0, "corners counter-clockwise from outside", "a surface inside out")
}

/// Whether every edge is run along once in each direction.
fn is_closed(faces: &[[u32; 3]]) -> bool {
    let edges = || faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let ways: BTreeSet<_> = edges().collect();
    let once = ways.len() == 3 * faces.len();
    !faces.is_empty() && once && edges().all(|(a, b)| ways.contains(&(b, a)))
}
