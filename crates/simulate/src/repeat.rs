//! One entry of a world file that stands for many in a row.

use nalgebra::Translation3;
use occlabel_core::{Fault, Pose};
use serde::Deserialize;

use crate::check::{angles, metres, within};
use crate::rotation::yaw_pitch_roll;

/// More copies than this are refused.
const MOST: f64 = 1e5;

/// `repeat` of a `[[static]]`: each copy stands one step further, turned in its place.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Repeat {
    pub(crate) count: usize,
    #[serde(default)]
    step_m: [f64; 3],
    #[serde(default)]
    step_yaw_rad: f64,
}

/// `repeat` of a `[[mover]]`: each copy goes the same way, one step aside on the map.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RepeatWay {
    pub(crate) count: usize,
    #[serde(default)]
    step_m: [f64; 2],
}

impl Repeat {
    pub(crate) fn check(&self) -> Result<(), Fault> {
        within("repeat.count", self.count as f64, 1.0, MOST)?;
        metres("repeat.step_m", &self.step_m)?;
        angles("repeat.step_yaw_rad", &[self.step_yaw_rad])
    }

    /// Where the copy of a number stands, copy 0 standing at `first`.
    pub(crate) fn pose(&self, first: &Pose, number: usize) -> Pose {
        let steps = number as f64;
        let [x, y, z] = self.step_m.map(|step_m| step_m * steps);
        let turn = yaw_pitch_roll(self.step_yaw_rad * steps, 0.0, 0.0);
        Pose::from_parts(Translation3::new(x, y, z) * first.translation, turn * first.rotation)
    }
}

impl RepeatWay {
    pub(crate) fn check(&self) -> Result<(), Fault> {
        within("repeat.count", self.count as f64, 1.0, MOST)?;
        metres("repeat.step_m", &self.step_m)
    }

    pub(crate) fn offset_m(&self, number: usize) -> [f64; 2] {
        self.step_m.map(|step_m| step_m * number as f64)
    }

    /// A copy's name: `name-1` and on, with leading zeros so that names sort as numbers do.
    pub(crate) fn name(&self, name: &str, number: usize) -> String {
        let digits = self.count.to_string().len();
        format!("{name}-{:0digits$}", number + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_stand_step_by_step_and_turn_in_their_place() {
        let repeat = Repeat { count: 3, step_m: [10.0, 1.0, 0.5], step_yaw_rad: 0.25 };
        let first = Pose::from_parts(Translation3::new(1.0, 2.0, 3.0), nalgebra::one());
        let third = repeat.pose(&first, 2);
        assert_eq!(third.translation, Translation3::new(21.0, 4.0, 4.0));
        assert!((third.rotation.angle() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn names_sort_as_numbers_do() {
        let repeat = RepeatWay { count: 12, step_m: [5.0, 0.0] };
        assert_eq!([repeat.name("car", 1), repeat.name("car", 10)], ["car-02", "car-11"]);
    }
}
