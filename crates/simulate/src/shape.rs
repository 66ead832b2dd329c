//! The forms of bodies, each in its own frame.
//!
//! Boxes, capsules and meshes are parry's. Its cylinders and hulls meet rays by iteration (GJK) and
//! so only nearly; ours meet them in closed form.

use nalgebra::{Point3, Vector3};
use occlabel_core::Fault;
use parry3d_f64::math::{Pose as ParryPose, Vector};
use parry3d_f64::query::details::distance_support_map_support_map;
use parry3d_f64::query::{PointQuery, RayCast};
use parry3d_f64::shape::{Capsule, Cuboid, SupportMap};
use serde::Deserialize;

use crate::check::{lengths, metres};
use crate::clip::Clip;
use crate::convert::{from_parry, ray_to_parry, to_parry};
use crate::hull::Hull;
use crate::mesh::Mesh;
use crate::nearest::Nearest;
use crate::skin::{self, Skin};
use crate::{Impact, Ray};

/// A shape as a world file says it; metres.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum ShapeFile {
    /// A box around the origin.
    Box {
        /// Extent along x, y, z.
        size_m: [f64; 3],
    },
    /// A cylinder around the z axis, half of it above the origin.
    Cylinder {
        /// Radius.
        radius_m: f64,
        /// Extent along z.
        height_m: f64,
    },
    /// All within a radius of a segment.
    Capsule {
        /// One end of the segment.
        from_m: [f64; 3],
        /// The other end.
        to_m: [f64; 3],
        /// Radius.
        radius_m: f64,
    },
    /// The convex hull of 4 to 64 points.
    Hull {
        /// The points, not all in one plane.
        points_m: Vec<[f64; 3]>,
    },
    /// A closed surface of triangles.
    Mesh {
        /// The corners.
        vertices_m: Vec<[f64; 3]>,
        /// Each triangle's corners, counter-clockwise seen from outside.
        faces: Vec<[u32; 3]>,
    },
}

/// A solid form in its own frame.
#[derive(Clone, Debug)]
pub struct Shape(Form);

#[derive(Clone, Debug)]
enum Form {
    Box(Cuboid),
    Cylinder(Cylinder),
    Capsule(Capsule),
    Hull(Box<Hull>),
    Mesh(Box<Mesh>),
}

/// A cylinder around the z axis; parry's stands around y.
#[derive(Clone, Copy, Debug)]
struct Cylinder {
    radius_m: f64,
    half_m: f64,
}

impl SupportMap for Cylinder {
    fn local_support_point(&self, dir: Vector) -> Vector {
        let across = (dir.x * dir.x + dir.y * dir.y).sqrt();
        let reach = if across > 0.0 { self.radius_m / across } else { 0.0 };
        Vector::new(dir.x * reach, dir.y * reach, self.half_m.copysign(dir.z))
    }
}

impl TryFrom<ShapeFile> for Shape {
    type Error = Fault;

    fn try_from(file: ShapeFile) -> Result<Self, Fault> {
        Ok(Self(match file {
            ShapeFile::Box { size_m } => cuboid(size_m)?,
            ShapeFile::Cylinder { radius_m, height_m } => cylinder(radius_m, height_m)?,
            ShapeFile::Capsule { from_m, to_m, radius_m } => capsule(from_m, to_m, radius_m)?,
            ShapeFile::Hull { points_m } => Form::Hull(Hull::new(&points_m)?.into()),
            ShapeFile::Mesh { vertices_m, faces } => {
                Form::Mesh(Mesh::new(&vertices_m, &faces)?.into())
            }
        }))
    }
}

fn cuboid(size_m: [f64; 3]) -> Result<Form, Fault> {
    lengths("box.size_m", &size_m)?;
    let [x, y, z] = size_m.map(|side| side / 2.0);
    Ok(Form::Box(Cuboid::new(to_parry(&Point3::new(x, y, z)))))
}

fn cylinder(radius_m: f64, height_m: f64) -> Result<Form, Fault> {
    lengths("cylinder.radius_m", &[radius_m])?;
    lengths("cylinder.height_m", &[height_m])?;
    Ok(Form::Cylinder(Cylinder { radius_m, half_m: height_m / 2.0 }))
}

