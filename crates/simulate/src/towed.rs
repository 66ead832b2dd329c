//! A trailer, drawn by its hitch.

use std::sync::Arc;

use crate::mover::Path;
use crate::trajectory::{Place, short_way};

/// Steps in which a trailer's heading is followed.
const STEPS_PER_S: f64 = 100.0;

/// The way of something that is drawn by another mover.
///
/// ```text
///    <- driving                hitch_m is negative: behind the tower's middle
///    [  tower  ]----o=====[  trailer  ]
///               hitch     centre    axle     metres behind the hitch
/// ```
///
/// The axle rolls towards the hitch and never aside (a tractrix), followed in steps of 10 ms and
/// evenly turned between; the distance from hitch to trailer is exact at all times.
#[derive(Clone, Debug)]
pub(crate) struct Towed {
    tower: Arc<Path>,
    lengths: Lengths,
    yaws_rad: Vec<f64>,
}

/// Where the hitch, the axle and the middle are, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lengths {
    pub(crate) hitch_m: f64,
    pub(crate) axle_m: f64,
    pub(crate) centre_m: f64,
}

impl Towed {
    /// Follows the tower until a time; at time zero the trailer stands straight behind it.
    pub(crate) fn new(tower: Arc<Path>, lengths: Lengths, until_s: f64) -> Self {
        let mut yaw = tower.at(0.0).yaw_rad;
        let mut axle = tower.at(0.0).ahead(lengths.hitch_m - lengths.axle_m);
        let mut yaws_rad = vec![yaw];
        for step in 1..=(until_s * STEPS_PER_S).ceil() as usize {
            let hitch = tower.at(step as f64 / STEPS_PER_S).ahead(lengths.hitch_m);
            let pull = libm::atan2(hitch.y_m - axle.y_m, hitch.x_m - axle.x_m);
            yaw += short_way(pull - yaw);
            axle = Place { yaw_rad: yaw, ..hitch }.ahead(-lengths.axle_m);
            yaws_rad.push(yaw);
        }
        Self { tower, lengths, yaws_rad }
    }

    pub(crate) fn at(&self, time_s: f64) -> Place {
        let hitch = self.tower.at(time_s).ahead(self.lengths.hitch_m);
        Place { yaw_rad: self.yaw_rad(time_s), ..hitch }.ahead(-self.lengths.centre_m)
    }

    pub(crate) fn trailers(&self) -> usize {
        1 + self.tower.trailers()
    }

    fn yaw_rad(&self, time_s: f64) -> f64 {
        let last = self.yaws_rad.len() - 1;
        let at = (time_s * STEPS_PER_S).clamp(0.0, last as f64);
        let (a, b) = (self.yaws_rad[at as usize], self.yaws_rad[(at as usize + 1).min(last)]);
        a + (b - a) * at.fract()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::Trajectory;

    const LENGTHS: Lengths = Lengths { hitch_m: -3.0, axle_m: 6.0, centre_m: 4.0 };

    fn trailer() -> (Arc<Path>, Towed) {
        let tower = Arc::new(Path::Own(Trajectory::Turn {
            start: Place { x_m: 0.0, y_m: 0.0, yaw_rad: 3.0 },
            speed_mps: 6.0,
            begin_s: 1.0,
            duration_s: 20.0,
            yaw_rate_rad_s: 0.5,
        }));
        (tower.clone(), Towed::new(tower, LENGTHS, 20.0))
    }

    #[test]
    fn the_hitch_keeps_its_distance_through_a_bend() {
        let (tower, trailer) = trailer();
        for step in 0..2000 {
            let time_s = f64::from(step) * 0.0103;
            let (hitch, middle) = (tower.at(time_s).ahead(LENGTHS.hitch_m), trailer.at(time_s));
            let found_m = libm::hypot(hitch.x_m - middle.x_m, hitch.y_m - middle.y_m);
            assert!((found_m - LENGTHS.centre_m).abs() < 1e-9, "{found_m} at {time_s}");
        }
    }

    #[test]
    fn in_a_long_bend_the_axle_runs_on_its_own_circle() {
        // Tower's middle on 12 m, its hitch on sqrt(12^2 + 3^2), the axle on sqrt(153 - 6^2).
        let (_, trailer) = trailer();
        let place = trailer.at(20.0);
        let axle = place.ahead(LENGTHS.centre_m - LENGTHS.axle_m);
        let start = Place { x_m: 0.0, y_m: 0.0, yaw_rad: 3.0 }.ahead(6.0);
        let centre = Place { yaw_rad: 3.0 + std::f64::consts::FRAC_PI_2, ..start }.ahead(12.0);
        let found_m = libm::hypot(axle.x_m - centre.x_m, axle.y_m - centre.y_m);
        assert!((found_m - libm::sqrt(117.0)).abs() < 0.03, "{found_m}");
    }
}
