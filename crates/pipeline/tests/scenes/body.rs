//! The exactly known world: upright boxes.

use nalgebra::{Point2, Point3, Vector2, Vector3};
use occlabel_core::{ClassId, Pose};

use super::{MANMADE, ROAD, upright};

/// An upright box of one class. Seen from inside, it is a hall.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) map_from_body: Pose,
    pub(crate) half_m: Vector3<f64>,
    pub(crate) class: ClassId,
    /// The track that stands for it, if one does.
    pub(crate) track: Option<u16>,
    /// Whether it is the hall around everything.
    pub(crate) is_hall: bool,
}

/// A body along the axes, from its lower to its upper corner.
pub(crate) fn slab(class: ClassId, lower: [f64; 3], upper: [f64; 3]) -> Body {
    let (lower, upper) = (Vector3::from(lower), Vector3::from(upper));
    let map_from_body = upright(((lower + upper) / 2.0).into(), 0.0);
    Body::new(class, map_from_body, (upper - lower) / 2.0)
}

/// A road without end, in a hall so high and wide that every ray comes back.
pub(crate) fn road_in_a_hall() -> Vec<Body> {
    let hall = slab(MANMADE, [-40.0, -40.0, -5.0], [40.0, 40.0, 25.0]);
    let road = slab(ROAD, [-39.0, -39.0, -2.0], [39.0, 39.0, 0.0]);
    vec![Body { is_hall: true, ..hall }, road]
}

impl Body {
    pub(crate) fn new(class: ClassId, map_from_body: Pose, half_m: Vector3<f64>) -> Self {
        Self { map_from_body, half_m, class, track: None, is_hall: false }
    }

    /// The same body, with a track.
    pub(crate) fn tracked(self, track: u16) -> Self {
        Self { track: Some(track), ..self }
    }

    /// How far along a ray its surface is met first.
    fn distance(&self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Option<f64> {
        let start = self.map_from_body.inverse() * origin;
        let way = self.map_from_body.inverse() * direction;
        let (mut enters, mut leaves) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let faces =
                [-1.0, 1.0].map(|side| (side * self.half_m[axis] - start[axis]) / way[axis]);
            enters = enters.max(faces[0].min(faces[1]));
            leaves = leaves.min(faces[0].max(faces[1]));
        }
        let is_met = enters <= leaves && leaves > 0.0;
        is_met.then_some(if enters > 0.0 { enters } else { leaves })
    }

    /// The same body with every face moved out, or in.
    pub(crate) fn grown(&self, by_m: f64) -> Self {
        Self { half_m: self.half_m.add_scalar(by_m), ..self.clone() }
    }

    pub(crate) fn contains(&self, p: &Point3<f64>) -> bool {
        let in_body = self.map_from_body.inverse() * p;
        (0..3).all(|axis| in_body[axis].abs() <= self.half_m[axis])
    }

    /// The eight corners, map frame.
    pub(crate) fn corners(&self) -> [Point3<f64>; 8] {
        std::array::from_fn(|corner| {
            let side = |axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let sides = Vector3::new(side(0), side(1), side(2));
            self.map_from_body * Point3::from(self.half_m.component_mul(&sides))
        })
    }

    fn footprint(&self) -> [Point2<f64>; 4] {
        [0, 1, 2, 3].map(|corner| self.corners()[corner].xy())
    }
}

/// What a ray meets first, and how far away.
pub(crate) fn cast<'a>(
    world: &'a [Body],
    origin: &Point3<f64>,
    direction: &Vector3<f64>,
) -> Option<(f64, &'a Body)> {
    world
        .iter()
        .filter_map(|body| Some((body.distance(origin, direction)?, body)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Whether a point is seen from another.
pub(crate) fn is_lit(world: &[Body], from: &Point3<f64>, p: &Point3<f64>) -> bool {
    let way = p - from;
    cast(world, from, &way.normalize()).is_none_or(|(distance, _)| distance > way.norm())
}

/// Whether two upright boxes share a point: no axis separates their footprints, nor z the rest.
pub(crate) fn overlap(a: &Body, b: &Body) -> bool {
    let rise = (a.map_from_body.translation.z - b.map_from_body.translation.z).abs();
    let axes = [a, b].map(|body| [0, 1].map(|axis| side_direction(body, axis)));
    rise <= a.half_m.z + b.half_m.z
        && axes.as_flattened().iter().all(|axis| reach_each_other(a, b, axis))
}

fn side_direction(body: &Body, axis: usize) -> Vector2<f64> {
    (body.map_from_body.rotation * Vector3::ith(axis, 1.0)).xy()
}

fn reach_each_other(a: &Body, b: &Body, axis: &Vector2<f64>) -> bool {
    let [(a_low, a_high), (b_low, b_high)] = [a, b].map(|body| {
        let along = body.footprint().map(|corner| corner.coords.dot(axis));
        (
            along.into_iter().fold(f64::INFINITY, f64::min),
            along.into_iter().fold(-f64::INFINITY, f64::max),
        )
    });
    a_low <= b_high && b_low <= a_high
}
