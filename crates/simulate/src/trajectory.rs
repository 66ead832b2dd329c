//! Where a thing on the ground is at a time, in closed form.

use std::f64::consts::{PI, TAU};

use occlabel_core::Fault;
use serde::Deserialize;

use crate::check::{angles, each, metres, need, within};

/// A place on the map with a heading.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// World x.
    pub x_m: f64,
    /// World y.
    pub y_m: f64,
    /// Heading, counter-clockwise from world x.
    #[serde(default)]
    pub yaw_rad: f64,
}

/// A place at a time.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// When.
    pub time_s: f64,
    /// Where, and heading where.
    pub place: Place,
}

/// A way through the world. Speeds are those on the map; all but waypoints go on for ever, and
/// went on before time zero.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Trajectory {
    /// Straight on at constant speed; at 0 it stands.
    Straight {
        /// The place at time zero.
        start: Place,
        /// Speed along the heading.
        speed_mps: f64,
    },
    /// Constant speed, with one bend of constant yaw rate.
    Turn {
        /// The place at time zero.
        start: Place,
        /// Speed along the heading.
        speed_mps: f64,
        /// When the bend begins, 0 or later.
        begin_s: f64,
        /// How long it lasts.
        duration_s: f64,
        /// Yaw rate in the bend; positive is to the left, never 0.
        yaw_rate_rad_s: f64,
    },
    /// Straight on, with one change of speed.
    Accelerate {
        /// The place at time zero.
        start: Place,
        /// Speed before.
        speed_mps: f64,
        /// When the change begins, 0 or later.
        begin_s: f64,
        /// How long it lasts.
        duration_s: f64,
        /// By how much speed grows in a second; below 0 it shrinks.
        acceleration_mps2: f64,
    },
    /// Straight on, then braking to a stand.
    Stop {
        /// The place at time zero.
        start: Place,
        /// Speed before, 0 or more.
        speed_mps: f64,
        /// When braking begins, 0 or later.
        begin_s: f64,
        /// By how much speed shrinks in a second, above 0.
        deceleration_mps2: f64,
    },
    /// From place to place, standing before the first and after the last.
    ///
    /// Between two places it goes along the arc that leaves the one and reaches the other at their
    /// headings, if there is one; else straight, turning evenly, the short way round.
    Waypoints(Vec<Waypoint>),
}

impl Trajectory {
    /// The place at a time, seconds.
    pub fn at(&self, time_s: f64) -> Place {
        match *self {
            Self::Straight { start, speed_mps } => start.ahead(speed_mps * time_s),
            Self::Turn { start, speed_mps, begin_s, duration_s, yaw_rate_rad_s } => start
                .ahead(speed_mps * time_s.min(begin_s))
                .along_arc(
                    speed_mps / yaw_rate_rad_s,
                    yaw_rate_rad_s * (time_s - begin_s).clamp(0.0, duration_s),
                )
                .ahead(speed_mps * (time_s - begin_s - duration_s).max(0.0)),
            Self::Accelerate { start, speed_mps, begin_s, duration_s, acceleration_mps2: a } => {
                let within_s = (time_s - begin_s).clamp(0.0, duration_s);
                let after_s = (time_s - begin_s - duration_s).max(0.0);
                let gained_m = a * within_s * (within_s / 2.0 + after_s);
                start.ahead(speed_mps * time_s + gained_m)
            }
            Self::Stop { start, speed_mps, begin_s, deceleration_mps2: d } => {
                let braking_s = (time_s - begin_s).clamp(0.0, speed_mps / d);
                let before_m = speed_mps * time_s.min(begin_s);
                start.ahead(before_m + braking_s * (speed_mps - d * braking_s / 2.0))
            }
            Self::Waypoints(ref points) => between(points, time_s),
        }
    }

    /// The same way from another place on.
    pub(crate) fn shifted(&self, by_m: [f64; 2]) -> Self {
        let mut way = self.clone();
        let places: Vec<&mut Place> = match &mut way {
            Self::Straight { start, .. }
            | Self::Turn { start, .. }
            | Self::Accelerate { start, .. }
            | Self::Stop { start, .. } => vec![start],
            Self::Waypoints(points) => points.iter_mut().map(|point| &mut point.place).collect(),
        };
        for place in places {
            place.x_m += by_m[0];
            place.y_m += by_m[1];
        }
        way
    }

