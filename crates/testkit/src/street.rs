//! The known world: a straight street on flat ground, with movers.
//!
//! Bird's-eye view, x up and y left, as a scene starts; houses and trees go on up and down:
//!
//! ```text
//!    y = 16      8.6   6.5     4      2      0     -2     -4   -6.5   -8.6    -16
//!
//!   x = 26 ~~~~~~~~~~ side street ~~~~|                     | parked | tree  house
//!                                     | oncoming            |        |
//!       14                   barrier  |              turning|        |
//!        6 house  tree  |    parked   |                     | parked | tree  house
//!        0 house        |             |                ego  |        | person
//!       -9              |             | person (crossing)   | parked |
//!           terrain      sidewalk         driveable          sidewalk  terrain
//! ```
//!
//! At the keyframes of the first scene, with the ego at 6 m/s, no face of a body that is seen lies
//! on a face between voxels of 0.4 m, nor does the ground: rounding decides nothing.

use crate::categories::{
    ADULT, BARRIER, CAR, DRIVEABLE, EGO, MANMADE, SIDEWALK, TERRAIN, VEGETATION,
};
use crate::path::{Path, Turn};
use crate::pose::{Pose, yaw_pose};
use crate::solid::{Ray, Shape, Solid};
use std::f64::consts::{FRAC_PI_2, PI};

/// An annotated box stands this far above the ground, so that no ground return is in it.
const BOX_CLEARANCE_M: f64 = 0.02;
/// A body is this much smaller than its annotated box on every side, so that its returns are in it.
const BOX_SKIN_M: f64 = 0.05;
const CAR_SIZE_M: [f64; 3] = [4.5, 1.9, 1.6];
const PERSON_SIZE_M: [f64; 3] = [0.6, 0.7, 1.75];
const BARRIER_SIZE_M: [f64; 3] = [4.0, 0.5, 1.0];
/// The side street's reach along x; it leaves the main one to the left.
const SIDE_STREET_X_M: [f64; 2] = [18.0, 30.0];
/// The part of the ego's body that its lidar sees, the roof: min and max in the ego frame.
const ROOF_M: [[f64; 3]; 2] = [[0.3, -0.6, 1.2], [1.8, 0.6, 1.5]];

/// A thing with a box annotation.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    /// nuScenes category.
    pub(crate) category: &'static str,
    /// Length, width, height of the annotated box.
    pub(crate) size_m: [f64; 3],
    /// Where it goes.
    pub(crate) path: Path,
}

impl Track {
    /// The annotated box's pose: its centre, x forward.
    pub(crate) fn world_from_box(&self, time_s: f64) -> Pose {
        let place = self.path.at(time_s);
        let centre_z_m = BOX_CLEARANCE_M + self.size_m[2] / 2.0;
        yaw_pose([place.x_m, place.y_m, centre_z_m], place.yaw_rad)
    }

    /// The body inside the box.
    fn shape(&self) -> Shape {
        Shape::Box { half_m: self.size_m.map(|extent| extent / 2.0 - BOX_SKIN_M) }
    }
}

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// Distance from the ray's origin.
    pub(crate) distance_m: f64,
    /// nuScenes category.
    pub(crate) category: &'static str,
    /// Index into [`Street::tracks`], if it is a track.
    pub(crate) track: Option<usize>,
}

/// The world of one scene.
#[derive(Clone, Debug)]
pub(crate) struct Street {
    /// The annotated things, standing and moving.
    pub(crate) tracks: Vec<Track>,
    fixed: Vec<Body>,
}

/// The world at one time.
#[derive(Clone, Debug)]
pub(crate) struct StreetInstant {
    bodies: Vec<Body>,
}

#[derive(Clone, Copy, Debug)]
struct Body {
    solid: Solid,
    category: &'static str,
    track: Option<usize>,
}

impl Street {
    /// The street of a scene; scenes differ in the speed of the oncoming cars.
    pub(crate) fn new(scene: usize) -> Self {
        Self { tracks: tracks(8.0 + (scene % 5) as f64), fixed: houses().chain(trees()).collect() }
    }

    /// The street with people added, standing out of sight behind the houses, until there are
    /// `track_count` tracks: annotations without end at no cost to the rest.
    pub(crate) fn with_crowd(mut self, track_count: usize) -> Self {
        for number in self.tracks.len()..track_count {
            let path = Path::still(2.0 * (number % 50) as f64, -40.0 - 2.0 * (number / 50) as f64);
            self.tracks.push(person(path));
        }
        self
    }

    /// The world at a time, seconds from the scene's first keyframe, with the ego's body in it.
    pub(crate) fn at(&self, time_s: f64, world_from_ego: &Pose) -> StreetInstant {
        let bodies = self.tracks.iter().enumerate().map(|(index, track)| Body {
            solid: Solid::new(track.shape(), &track.world_from_box(time_s)),
            category: track.category,
            track: Some(index),
        });
        let ego = body(EGO, roof(), world_from_ego * roof_centre());
        StreetInstant { bodies: self.fixed.iter().copied().chain(bodies).chain([ego]).collect() }
    }
}

