//! A street of boxes, and where a ray meets it.

use nalgebra::{Point3, Vector3};
use occlabel_core::{ClassId, Taxonomy};

/// Length, width and height of the only car, metres.
pub(crate) const CAR_SIZE_M: Vector3<f64> = Vector3::new(4.5, 1.8, 1.5);
/// Along the street, metres a second.
const CAR_SPEED_MPS: f64 = 6.0;

/// A box along the axes of the world, and its class.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid {
    min_m: Point3<f64>,
    max_m: Point3<f64>,
    pub(crate) class: ClassId,
}

/// Everything that stands on the street at a time, the ground included.
pub(crate) fn street(time_s: f64, taxonomy: &Taxonomy) -> Vec<Solid> {
    let class = |name| taxonomy.class_named(name).expect("a class of Occ3D");
    let solid = |name, min_m: [f64; 3], max_m: [f64; 3]| Solid {
        min_m: min_m.into(),
        max_m: max_m.into(),
        class: class(name),
    };
    let half_m = CAR_SIZE_M / 2.0;
    let [near, far] = [car_centre(time_s) - half_m, car_centre(time_s) + half_m];
    let mut solids = vec![
        solid("driveable_surface", [-90.0, -5.03, -1.0], [90.0, 5.03, 0.01]),
        solid("sidewalk", [-90.0, 5.03, -1.0], [90.0, 90.0, 0.16]),
        solid("sidewalk", [-90.0, -90.0, -1.0], [90.0, -5.03, 0.16]),
        solid("car", near.into(), far.into()),
    ];
    for at in -4..4 {
        let x = 17.3 * f64::from(at);
        solids.push(solid("manmade", [x, 9.1, 0.0], [x + 12.2, 14.3, 7.7]));
        solids.push(solid("manmade", [x + 5.0, -15.3, 0.0], [x + 17.0, -10.2, 4.9]));
        solids.push(solid("vegetation", [x + 3.3, 6.2, 0.0], [x + 3.9, 6.8, 4.1]));
    }
    solids
}

/// The middle of the car at a time, world coordinates.
pub(crate) fn car_centre(time_s: f64) -> Point3<f64> {
    Point3::new(9.0 + CAR_SPEED_MPS * time_s, 2.2, 0.9)
}

impl Solid {
    /// How far along `direction` the ray from `origin` enters; `None` if it misses or starts inside.
    pub(crate) fn distance_m(&self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Option<f64> {
        let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let to = |face: f64| (face - origin[axis]) / direction[axis];
            let (a, b) = (to(self.min_m[axis]), to(self.max_m[axis]));
            enters = enters.max(a.min(b));
            leaves = leaves.min(a.max(b));
        }
        (0.0 < enters && enters <= leaves).then_some(enters)
    }
}