    pub(crate) fn check(&self) -> Result<(), Fault> {
        match self {
            Self::Straight { start, speed_mps } => check_start("straight", start, *speed_mps),
            Self::Turn { start, speed_mps, begin_s, duration_s, yaw_rate_rad_s } => {
                check_start("turn", start, *speed_mps)?;
                check_spell("turn", *begin_s, *duration_s)?;
                let rate = yaw_rate_rad_s.abs();
                within("turn.yaw_rate_rad_s, its size", rate, 1e-6, 1e3)
            }
            Self::Accelerate { start, speed_mps, begin_s, duration_s, acceleration_mps2 } => {
                check_start("accelerate", start, *speed_mps)?;
                check_spell("accelerate", *begin_s, *duration_s)?;
                within("accelerate.acceleration_mps2", *acceleration_mps2, -1e3, 1e3)
            }
            Self::Stop { start, speed_mps, begin_s, deceleration_mps2 } => {
                check_start("stop", start, speed_mps.abs())?;
                check_spell("stop", *begin_s, 0.0)?;
                within("stop.speed_mps", *speed_mps, 0.0, 1e3)?;
                within("stop.deceleration_mps2", *deceleration_mps2, 1e-3, 1e3)
            }
            Self::Waypoints(points) => check_waypoints(points),
        }
    }
}

fn check_start(kind: &str, start: &Place, speed_mps: f64) -> Result<(), Fault> {
    start.check(&format!("{kind}.start"))?;
    within(&format!("{kind}.speed_mps"), speed_mps, -1e3, 1e3)
}

fn check_spell(kind: &str, begin_s: f64, duration_s: f64) -> Result<(), Fault> {
    within(&format!("{kind}.begin_s"), begin_s, 0.0, 1e6)?;
    within(&format!("{kind}.duration_s"), duration_s, 0.0, 1e6)
}

fn check_waypoints(points: &[Waypoint]) -> Result<(), Fault> {
    need("waypoints", !points.is_empty(), "at least one", 0)?;
    each("waypoints", points, |point| {
        within("time_s", point.time_s, -1e6, 1e6)?;
        point.place.check("place")
    })?;
    let in_order = points.windows(2).all(|pair| pair[1].time_s - pair[0].time_s > 1e-6);
    need("waypoints", in_order, "times rising from point to point", "one that does not rise")
}

/// The place at a time between waypoints.
fn between(points: &[Waypoint], time_s: f64) -> Place {
    let next = points.partition_point(|point| point.time_s <= time_s);
    if next == 0 {
        return points[0].place;
    }
    let (a, Some(b)) = (points[next - 1], points.get(next)) else { return points[next - 1].place };
    a.place.towards(&b.place, (time_s - a.time_s) / (b.time_s - a.time_s))
}

impl Place {
    /// The place so far ahead, metres; behind if negative.
    pub fn ahead(self, distance_m: f64) -> Self {
        let (sin, cos) = libm::sincos(self.yaw_rad);
        Self { x_m: self.x_m + distance_m * cos, y_m: self.y_m + distance_m * sin, ..self }
    }

    /// Along a circle whose centre lies `radius_m` to the left (to the right if negative).
    fn along_arc(self, radius_m: f64, angle_rad: f64) -> Self {
        let yaw_rad = self.yaw_rad + angle_rad;
        Self {
            x_m: self.x_m + radius_m * (libm::sin(yaw_rad) - libm::sin(self.yaw_rad)),
            y_m: self.y_m - radius_m * (libm::cos(yaw_rad) - libm::cos(self.yaw_rad)),
            yaw_rad,
        }
    }

    /// A share of the way to another place: along the arc of both headings, or straight.
    fn towards(self, other: &Self, share: f64) -> Self {
        let (dx, dy) = (other.x_m - self.x_m, other.y_m - self.y_m);
        let turned_rad = short_way(other.yaw_rad - self.yaw_rad);
        let aside_rad = short_way(libm::atan2(dy, dx) - self.yaw_rad - turned_rad / 2.0);
        if turned_rad.abs() > 1e-9 && aside_rad.abs() < 1e-6 {
            let radius_m = libm::hypot(dx, dy) / (2.0 * libm::sin(turned_rad / 2.0));
            return self.along_arc(radius_m, turned_rad * share);
        }
        Self {
            x_m: self.x_m + dx * share,
            y_m: self.y_m + dy * share,
            yaw_rad: self.yaw_rad + turned_rad * share,
        }
    }

    fn check(&self, key: &str) -> Result<(), Fault> {
        metres(key, &[self.x_m, self.y_m])?;
        angles(key, &[self.yaw_rad])
    }
}

