//! Where the rays of a keyframe begin.

use nalgebra::Point3;

/// Origins this far from the ego or farther along x or y are left out, metres.
pub const ORIGIN_REACH_M: f64 = 39.0;
/// So many origins a keyframe at most.
pub const MOST_ORIGINS: usize = 8;

/// The origins of a keyframe's rays, out of those of its scene.
///
/// `lidar_origins` are the reference lidar's origins of all keyframes of the scene in their order, in
/// the ego frame of the keyframe that is scored, metres. Those within [`ORIGIN_REACH_M`] along x and
/// y stay, at any height; of more than [`MOST_ORIGINS`], so many evenly from the first to the last.
pub fn choose_origins(lidar_origins: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let is_near = |p: &&Point3<f64>| p.x.abs() < ORIGIN_REACH_M && p.y.abs() < ORIGIN_REACH_M;
    let near: Vec<Point3<f64>> = lidar_origins.iter().filter(is_near).copied().collect();
    if near.len() <= MOST_ORIGINS {
        return near;
    }
    evenly(near.len(), MOST_ORIGINS).map(|at| near[at]).collect()
}

/// `most` places from 0 to `len - 1`, evenly, as `round(linspace(0, len - 1, most))` has them.
fn evenly(len: usize, most: usize) -> impl Iterator<Item = usize> {
    let step = (len - 1) as f64 / (most - 1) as f64;
    (0..most).map(move |k| (k as f64 * step).round_ties_even() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along_x(count: usize, apart_m: f64) -> Vec<Point3<f64>> {
        (0..count).map(|i| Point3::new(i as f64 * apart_m, 0.0, 100.0)).collect()
    }

    #[test]
    fn origins_within_39_m_stay_at_any_height() {
        let origins = [[38.9, 0.0], [39.0, 0.0], [-39.0, 0.0], [0.0, -38.9], [f64::NAN, 0.0]];
        let chosen = choose_origins(&origins.map(|[x, y]| Point3::new(x, y, 1e3)));
        assert_eq!(chosen, [Point3::new(38.9, 0.0, 1e3), Point3::new(0.0, -38.9, 1e3)]);
        assert!(choose_origins(&[]).is_empty());
    }

    #[test]
    fn of_many_eight_stay_the_first_and_the_last_among_them() {
        assert_eq!(choose_origins(&along_x(8, 1.0)).len(), 8);
        let chosen = choose_origins(&along_x(40, 1.0));
        let xs: Vec<f64> = chosen.iter().map(|p| p.x).collect();
        assert_eq!(xs, [0.0, 5.0, 11.0, 16.0, 22.0, 27.0, 33.0, 38.0]);
    }

    #[test]
    fn places_are_never_halfway() {
        for len in 9..400 {
            let whole = (0..8).map(|k| (2 * (len - 1) * k + 7) / 14);
            assert!(evenly(len, 8).eq(whole), "{len}");
        }
    }
}