impl StreetInstant {
    /// The nearest thing that a ray meets within `max_range_m`; of equally near ones the first.
    pub(crate) fn cast(&self, ray: &Ray, max_range_m: f64) -> Option<Hit> {
        let bodies = self.bodies.iter().filter_map(|body| {
            let distance_m = body.solid.entry_m(ray)?;
            Some(Hit { distance_m, category: body.category, track: body.track })
        });
        bodies
            .chain(ground_hit(ray))
            .filter(|hit| hit.distance_m <= max_range_m)
            .min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
    }
}

/// What the ground is made of at a place.
pub(crate) fn ground_category(x_m: f64, y_m: f64) -> &'static str {
    if y_m.abs() <= 4.0 || in_side_street(x_m, y_m) {
        DRIVEABLE
    } else if y_m.abs() <= 6.5 {
        SIDEWALK
    } else {
        TERRAIN
    }
}

/// The ground is the plane z = 0.
fn ground_hit(ray: &Ray) -> Option<Hit> {
    let distance_m = -ray.origin.z / ray.direction.z;
    let at = ray.origin + ray.direction * distance_m;
    let category = ground_category(at.x, at.y);
    (distance_m > 0.0).then_some(Hit { distance_m, category, track: None })
}

fn in_side_street(x_m: f64, y_m: f64) -> bool {
    y_m > 0.0 && (SIDE_STREET_X_M[0]..=SIDE_STREET_X_M[1]).contains(&x_m)
}

/// Two rows of houses, 16 m long, a gap of 4 m between them, 9 to 15 m high.
fn houses() -> impl Iterator<Item = Body> {
    both_sides(0.1, 16.2).map(|(x_m, y_m, number)| {
        let half_height_m = 4.5 + 1.5 * f64::from(number.rem_euclid(3));
        let shape = Shape::Box { half_m: [8.0, 4.0, half_height_m] };
        body(MANMADE, shape, yaw_pose([x_m, y_m, half_height_m], 0.0))
    })
}

/// Two rows of trees: trunks 2.5 m high, with crowns from there to 6 m.
fn trees() -> impl Iterator<Item = Body> {
    both_sides(6.1, 8.6).flat_map(|(x_m, y_m, _)| {
        let part = |radius_m, from_z_m: f64, to_z_m: f64| {
            let shape = Shape::Cylinder { radius_m, half_height_m: (to_z_m - from_z_m) / 2.0 };
            body(VEGETATION, shape, yaw_pose([x_m, y_m, (from_z_m + to_z_m) / 2.0], 0.0))
        };
        [part(0.25, 0.0, 2.5), part(1.35, 2.5, 6.0)]
    })
}

/// Places every 20 m on both sides of the street, but not in the side street's mouth: x, y, number.
fn both_sides(first_x_m: f64, aside_m: f64) -> impl Iterator<Item = (f64, f64, i32)> {
    (-5..=16)
        .flat_map(move |number| {
            let x_m = first_x_m + 20.0 * f64::from(number);
            [(x_m, aside_m, number), (x_m, -aside_m, number)]
        })
        .filter(|&(x_m, y_m, _)| !in_side_street(x_m, y_m))
}

fn tracks(oncoming_mps: f64) -> Vec<Track> {
    let parked = [(8.1, -5.2), (27.1, -5.2), (-3.9, -5.2), (4.1, 5.2), (48.1, 5.2), (70.1, -5.2)]
        .map(|(x_m, y_m)| car(Path::still(x_m, y_m)));
    let oncoming = [22.1, 92.1, 162.1].map(|x_m| car(Path::straight(x_m, 2.0, PI, oncoming_mps)));
    let barrier = Track { category: BARRIER, size_m: BARRIER_SIZE_M, path: Path::still(14.0, 6.1) };
    let crossing = person(Path::straight(-8.6, 1.5, -FRAC_PI_2, 1.4));
    let strolling = person(Path::straight(1.0, -7.4, 0.0, 1.4));
    parked
        .into_iter()
        .chain(oncoming)
        .chain([car(turning()), crossing, strolling, barrier])
        .collect()
}

fn car(path: Path) -> Track {
    Track { category: CAR, size_m: CAR_SIZE_M, path }
}

fn person(path: Path) -> Track {
    Track { category: ADULT, size_m: PERSON_SIZE_M, path }
}

/// Ahead of the ego in its lane, then left into the side street on a radius of 8 m.
fn turning() -> Path {
    let yaw_rate_rad_s = 0.75;
    let turn = Turn { begin_s: 0.3, duration_s: FRAC_PI_2 / yaw_rate_rad_s, yaw_rate_rad_s };
    Path { turn: Some(turn), ..Path::straight(14.0, -2.0, 0.0, 6.0) }
}