/// The same turn by at most half a circle.
pub(crate) fn short_way(angle_rad: f64) -> f64 {
    angle_rad - TAU * ((angle_rad + PI) / TAU).floor()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const START: Place = Place { x_m: 5.0, y_m: 2.0, yaw_rad: 0.0 };

    #[track_caller]
    fn assert_place(found: Place, x_m: f64, y_m: f64, yaw_rad: f64) {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let same = near(found.x_m, x_m) && near(found.y_m, y_m) && near(found.yaw_rad, yaw_rad);
        assert!(same, "expected ({x_m}, {y_m}, {yaw_rad}), found {found:?}");
    }

    fn speed_mps(path: &Trajectory, time_s: f64) -> f64 {
        let (a, b) = (path.at(time_s - 1e-4), path.at(time_s + 1e-4));
        libm::hypot(b.x_m - a.x_m, b.y_m - a.y_m) / 2e-4
    }

    fn quarter() -> Trajectory {
        Trajectory::Turn {
            start: START,
            speed_mps: 8.0,
            begin_s: 0.5,
            duration_s: 1.0,
            yaw_rate_rad_s: FRAC_PI_2,
        }
    }

    #[test]
    fn a_turn_keeps_its_speed_and_its_radius() {
        let radius_m = 8.0 / FRAC_PI_2;
        let centre = [5.0 + 4.0, 2.0 + radius_m];
        for step in 0..=100 {
            let time_s = 0.5 + f64::from(step) / 100.0;
            let place = quarter().at(time_s);
            let found_m = libm::hypot(place.x_m - centre[0], place.y_m - centre[1]);
            assert!((found_m - radius_m).abs() < 1e-9, "{found_m} at {time_s}");
            assert!((speed_mps(&quarter(), time_s) - 8.0).abs() < 1e-3);
        }
        assert_place(quarter().at(-1.0), -3.0, 2.0, 0.0);
        assert_place(quarter().at(2.0), 9.0 + radius_m, 6.0 + radius_m, FRAC_PI_2);
    }

    #[test]
    fn braking_stops_after_speed_squared_over_twice_the_deceleration() {
        let path = Trajectory::Stop {
            start: START,
            speed_mps: 10.0,
            begin_s: 1.0,
            deceleration_mps2: 4.0,
        };
        assert_place(path.at(1.0), 15.0, 2.0, 0.0);
        assert!((speed_mps(&path, 2.0) - 6.0).abs() < 1e-6);
        assert_place(path.at(3.5), 15.0 + 12.5, 2.0, 0.0);
        assert_place(path.at(99.0), 15.0 + 12.5, 2.0, 0.0);
    }

    #[test]
    fn speed_grows_only_while_it_accelerates() {
        let path = Trajectory::Accelerate {
            start: START,
            speed_mps: 2.0,
            begin_s: 1.0,
            duration_s: 2.0,
            acceleration_mps2: 3.0,
        };
        for (time_s, expected) in [(0.5, 2.0), (2.0, 5.0), (3.5, 8.0), (9.0, 8.0)] {
            assert!((speed_mps(&path, time_s) - expected).abs() < 1e-6, "{time_s}");
        }
        assert_place(path.at(4.0), 5.0 + 2.0 + 10.0 + 8.0, 2.0, 0.0);
    }

    #[test]
    fn waypoints_of_an_arc_are_joined_by_the_arc() {
        let waypoint = |time_s| Waypoint { time_s, place: quarter().at(time_s) };
        let path = Trajectory::Waypoints(vec![waypoint(0.5), waypoint(1.5)]);
        for time_s in [0.5, 0.6, 1.1, 1.49, 1.5] {
            let place = quarter().at(time_s);
            assert_place(path.at(time_s), place.x_m, place.y_m, place.yaw_rad);
        }
        assert_eq!((path.at(0.0), path.at(7.0)), (path.at(0.5), path.at(1.5)));
    }

    #[test]
    fn other_waypoints_are_joined_by_a_line_turning_the_short_way() {
        let place = |x_m, yaw_rad| Place { x_m, y_m: 0.0, yaw_rad };
        let path = Trajectory::Waypoints(vec![
            Waypoint { time_s: 0.0, place: place(0.0, 3.0) },
            Waypoint { time_s: 2.0, place: place(4.0, -3.0) },
        ]);
        assert_place(path.at(1.0), 2.0, 0.0, PI);
    }
}
