//! The nearest place of a solid's surface, seen from a point in or outside it.

use nalgebra::{Point3, Vector2, Vector3};
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{Capsule, TriMesh};

use crate::convert::{from_parry, to_parry};

/// A point this near to a surface of triangles takes the triangle's own normal, metres.
const ON_SURFACE_M: f64 = 1e-9;

/// Where a solid's surface is, seen from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    /// Distance from the surface, below 0 within the solid, metres.
    pub(crate) distance_m: f64,
    /// Unit normal of the surface there, outwards; on an edge, the way from it to the point.
    pub(crate) normal: Vector3<f64>,
    /// Within this distance of the nearest place, the solid is all that lies behind one plane.
    pub(crate) flat_m: f64,
}

impl Nearest {
    /// A place on a surface about which nothing more is known.
    fn curved(distance_m: f64, normal: Vector3<f64>) -> Self {
        Self { distance_m, normal, flat_m: 0.0 }
    }

    /// The nearest place itself, for the point it was found from.
    pub(crate) fn foot(&self, p: &Point3<f64>) -> Point3<f64> {
        p - self.normal * self.distance_m
    }

    /// Of a box around the origin.
    pub(crate) fn of_cuboid(half: &Vector3<f64>, p: &Point3<f64>) -> Self {
        let over = p.coords.abs() - half;
        let axis = over.imax();
        if over[axis] > 0.0 {
            let way = over.sup(&Vector3::zeros()).component_mul(&p.coords.map(f64::signum));
            let distance_m = way.norm();
            let edges = Self::curved(distance_m, way / distance_m);
            let beside = over.iter().filter(|&&over| over > 0.0).count();
            return if beside == 1 { edges.flat(cuboid_flat_m(half, &over, axis)) } else { edges };
        }
        let mut normal = Vector3::zeros();
        normal[axis] = p[axis].signum();
        Self::curved(over[axis], normal).flat(cuboid_flat_m(half, &over, axis))
    }

    /// Of a cylinder around the z axis.
    pub(crate) fn of_cylinder(radius_m: f64, half_m: f64, p: &Point3<f64>) -> Self {
        let across_m = p.coords.xy().norm();
        let out = if across_m > 0.0 { p.coords.xy() / across_m } else { Vector2::x() };
        let up = p.z.signum();
        let (beside_m, above_m) = (across_m - radius_m, p.z.abs() - half_m);
        let (distance_m, [aside, along]) = if beside_m > 0.0 && above_m > 0.0 {
            let distance_m = libm::hypot(beside_m, above_m);
            (distance_m, [beside_m / distance_m, above_m / distance_m])
        } else if beside_m > above_m {
            (beside_m, [1.0, 0.0])
        } else {
            (above_m, [0.0, 1.0])
        };
        Self::curved(distance_m, Vector3::new(out.x * aside, out.y * aside, up * along))
    }

    /// Of a capsule.
    pub(crate) fn of_capsule(capsule: &Capsule, p: &Point3<f64>) -> Self {
        let [from, to] = [capsule.segment.a, capsule.segment.b].map(from_parry);
        let (along, way) = (to - from, p.coords - from);
        let share = way.dot(&along) / along.norm_squared();
        // A capsule without length has no share.
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        let out = way - along * share;
        let across_m = out.norm();
        let normal = if across_m > 0.0 { out / across_m } else { any_across(&along) };
        Self::curved(across_m - capsule.radius, normal)
    }

    /// Of a closed surface of triangles, and the number of the nearest one. `inside` is told by
    /// whoever knows better than the surface.
    pub(crate) fn of_surface(
        surface: &TriMesh,
        p: &Point3<f64>,
        inside: Option<bool>,
    ) -> (Self, usize) {
        let (foot, (face, _)) = surface.project_local_point_and_get_location(to_parry(p), false);
        let way = p.coords - from_parry(foot.point);
        let across_m = way.norm();
        let sign = if inside.unwrap_or(foot.is_inside) { -1.0 } else { 1.0 };
        let normal = if across_m > ON_SURFACE_M {
            way / (across_m * sign)
        } else {
            let normal = surface.triangle(face).normal();
            normal.map_or_else(Vector3::z, from_parry)
        };
        (Self::curved(across_m * sign, normal), face as usize)
    }

    /// The same place, told how far its surface is flat.
    pub(crate) fn flat(self, flat_m: f64) -> Self {
        Self { flat_m, ..self }
    }
}

/// From a place on the face across an axis to the nearest other face.
fn cuboid_flat_m(half: &Vector3<f64>, over: &Vector3<f64>, axis: usize) -> f64 {
    let others = (0..3).filter(|&other| other != axis).map(|other| -over[other]);
    others.fold(2.0 * half[axis], f64::min)
}

/// Some unit vector at right angles to a vector.
fn any_across(along: &Vector3<f64>) -> Vector3<f64> {
    let mut least = Vector3::zeros();
    least[along.iamin()] = 1.0;
    along.cross(&least).try_normalize(0.0).unwrap_or_else(Vector3::x)
}
