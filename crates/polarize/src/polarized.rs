//! Degree and angle as images of 16-bit numbers.

use std::f64::consts::PI;

use crate::{Channels, Stokes};

/// Steps of a degree from 0 to 1.
pub const DEGREE_STEPS: f64 = 65_535.0;
/// Steps of an angle from 0 to 180 degrees, which are one.
pub const ANGLE_STEPS: f64 = 65_536.0;

/// Degree and angle of linear polarization of each pixel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polarized {
    /// DoLP: 0 is none of the light, 65535 all of it.
    pub degree: Vec<u16>,
    /// AoLP: 0 to 65535 are 0 to but without 180 degrees, in steps of 180 / 65536 degrees.
    pub angle: Vec<u16>,
    /// Pixels of which more than all light was polarized; they have all of it.
    pub clamped: usize,
    /// Pixels without light.
    pub dark: usize,
}

/// How the light of each pixel is linearly polarized.
pub fn polarize(channels: &Channels) -> Polarized {
    let mut light = Polarized::default();
    for intensities in channels.pixels() {
        let stokes = Stokes::of(intensities);
        let linear = stokes.linear();
        light.degree.push((linear.degree * DEGREE_STEPS).round() as u16);
        // 180 degrees are 0 again.
        light.angle.push((linear.angle_rad / PI * ANGLE_STEPS).round() as u32 as u16);
        light.clamped += usize::from(linear.is_clamped);
        light.dark += usize::from(stokes.s0 == 0.0);
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole numbers behind the four polarizers, by Malus' law.
    fn behind(degree: f64, angle_rad: f64) -> [u16; 4] {
        [0.0, 0.25, 0.5, 0.75].map(|polarizer| {
            let turned = libm::cos(2.0 * (angle_rad - polarizer * PI));
            (30_000.0 * (1.0 + degree * turned)).round() as u16
        })
    }

    #[test]
    fn images_are_found_to_what_their_rounding_leaves() {
        let known: Vec<(f64, f64)> = (1..=20)
            .flat_map(|share| (0..60).map(move |step| (f64::from(share) / 20.0, f64::from(step))))
            .map(|(degree, step)| (degree, step * PI / 60.0))
            .collect();
        let pixels: Vec<[u16; 4]> = known.iter().map(|(d, a)| behind(*d, *a)).collect();
        let channel = |at: usize| pixels.iter().map(|pixel| pixel[at]).collect::<Vec<_>>();
        let four = [0, 1, 2, 3].map(channel);
        let light = polarize(&Channels::new(four.each_ref().map(|one| &one[..])).unwrap());
        // An intensity that is off by half a step of 30000 is a degree off by some 3e-5.
        for (at, (degree, angle_rad)) in known.iter().enumerate() {
            let found = f64::from(light.degree[at]) / DEGREE_STEPS;
            assert!((found - degree).abs() < 6e-5, "{found} of {degree}");
            let found = f64::from(light.angle[at]) / ANGLE_STEPS * PI;
            let off = (found - angle_rad).abs();
            assert!(off.min(PI - off) * degree < 6e-5, "{found} of {angle_rad} at {degree}");
        }
        assert_eq!((known.len(), light.dark), (1200, 0));
    }

    #[test]
    fn dark_and_clamped_pixels_are_counted_and_an_angle_just_below_180_is_0() {
        let four = [[0, 900, 60_000], [0, 5, 29_999], [0, 0, 0], [0, 0, 30_001]];
        let light = polarize(&Channels::new(four.each_ref().map(|one| &one[..])).unwrap());
        assert_eq!((light.dark, light.clamped), (1, 2));
        assert_eq!(light.degree, [0, 65_535, 65_535]);
        assert_eq!((light.angle[0], light.angle[2]), (0, 0));
    }

    #[test]
    fn four_images_have_as_many_pixels() {
        assert!(Channels::new([&[1, 2], &[1, 2], &[1, 2], &[1]]).is_none());
    }
}
