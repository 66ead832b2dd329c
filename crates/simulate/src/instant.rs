//! The world at a time: what a ray meets, and what a point lies in.

use nalgebra::{Point3, Vector3};

use crate::bodies::{Bodies, Body};
use crate::{Ray, World};

/// A part of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum What {
    /// A band of the ground, by number.
    Ground(usize),
    /// A static shape, by number.
    Static(usize),
    /// A mover, by number.
    Mover(usize),
    /// The recording vehicle's own body.
    Ego,
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance from the ray's origin, metres; 0 if the ray starts in it.
    pub distance_m: f64,
    /// Unit normal of its surface in world, outwards; against the ray if the ray starts in it.
    pub normal: Vector3<f64>,
    /// What it is.
    pub what: What,
}

/// The world at a time.
#[derive(Clone, Debug)]
pub struct Instant<'w> {
    world: &'w World,
    moving: Bodies,
}

impl<'w> Instant<'w> {
    /// The world with its ego at one time and each mover at its own, seconds.
    pub(crate) fn new(world: &'w World, time_s: f64, mover_time_s: impl Fn(usize) -> f64) -> Self {
        let ego = world.ego_body.as_ref().map(|(shape, ego_from_body)| {
            let world_from_body = world.world_from_ego(time_s) * ego_from_body;
            Body::new(shape.clone(), world_from_body, What::Ego)
        });
        Self::with(world, mover_time_s, ego)
    }

    /// The world without the ego's own body, each mover at its own time, seconds.
    pub(crate) fn without_ego(world: &'w World, mover_time_s: impl Fn(usize) -> f64) -> Self {
        Self::with(world, mover_time_s, None)
    }

    /// Everything solid but the ground: what stands, then what moves.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = &Body> {
        self.world.standing.iter().chain(self.moving.iter())
    }

    fn with(world: &'w World, mover_time_s: impl Fn(usize) -> f64, ego: Option<Body>) -> Self {
        let movers =
            (0..world.movers.len()).flat_map(|at| mover_bodies(world, at, mover_time_s(at)));
        Self { world, moving: Bodies::new(movers.chain(ego).collect()) }
    }

    /// What a ray of the world meets first, at most `max_m` away.
    ///
    /// At one distance, what stands wins over what moves, and that over the ground.
    pub fn cast(&self, ray: &Ray, max_m: f64) -> Option<Hit> {
        let mut best = self.world.standing.cast(ray, max_m);
        let reach_m = best.map_or(max_m, |hit| hit.distance_m);
        best = nearer(best, self.moving.cast(ray, reach_m));
        let reach_m = best.map_or(max_m, |hit| hit.distance_m);
        let ground = self.world.ground.cast(ray, reach_m).map(|(impact, band)| Hit {
            distance_m: impact.distance_m,
            normal: impact.normal,
            what: What::Ground(band),
        });
        nearer(best, ground)
    }

    /// What a point of the world lies in: what stands, else what moves, else the ground.
    pub fn contains(&self, p: &Point3<f64>) -> Option<What> {
        let body = self.world.standing.contains(p).or_else(|| self.moving.contains(p));
        body.or_else(|| self.world.ground.contains(p).map(What::Ground))
    }
}

/// The parts of a mover at a time.
pub(crate) fn mover_bodies(world: &World, at: usize, time_s: f64) -> impl Iterator<Item = Body> {
    let mover = &world.movers[at];
    let world_from_mover = mover.box_at(time_s, &world.ground).world_from_box;
    mover.parts.iter().map(move |part| {
        let world_from_part = world_from_mover * part.mover_from_part(time_s);
        Body::new(part.shape.clone(), world_from_part, What::Mover(at))
    })
}

fn nearer(first: Option<Hit>, second: Option<Hit>) -> Option<Hit> {
    match (first, second) {
        (Some(a), Some(b)) if b.distance_m < a.distance_m => Some(b),
        (None, second) => second,
        (first, _) => first,
    }
}
