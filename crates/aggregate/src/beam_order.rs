//! The order in which a lidar's rays lie side by side.

use occlabel_core::PointCloud;

/// Bins of elevation in a unit of its sine: a bin is 0.06 degrees high at the horizon, which is half
/// of what parts the beams of the densest lidars.
const BINS: f64 = 1024.0;

/// Steps of azimuth in a quarter turn: 0.005 degrees each.
const QUARTER: f64 = 16_384.0;

/// So many origins may be those of lidars that share a cloud; more are one lidar's own way.
const MAX_LIDARS: usize = 16;

/// The points' indices: lidar by lidar, beam by beam from the lowest, and by azimuth within a beam.
/// Neighbours in this order are neighbours in space, which the ray caster lives by; no result does.
///
/// Points stand in the lidar's frame. A beam is a bin of elevation seen from the ray's own origin.
/// Points of one direction stay in their order; those without a direction stand anywhere.
pub(crate) fn beam_order<L>(cloud: &PointCloud<L>) -> Vec<u32> {
    let shared = cloud.origins.len() <= MAX_LIDARS;
    let key = |i: usize| {
        let lidar = if shared { u64::from(cloud.origin_of[i]) } else { 0 };
        let ray = cloud.positions[i] - cloud.origin(i);
        let (elevation, azimuth) = direction(ray.x, ray.y, ray.z);
        lidar << 60 | elevation << 48 | azimuth << 32 | i as u64
    };
    let keys: Vec<u64> = (0..cloud.len()).map(key).collect();
    sorted_by_beam(&keys).into_iter().map(|key| key as u32).collect()
}

/// The keys in order. First by their upper 16 bits, by counting: within a beam a lidar's file is in
/// order already, or nearly so, which the sorting of the rest makes use of.
fn sorted_by_beam(keys: &[u64]) -> Vec<u64> {
    let beam = |key: u64| (key >> 48) as usize;
    let beams = keys.iter().map(|key| beam(*key) + 1).max().unwrap_or_default();
    let mut ends = vec![0_usize; beams];
    keys.iter().for_each(|key| ends[beam(*key)] += 1);
    let mut sum = 0;
    let starts: Vec<usize> = ends.iter().map(|count| (sum, sum += count).0).collect();
    ends.copy_from_slice(&starts);
    let mut sorted = vec![0; keys.len()];
    for key in keys {
        let end = &mut ends[beam(*key)];
        sorted[*end] = *key;
        *end += 1;
    }
    starts.into_iter().zip(ends).for_each(|(start, end)| sorted[start..end].sort());
    sorted
}

/// Bin of elevation, of 12 bits, and step of azimuth, of 16 bits.
///
/// No trigonometry: the sine of the elevation, and for the azimuth the way along a square on its
/// corner, both as monotonic as the angles. The horizon lies amid a bin.
#[inline]
fn direction(x: f64, y: f64, z: f64) -> (u64, u64) {
    let sine = z / (x * x + y * y + z * z).sqrt();
    let slope = y / (x.abs() + y.abs());
    let turn = if x < 0.0 { 3.0 - slope } else { 1.0 + slope };
    let elevation = (sine + 1.0) * BINS + 0.5;
    (elevation as u64, u64::from((turn * QUARTER) as u16))
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};
    use occlabel_core::LIDAR_ORIGIN;

    use super::*;

    const BEAMS: usize = 32;
    const AZIMUTHS: usize = 1084;

    /// A revolution as lidars write it, azimuth after azimuth, at all distances; the label is the
    /// place in the order wanted.
    fn revolution(origin: Point3<f64>) -> PointCloud<usize> {
        let mut cloud = PointCloud::with_origins(vec![origin]);
        for azimuth in 0..AZIMUTHS {
            for beam in 0..BEAMS {
                let place = beam * AZIMUTHS + azimuth;
                let elevation = (-30.67 + 41.34 * beam as f64 / 31.0).to_radians();
                let turn = (azimuth as f64 + 0.5) / AZIMUTHS as f64 * std::f64::consts::TAU;
                let range_m = 2.0 + (place * 7919 % 1000) as f64 * 0.1;
                let (sine, cosine) = libm::sincos(turn - std::f64::consts::FRAC_PI_2);
                let (height, flat) = libm::sincos(elevation);
                let ray = Vector3::new(flat * cosine, flat * sine, height);
                let position = origin + ray * range_m;
                cloud.push(position.map(|c| f64::from(c as f32)), place, 0);
            }
        }
        cloud
    }

    fn labels(cloud: &PointCloud<usize>) -> Vec<usize> {
        beam_order(cloud).into_iter().map(|i| cloud.labels[i as usize]).collect()
    }

    #[test]
    fn a_revolution_stands_beam_by_beam_and_by_azimuth() {
        for origin in [LIDAR_ORIGIN, Point3::new(3.0, -1.0, 2.0)] {
            assert!(labels(&revolution(origin)).is_sorted());
        }
    }

    #[test]
    fn lidars_that_share_a_cloud_stand_one_after_the_other() {
        let (left, mut both) = (Point3::new(0.0, 1.0, 0.0), revolution(LIDAR_ORIGIN));
        both.origins.push(left);
        let half = both.len();
        for (position, place) in revolution(left).positions.iter().zip(half..) {
            both.push(*position, place, 1);
        }
        let order = beam_order(&both);
        assert!(order[..half].iter().all(|&i| both.origin_of[i as usize] == 0));
        assert!(order[half..].iter().all(|&i| both.origin_of[i as usize] == 1));
    }

    #[test]
    fn one_lidars_way_does_not_part_its_beams() {
        let mut cloud = revolution(LIDAR_ORIGIN);
        cloud.origins = vec![LIDAR_ORIGIN; AZIMUTHS];
        cloud.origin_of = (0..cloud.len()).map(|i| (i / BEAMS) as u32).collect();
        assert!(labels(&cloud).is_sorted());
    }

    #[test]
    fn every_point_is_there_once_whatever_it_is() {
        let odd = [0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, f64::NAN, f64::INFINITY, -f64::INFINITY];
        let mut cloud = PointCloud::with_origins(vec![LIDAR_ORIGIN]);
        for at in 0..odd.len().pow(3) {
            let coordinate = |axis: u32| odd[at / odd.len().pow(axis) % odd.len()];
            cloud.push(Point3::new(coordinate(0), coordinate(1), coordinate(2)), at, 0);
        }
        let mut found = labels(&cloud);
        assert_ne!(found, cloud.labels);
        found.sort_unstable();
        assert_eq!(found, cloud.labels);
    }

    #[test]
    fn points_of_one_direction_stay_in_their_order() {
        let mut cloud = PointCloud::with_origins(vec![LIDAR_ORIGIN]);
        for (place, range_m) in [8.0, 2.0, 32.0, 4.0].into_iter().enumerate() {
            cloud.push(Point3::new(-3.0, 2.0, 1.0) * range_m, place, 0);
        }
        assert_eq!(labels(&cloud), [0, 1, 2, 3]);
    }

    #[test]
    fn keys_come_out_as_sorting_all_of_them_at_once_has_them() {
        let mut key = 1_u64;
        let mut keys: Vec<u64> = Vec::new();
        for length in [0, 1, 1000] {
            keys.truncate(0);
            keys.resize_with(length, || {
                key = key.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                key >> (key % 20)
            });
            let mut expected = keys.clone();
            expected.sort_unstable();
            assert_eq!(sorted_by_beam(&keys), expected);
        }
    }
}
