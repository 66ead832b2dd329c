//! Shapes that stand somewhere, under parry's bounding-volume hierarchy.

use std::sync::Arc;

use nalgebra::{Point3, Vector3};
use occlabel_core::Pose;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

use crate::convert::{ray_to_parry, to_parry};
use crate::{Hit, Ray, Shape, What};

/// Bounds are this much wider than what they bound: no ray along a face is lost to rounding.
const BOUNDS_SLACK_M: f64 = 1e-6;

/// A shape at a pose.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) shape: Arc<Shape>,
    pub(crate) world_from_shape: Pose,
    pub(crate) what: What,
}

/// Bodies, found by where they are.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    bodies: Vec<Body>,
    tree: Bvh,
}

impl Body {
    pub(crate) fn new(shape: Arc<Shape>, world_from_shape: Pose, what: What) -> Self {
        Self { shape, world_from_shape, what }
    }

    fn cast(&self, ray: &Ray, max_m: f64) -> Option<Hit> {
        let local = ray.moved(&self.world_from_shape.inverse());
        let impact = self.shape.cast(&local, max_m)?;
        let normal = self.world_from_shape * impact.normal;
        Some(Hit { distance_m: impact.distance_m, normal, what: self.what })
    }

    fn contains(&self, p: &Point3<f64>) -> bool {
        self.shape.contains(&self.world_from_shape.inverse_transform_point(p))
    }

    /// The box in world around the turned box around the shape.
    fn bounds(&self) -> Aabb {
        let [low, high] = self.shape.bounds();
        let turn = self.world_from_shape.rotation.to_rotation_matrix().into_inner().abs();
        let reach = turn * ((high - low) / 2.0) + Vector3::repeat(BOUNDS_SLACK_M);
        let centre = self.world_from_shape * nalgebra::center(&low, &high);
        Aabb::new(to_parry(&(centre - reach)), to_parry(&(centre + reach)))
    }
}

impl Bodies {
    pub(crate) fn new(bodies: Vec<Body>) -> Self {
        let bounds: Vec<Aabb> = bodies.iter().map(Body::bounds).collect();
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &bounds), bodies }
    }

    /// All of them, in the order they were given.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Body> {
        self.bodies.iter()
    }

    /// What the bodies' bounds are, in the order they were given.
    #[cfg(test)]
    pub(crate) fn bounds(&self) -> Vec<Aabb> {
        self.bodies.iter().map(Body::bounds).collect()
    }

    /// The first body on a ray, at most `max_m` away.
    pub(crate) fn cast(&self, ray: &Ray, max_m: f64) -> Option<Hit> {
        let meet = |at: u32, best_m: f64| {
            self.bodies[at as usize].cast(ray, best_m).map(|hit| hit.distance_m)
        };
        let (at, _) = self.tree.cast_ray(&ray_to_parry(ray), max_m, meet)?;
        self.bodies[at as usize].cast(ray, max_m)
    }

    /// The first body, in the order they were given, that a point lies in.
    pub(crate) fn contains(&self, p: &Point3<f64>) -> Option<What> {
        let point = to_parry(p);
        let around = self.tree.leaves(|node| node.aabb().contains_local_point(point));
        let inside = around.filter(|&at| self.bodies[at as usize].contains(p));
        inside.min().map(|at| self.bodies[at as usize].what)
    }
}
