//! What of a surface a lidar sees, and where it is nearest to a point.

use nalgebra::{Point3, Vector3};
use occlabel_core::TriangleMesh;
use parry3d_f64::math::Vector;
use parry3d_f64::query::{PointQueryWithLocation, Ray, RayCast};
use parry3d_f64::shape::{TriMesh, Triangle};

/// A face hides another only if it lies this much nearer, metres: neighbours do not hide each other.
const HIDDEN_BY_M: f64 = 1e-3;
/// A point this near to a face is on it, and the face's normal tells the way off it, metres.
const ON_SURFACE_M: f64 = 1e-9;

/// A surface, ready to be asked.
pub(crate) struct Surface(TriMesh);

/// The place of a surface that is nearest to a point.
pub(crate) struct Foot {
    pub(crate) at: Point3<f64>,
    /// Unit vector, the way from there to the point; on the surface its normal.
    pub(crate) normal: Vector3<f64>,
    pub(crate) distance_m: f64,
}

impl Surface {
    /// The whole surface of a mesh, seen from a place of one's own.
    pub(crate) fn of(mesh: &TriangleMesh, seen_from: &Point3<f64>) -> Option<Self> {
        let corner = |vertex: &Point3<f64>| to_parry(&(vertex - seen_from.coords));
        let corners = mesh.vertices().iter().map(corner).collect();
        TriMesh::new(corners, mesh.faces().to_vec()).ok().map(Self)
    }

    /// The faces that look to a place and are not hidden from it by other faces; none if there are none.
    pub(crate) fn visible_from(&self, eye: &Point3<f64>) -> Option<Self> {
        let eye = to_parry(eye);
        let is_visible = |(face, _): &(Triangle, &[u32; 3])| self.is_visible(face, eye);
        let faces = self.0.triangles().zip(self.0.indices()).filter(is_visible);
        let faces: Vec<[u32; 3]> = faces.map(|(_, corners)| *corners).collect();
        TriMesh::new(self.0.vertices().to_vec(), faces).ok().map(Self)
    }

    fn is_visible(&self, face: &Triangle, eye: Vector) -> bool {
        let way = face.center() - eye;
        let distance_m = way.length();
        let looks_here = face.scaled_normal().dot(way) < 0.0;
        let is_hidden = || {
            let ray = Ray::new(eye, way / distance_m);
            self.0.cast_local_ray(&ray, distance_m - HIDDEN_BY_M, false).is_some()
        };
        looks_here && !is_hidden()
    }

    /// The nearest place to a point.
    pub(crate) fn nearest(&self, point: &Point3<f64>) -> Foot {
        let (found, (face, _)) =
            self.0.project_local_point_and_get_location(to_parry(point), false);
        let at = Point3::new(found.point.x, found.point.y, found.point.z);
        let way = point - at;
        let distance_m = way.norm();
        let normal = match distance_m > ON_SURFACE_M {
            true => way / distance_m,
            false => self.normal_of(face),
        };
        Foot { at, normal, distance_m }
    }

    fn normal_of(&self, face: u32) -> Vector3<f64> {
        let normal = self.0.triangle(face).normal().unwrap_or(Vector::Z);
        Vector3::new(normal.x, normal.y, normal.z)
    }
}

/// Between nalgebra, which the project speaks, and glam, which parry speaks: plain numbers.
pub(crate) fn to_parry(p: &Point3<f64>) -> Vector {
    Vector::new(p.x, p.y, p.z)
}
