//! Where a thing on the ground is at a time, in closed form.

/// A place on the ground with a heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// World x.
    pub(crate) x_m: f64,
    /// World y.
    pub(crate) y_m: f64,
    /// Heading, counter-clockwise from world x.
    pub(crate) yaw_rad: f64,
}

/// One bend in a path, driven at a constant yaw rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turn {
    /// When it begins.
    pub(crate) begin_s: f64,
    /// How long it lasts.
    pub(crate) duration_s: f64,
    /// Yaw rate; positive is to the left, never zero.
    pub(crate) yaw_rate_rad_s: f64,
}

/// Travel at constant speed: straight on, with at most one turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Path {
    /// The place at time zero.
    pub(crate) start: Place,
    /// Speed along the heading; 0 stands still.
    pub(crate) speed_mps: f64,
    /// The bend, if there is one; it begins at time zero or later.
    pub(crate) turn: Option<Turn>,
}

impl Path {
    /// Standing still.
    pub(crate) fn still(x_m: f64, y_m: f64) -> Self {
        Self::straight(x_m, y_m, 0.0, 0.0)
    }

    /// Straight on along a heading.
    pub(crate) fn straight(x_m: f64, y_m: f64, yaw_rad: f64, speed_mps: f64) -> Self {
        let start = Place { x_m, y_m, yaw_rad };
        Self { start, speed_mps, turn: None }
    }

    /// The place at a time, negative times included.
    pub(crate) fn at(&self, time_s: f64) -> Place {
        let Some(turn) = self.turn else {
            return self.start.ahead(self.speed_mps * time_s);
        };
        let in_turn_s = (time_s - turn.begin_s).clamp(0.0, turn.duration_s);
        let after_s = (time_s - turn.begin_s - turn.duration_s).max(0.0);
        self.start
            .ahead(self.speed_mps * time_s.min(turn.begin_s))
            .along_arc(self.speed_mps / turn.yaw_rate_rad_s, turn.yaw_rate_rad_s * in_turn_s)
            .ahead(self.speed_mps * after_s)
    }
}

impl Place {
    fn ahead(self, distance_m: f64) -> Self {
        Self {
            x_m: self.x_m + distance_m * libm::cos(self.yaw_rad),
            y_m: self.y_m + distance_m * libm::sin(self.yaw_rad),
            yaw_rad: self.yaw_rad,
        }
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[track_caller]
    fn assert_place(found: Place, x_m: f64, y_m: f64, yaw_rad: f64) {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        let same = near(found.x_m, x_m) && near(found.y_m, y_m) && near(found.yaw_rad, yaw_rad);
        assert!(same, "expected ({x_m}, {y_m}, {yaw_rad}), found {found:?}");
    }

    #[test]
    fn straight_on_is_speed_times_time() {
        let path = Path::straight(5.0, 2.0, FRAC_PI_2, 3.0);
        assert_place(path.at(2.0), 5.0, 8.0, FRAC_PI_2);
        assert_place(path.at(-1.0), 5.0, -1.0, FRAC_PI_2);
    }

    #[test]
    fn a_quarter_turn_left_ends_a_radius_ahead_and_a_radius_aside() {
        // 8 m/s at pi/2 rad/s: a radius of 16 / pi m, the quarter takes 1 s.
        let radius_m = 8.0 / FRAC_PI_2;
        let turn = Turn { begin_s: 0.5, duration_s: 1.0, yaw_rate_rad_s: FRAC_PI_2 };
        let path = Path { turn: Some(turn), ..Path::straight(0.0, 0.0, 0.0, 8.0) };
        assert_place(path.at(0.5), 4.0, 0.0, 0.0);
        assert_place(path.at(1.5), 4.0 + radius_m, radius_m, FRAC_PI_2);
        assert_place(path.at(2.0), 4.0 + radius_m, radius_m + 4.0, FRAC_PI_2);
    }
}
