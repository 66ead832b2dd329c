//! What four intensities tell of light.

use std::f64::consts::PI;

/// The linear part of the Stokes vector of light, in the units of its intensities.
///
/// Angles count from the polarizer at 0 degrees to the one at 45, as the camera's maker has them turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stokes {
    /// Intensity.
    pub s0: f64,
    /// More of it at 0 than at 90 degrees.
    pub s1: f64,
    /// More of it at 45 than at 135 degrees.
    pub s2: f64,
}

/// How light is linearly polarized.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// The share of it that is, 0 to 1: DoLP. 0 where there is no light.
    pub degree: f64,
    /// Which way that swings, radians in [0, pi): AoLP. 0 where none does.
    pub angle_rad: f64,
    /// Whether more than all of it was: noise, or a pixel that was too bright.
    pub is_clamped: bool,
}

impl Stokes {
    /// From intensities behind polarizers at 0, 45, 90 and 135 degrees. Two that are at right angles to each
    /// other add up to all the light; the two sums differ by noise alone, so that their mean is taken.
    pub fn of([i0, i45, i90, i135]: [f64; 4]) -> Self {
        Self { s0: ((i0 + i90) + (i45 + i135)) / 2.0, s1: i0 - i90, s2: i45 - i135 }
    }

    /// Degree and angle of linear polarization.
    ///
    /// Source: Goldstein, Polarized Light, "The Stokes Polarization Parameters".
    pub fn linear(&self) -> Linear {
        let polarized = libm::hypot(self.s1, self.s2);
        if self.s0 <= 0.0 || polarized == 0.0 {
            return Linear { degree: 0.0, angle_rad: 0.0, is_clamped: false };
        }
        let angle_rad = libm::atan2(self.s2, self.s1) / 2.0;
        Linear {
            degree: (polarized / self.s0).min(1.0),
            angle_rad: if angle_rad < 0.0 { angle_rad + PI } else { angle_rad },
            is_clamped: polarized > self.s0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Malus' law: what light of an intensity, degree and angle leaves behind a polarizer.
    fn behind(polarizer_rad: f64, s0: f64, degree: f64, angle_rad: f64) -> f64 {
        s0 / 2.0 * (1.0 + degree * libm::cos(2.0 * (angle_rad - polarizer_rad)))
    }

    fn seen(s0: f64, degree: f64, angle_rad: f64) -> Linear {
        let polarizers = [0.0, PI / 4.0, PI / 2.0, 3.0 * PI / 4.0];
        Stokes::of(polarizers.map(|at| behind(at, s0, degree, angle_rad))).linear()
    }

    #[test]
    fn light_of_every_degree_and_angle_is_found_by_malus_law() {
        let mut count = 0;
        for degree in [0.01, 0.25, 0.5, 0.9, 1.0] {
            for step in 0..180 {
                let angle_rad = f64::from(step) * PI / 180.0;
                for s0 in [1e-3, 1.0, 40_000.0] {
                    let found = seen(s0, degree, angle_rad);
                    assert!((found.degree - degree).abs() < 1e-12, "{found:?} of {degree}");
                    let off = (found.angle_rad - angle_rad).abs();
                    assert!(off.min(PI - off) < 1e-12, "{found:?} of {angle_rad}");
                    count += 1;
                }
            }
        }
        assert_eq!(count, 5 * 180 * 3);
    }

    #[test]
    fn angles_are_those_of_the_polarizer_that_lets_most_through() {
        let of = |intensities| Stokes::of(intensities).linear();
        let whole = |degrees: f64| (1.0, degrees * PI / 180.0);
        for (intensities, (degree, angle_rad)) in [
            ([2.0, 1.0, 0.0, 1.0], whole(0.0)),
            ([1.0, 2.0, 1.0, 0.0], whole(45.0)),
            ([0.0, 1.0, 2.0, 1.0], whole(90.0)),
            ([1.0, 0.0, 1.0, 2.0], whole(135.0)),
        ] {
            let found = of(intensities);
            assert_eq!((found.degree, found.is_clamped), (degree, false));
            assert!((found.angle_rad - angle_rad).abs() < 1e-15, "{found:?}");
        }
    }

    #[test]
    fn no_light_and_light_that_is_not_polarized_have_no_angle() {
        let none = Linear { degree: 0.0, angle_rad: 0.0, is_clamped: false };
        assert_eq!(Stokes::of([0.0; 4]).linear(), none);
        assert_eq!(Stokes::of([7.0; 4]).linear(), none);
    }

    #[test]
    fn more_polarized_than_there_is_light_is_clamped() {
        let found = Stokes::of([200.0, 10.0, 0.0, 0.0]).linear();
        assert!(found.is_clamped && found.degree == 1.0, "{found:?}");
    }
}