fn capsule(from_m: [f64; 3], to_m: [f64; 3], radius_m: f64) -> Result<Form, Fault> {
    metres("capsule.from_m", &from_m)?;
    metres("capsule.to_m", &to_m)?;
    lengths("capsule.radius_m", &[radius_m])?;
    Ok(Form::Capsule(Capsule::new(to_parry(&from_m.into()), to_parry(&to_m.into()), radius_m)))
}

impl Shape {
    /// Where a ray of the shape's frame first is in it, at most `max_m` away.
    pub fn cast(&self, ray: &Ray, max_m: f64) -> Option<Impact> {
        let impact = match &self.0 {
            Form::Box(form) => parry_cast(form, ray, max_m),
            Form::Cylinder(Cylinder { radius_m, half_m }) => Clip::whole()
                .disc(ray, *radius_m)
                .half_space(ray, &Vector3::z(), *half_m)
                .half_space(ray, &-Vector3::z(), *half_m)
                .impact(ray),
            Form::Capsule(form) => parry_cast(form, ray, max_m),
            Form::Hull(form) => form.cast(ray),
            Form::Mesh(form) => form.cast(ray, max_m),
        };
        impact.filter(|impact| impact.distance_m <= max_m)
    }

    /// Whether a point of the shape's frame lies in it or on its surface.
    pub fn contains(&self, p: &Point3<f64>) -> bool {
        match &self.0 {
            Form::Box(form) => form.contains_local_point(to_parry(p)),
            Form::Cylinder(Cylinder { radius_m, half_m }) => {
                p.z.abs() <= *half_m && p.coords.xy().norm_squared() <= radius_m * radius_m
            }
            Form::Capsule(form) => form.contains_local_point(to_parry(p)),
            Form::Hull(form) => form.contains(p),
            Form::Mesh(form) => form.contains(p),
        }
    }

    /// The place of its surface that is nearest to a point of the shape's frame.
    pub(crate) fn nearest(&self, p: &Point3<f64>) -> Nearest {
        match &self.0 {
            Form::Box(form) => Nearest::of_cuboid(&from_parry(form.half_extents), p),
            Form::Cylinder(form) => Nearest::of_cylinder(form.radius_m, form.half_m, p),
            Form::Capsule(form) => Nearest::of_capsule(form, p),
            Form::Hull(form) => form.nearest(p),
            Form::Mesh(form) => form.nearest(p),
        }
    }

    /// From a cuboid that stands somewhere in the shape's frame to the shape: 0 if they have a point
    /// in common.
    pub(crate) fn gap_m(&self, cuboid: &Cuboid, shape_from_cuboid: &ParryPose) -> f64 {
        let convex = |form: &dyn SupportMap| {
            distance_support_map_support_map(shape_from_cuboid, form, cuboid)
        };
        match &self.0 {
            Form::Box(form) => convex(form),
            Form::Cylinder(form) => convex(form),
            Form::Capsule(form) => convex(form),
            Form::Hull(form) => convex(form.as_ref()),
            Form::Mesh(form) => form.gap_m(cuboid, shape_from_cuboid),
        }
    }

    /// The surface as triangles, with their corners on it.
    pub(crate) fn surface(&self) -> Skin {
        let of_mesh = |(corners, faces): (Vec<Vector>, Vec<[u32; 3]>)| {
            (corners.into_iter().map(|corner| Point3::from(from_parry(corner))).collect(), faces)
        };
        match &self.0 {
            Form::Box(form) => of_mesh(form.to_trimesh()),
            Form::Cylinder(form) => skin::cylinder(form.radius_m, form.half_m),
            Form::Capsule(form) => {
                let [from, to] = [form.segment.a, form.segment.b].map(from_parry).map(Point3::from);
                skin::capsule(&from, &to, form.radius)
            }
            Form::Hull(form) => of_mesh(form.triangles()),
            Form::Mesh(form) => of_mesh(form.triangles()),
        }
    }