fn roof() -> Shape {
    let [min_m, max_m] = ROOF_M;
    Shape::Box { half_m: [0, 1, 2].map(|axis| (max_m[axis] - min_m[axis]) / 2.0) }
}

fn roof_centre() -> Pose {
    let [min_m, max_m] = ROOF_M;
    yaw_pose([0, 1, 2].map(|axis| (max_m[axis] + min_m[axis]) / 2.0), 0.0)
}

fn body(category: &'static str, shape: Shape, world_from_solid: Pose) -> Body {
    Body { solid: Solid::new(shape, &world_from_solid), category, track: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::world_from_ego;
    use nalgebra::{Point3, Vector3};

    #[track_caller]
    fn cast(time_s: f64, origin: [f64; 3], direction: [f64; 3]) -> Hit {
        let direction = Vector3::from(direction).normalize();
        let ray = Ray { origin: Point3::from(origin), direction };
        Street::new(0).at(time_s, &world_from_ego(6.0, time_s)).cast(&ray, 150.0).expect("a hit")
    }

    #[track_caller]
    fn assert_hit(hit: Hit, distance_m: f64, category: &str) {
        assert_eq!(hit.category, category);
        let error_m = (hit.distance_m - distance_m).abs();
        assert!(error_m < 1e-9, "expected {distance_m} m, found {} m", hit.distance_m);
    }

    #[test]
    fn the_ground_is_in_bands() {
        assert_hit(cast(0.0, [4.0, -2.0, 2.0], [0.0, 0.0, -1.0]), 2.0, DRIVEABLE);
        assert_hit(cast(0.0, [4.0, 0.0, 3.0], [0.0, -5.0, -3.0]), libm::hypot(5.0, 3.0), SIDEWALK);
        assert_hit(cast(0.0, [0.0, 0.0, 6.0], [0.0, 7.0, -6.0]), libm::hypot(7.0, 6.0), TERRAIN);
        assert_eq!(ground_category(24.0, 30.0), DRIVEABLE);
        assert_eq!(ground_category(24.0, -30.0), TERRAIN);
    }

    #[test]
    fn a_house_stands_14_2_m_left_of_the_ego() {
        assert_hit(cast(0.0, [0.0, -2.0, 1.84], [0.0, 1.0, 0.0]), 14.2, MANMADE);
    }

    #[test]
    fn a_tree_stands_before_a_house() {
        assert_hit(cast(0.0, [-13.9, 0.0, 1.0], [0.0, -1.0, 0.0]), 8.35, VEGETATION);
        assert_hit(cast(0.0, [-13.9, 0.0, 4.0], [0.0, -1.0, 0.0]), 7.25, VEGETATION);
        assert_hit(cast(0.0, [-13.9, 0.0, 7.0], [0.0, -1.0, 0.0]), 12.2, MANMADE);
    }

    #[test]
    fn the_oncoming_car_comes_nearer_at_its_speed() {
        // Its front is 22.1 - 2.25 + 0.05 m ahead at first; it drives 8 m/s.
        for time_s in [0.0, 0.5, 1.0] {
            let hit = cast(time_s, [0.0, 2.0, 1.0], [1.0, 0.0, 0.0]);
            assert_hit(hit, 19.9 - 8.0 * time_s, CAR);
            assert_eq!(hit.track, Some(6));
        }
    }

    #[test]
    fn the_pedestrian_crosses() {
        let hit = cast(1.0, [0.0, 0.1, 1.0], [-1.0, 0.0, 0.0]);
        assert_hit(hit, 8.6 - 0.35 + 0.05, ADULT);
    }

    #[test]
    fn the_roof_is_34_cm_under_the_lidar() {
        assert_hit(cast(0.0, [0.94, -2.0, 1.84], [0.0, 0.0, -1.0]), 0.34, EGO);
    }

    #[test]
    fn the_sky_is_empty() {
        let up = Ray { origin: Point3::new(0.94, -2.0, 1.84), direction: Vector3::z() };
        let street = Street::new(0).at(0.0, &world_from_ego(6.0, 0.0));
        assert_eq!(street.cast(&up, 150.0), None);
    }

    #[test]
    fn no_two_tracks_ever_come_near() {
        for (scene, step) in (0..5).flat_map(|scene| (-5..200).map(move |step| (scene, step))) {
            let tracks = Street::new(scene).tracks;
            let places: Vec<_> =
                tracks.iter().map(|track| track.path.at(0.1 * f64::from(step))).collect();
            for (i, a) in places.iter().enumerate() {
                for b in &places[i + 1..] {
                    let apart_m = libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
                    assert!(apart_m > 2.2, "scene {scene}, step {step}: {a:?} and {b:?}");
                }
            }
        }
    }
}