    /// Lower and upper corner of what the shape fills of its frame.
    pub(crate) fn bounds(&self) -> [Point3<f64>; 2] {
        let aabb = match &self.0 {
            Form::Box(form) => form.local_aabb(),
            Form::Cylinder(Cylinder { radius_m, half_m }) => {
                let reach = Vector3::new(*radius_m, *radius_m, *half_m);
                return [Point3::from(-reach), Point3::from(reach)];
            }
            Form::Capsule(form) => form.local_aabb(),
            Form::Hull(form) => return form.bounds(),
            Form::Mesh(form) => return form.bounds(),
        };
        [aabb.mins, aabb.maxs].map(|corner| Point3::from(from_parry(corner)))
    }
}

fn parry_cast(form: &impl RayCast, ray: &Ray, max_m: f64) -> Option<Impact> {
    let hit = form.cast_local_ray_and_get_normal(&ray_to_parry(ray), max_m, true)?;
    let outside = Impact { distance_m: hit.time_of_impact, normal: from_parry(hit.normal) };
    Some(if outside.distance_m > 0.0 { outside } else { Impact::inside(ray) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::cell::Cell;

    fn shape(file: ShapeFile) -> Shape {
        Shape::try_from(file).unwrap()
    }

    /// A pyramid: square base of half a diagonal 1 at z = 0, apex at z = 1.
    const PYRAMID: [[f64; 3]; 5] =
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
    const PYRAMID_FACES: [[u32; 3]; 6] =
        [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 2, 1], [0, 3, 2]];

    fn shapes() -> [Shape; 5] {
        [
            ShapeFile::Box { size_m: [2.0, 1.0, 1.0] },
            ShapeFile::Cylinder { radius_m: 0.5, height_m: 2.0 },
            ShapeFile::Capsule { from_m: [0.0, 0.0, -0.5], to_m: [0.0, 0.0, 0.5], radius_m: 0.5 },
            ShapeFile::Hull { points_m: PYRAMID.to_vec() },
            ShapeFile::Mesh { vertices_m: PYRAMID.to_vec(), faces: PYRAMID_FACES.to_vec() },
        ]
        .map(shape)
    }

    fn cast(shape: &Shape, origin: [f64; 3], way: [f64; 3]) -> Option<Impact> {
        let direction = Vector3::from(way).normalize();
        shape.cast(&Ray { origin: origin.into(), direction }, 100.0)
    }

    #[track_caller]
    fn assert_impact(found: Option<Impact>, distance_m: f64, normal: [f64; 3]) {
        let found = found.expect("an impact");
        let off = (found.distance_m - distance_m).abs();
        let turned = (found.normal - Vector3::from(normal).normalize()).norm();
        assert!(off < 1e-9 && turned < 1e-9, "{found:?}, expected {distance_m} {normal:?}");
    }

    #[test]
    fn rays_meet_every_shape_where_geometry_says() {
        let [cuboid, cylinder, capsule, hull, mesh] = shapes();
        let left = [-1.0, 0.0, 0.0];
        assert_impact(cast(&cuboid, [5.0, 0.2, 0.3], left), 4.0, [1.0, 0.0, 0.0]);
        assert_impact(cast(&cylinder, [5.0, 0.3, 0.9], left), 4.6, [0.8, 0.6, 0.0]);
        assert_impact(cast(&cylinder, [0.1, 0.2, 4.0], [0.0, 0.0, -1.0]), 3.0, [0.0, 0.0, 1.0]);
        assert_impact(cast(&capsule, [5.0, 0.3, 0.2], left), 4.6, [0.8, 0.6, 0.0]);
        assert_impact(cast(&capsule, [5.0, 0.0, 0.8], left), 4.6, [0.8, 0.0, 0.6]);
        for solid in [hull, mesh] {
            assert_impact(cast(&solid, [5.0, 0.1, 0.25], left), 4.35, [1.0, 1.0, 1.0]);
            assert_impact(cast(&solid, [0.1, 0.2, -3.0], [0.0, 0.0, 1.0]), 3.0, [0.0, 0.0, -1.0]);
            assert_eq!(cast(&solid, [5.0, 0.0, 1.1], left), None);
        }
    }

    #[test]
    fn a_ray_that_starts_inside_is_met_at_once_and_one_that_leaves_is_not() {
        for shape in shapes() {
            let inside = cast(&shape, [0.05, 0.02, 0.2], [1.0, 2.0, 0.5]).unwrap();
            assert_eq!(inside.distance_m, 0.0);
            assert!(inside.normal.dot(&Vector3::new(1.0, 2.0, 0.5)) < 0.0);
            assert_eq!(cast(&shape, [3.0, 0.0, 0.2], [1.0, 0.0, 0.0]), None);
            assert_eq!(
                shape.cast(&Ray { origin: [9.0, 0.0, 0.2].into(), direction: -Vector3::x() }, 1.0),
                None
            );
        }
    }

    #[test]
    fn a_capsule_without_length_is_a_ball() {
        let centre = [0.0, 0.0, 0.5];
        let ball = shape(ShapeFile::Capsule { from_m: centre, to_m: centre, radius_m: 0.5 });
        assert_impact(cast(&ball, [5.0, 0.0, 0.8], [-1.0, 0.0, 0.0]), 4.6, [0.8, 0.0, 0.6]);
        assert_eq!(cast(&ball, [5.0, 0.0, 1.1], [-1.0, 0.0, 0.0]), None);
        let inside = |z| ball.contains(&Point3::new(0.0, 0.0, z));
        assert_eq!([-0.01, 0.01, 0.5, 0.99, 1.01].map(inside), [false, true, true, true, false]);
    }

    #[test]
    fn what_is_no_solid_is_refused_by_its_key() {
        let mut open = PYRAMID_FACES.to_vec();
        open.pop();
        let inside_out = PYRAMID_FACES.map(|[a, b, c]| [a, c, b]).to_vec();
        let mesh = |faces| ShapeFile::Mesh { vertices_m: PYRAMID.to_vec(), faces };
        for (file, key) in [
            (ShapeFile::Box { size_m: [1.0, 0.0, 1.0] }, "box.size_m"),
            (ShapeFile::Box { size_m: [1.0, f64::NAN, 1.0] }, "box.size_m"),
            (ShapeFile::Cylinder { radius_m: -1.0, height_m: 1.0 }, "cylinder.radius_m"),
            (ShapeFile::Hull { points_m: PYRAMID[..4].to_vec() }, "hull.points_m"),
            (ShapeFile::Hull { points_m: vec![[1.0; 3]; 9] }, "hull.points_m"),
            (mesh(open), "mesh.faces"),
            (mesh(inside_out), "mesh.faces"),
            (mesh(vec![[0, 1, 9]]), "mesh.faces"),
            (mesh(vec![]), "mesh.faces"),
        ] {
            assert_eq!(Shape::try_from(file).unwrap_err().place, key);
        }
    }

    /// The first of many points along a ray that the shape contains.
    fn sampled_m(shape: &Shape, ray: &Ray) -> Option<f64> {
        (0..6000).map(|step| f64::from(step) * 1e-3).find(|&at| shape.contains(&ray.at(at)))
    }

    #[test]
    fn casts_find_what_dense_sampling_finds() {
        let (hits, misses) = (Cell::new(0), Cell::new(0));
        let three = |reach: f64| prop::array::uniform3(-reach..reach);
        proptest!(ProptestConfig::with_cases(150), |(from in three(2.5), to in three(0.9))| {
            for shape in shapes() {
                let way = Vector3::from(to) - Vector3::from(from);
                let ray = Ray { origin: from.into(), direction: way.normalize() };
                match (shape.cast(&ray, 5.9).map(|hit| hit.distance_m), sampled_m(&shape, &ray)) {
                    // The ray is in the solid from its impact to the first sample within.
                    (Some(cast), Some(sampled)) => {
                        prop_assert!((-1e-9..1e-3 + 1e-9).contains(&(sampled - cast)) , "{cast} {sampled} {shape:?}");
                        hits.set(hits.get() + 1);
                    }
                    // A ray may clip less of a corner than lies between two samples.
                    (Some(cast), None) => {
                        prop_assert!(!shape.contains(&ray.at(cast + 1e-3)), "{cast} {shape:?}");
                    }
                    (None, sampled) => {
                        prop_assert_eq!(sampled, None, "{:?}", shape);
                        misses.set(misses.get() + 1);
                    }
                }
            }
        });
        assert!(hits.get() > 200 && misses.get() > 50, "{} {}", hits.get(), misses.get());
    }
}
