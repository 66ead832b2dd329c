//! A spinning lidar that takes a whole sweep in one instant.

use crate::pose::Pose;
use crate::rig::ego_from_lidar;
use crate::solid::Ray;
use crate::street::{Hit, StreetInstant};
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;

/// Elevations of the lowest and the highest beam of nuScenes' lidar (Velodyne HDL-32E).
const ELEVATION_DEG: [f64; 2] = [-30.67, 10.67];

/// Where the beams go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LidarPattern {
    /// Number of beams, at least 2, evenly spread in elevation.
    pub beams: usize,
    /// Number of directions per revolution.
    pub azimuths: usize,
    /// What is farther gives no return.
    pub max_range_m: f64,
}

impl LidarPattern {
    /// Every ray's ring (0 is the lowest) and unit direction in the lidar frame, azimuth by azimuth.
    /// Azimuths stand 0.3 steps off the x axis, so that no ray runs along an axis or a diagonal,
    /// whatever their number, and so in no plane of voxel faces.
    pub(crate) fn directions(&self) -> impl Iterator<Item = (usize, Vector3<f64>)> {
        let pattern = *self;
        (0..self.azimuths).flat_map(move |step| {
            let azimuth_rad = TAU * (step as f64 + 0.3) / pattern.azimuths as f64;
            let (sin, cos) = libm::sincos(azimuth_rad);
            (0..pattern.beams).map(move |ring| {
                let (up, out) = libm::sincos(pattern.elevation_rad(ring));
                (ring, Vector3::new(out * cos, out * sin, up))
            })
        })
    }

    fn elevation_rad(&self, ring: usize) -> f64 {
        let [low, high] = ELEVATION_DEG;
        (low + (high - low) * ring as f64 / (self.beams - 1) as f64).to_radians()
    }
}

/// One return of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Return {
    /// The point in the lidar frame, as it goes to disk.
    pub(crate) point_m: [f32; 3],
    /// The beam's number, 0 is the lowest.
    pub(crate) ring: usize,
    /// What was hit; its distance is the unrounded one.
    pub(crate) hit: Hit,
}

/// All returns of one sweep, in the order of [`LidarPattern::directions`].
pub(crate) fn sweep(
    street: &StreetInstant,
    world_from_ego: &Pose,
    pattern: &LidarPattern,
) -> Vec<Return> {
    let world_from_lidar = world_from_ego * ego_from_lidar();
    let origin = world_from_lidar * Point3::origin();
    let cast = |(ring, in_lidar)| {
        let ray = Ray { origin, direction: world_from_lidar * in_lidar };
        let hit = street.cast(&ray, pattern.max_range_m)?;
        let at: Vector3<f64> = in_lidar * hit.distance_m;
        let point_m = at.map(|metres| metres as f32).into();
        Some(Return { point_m, ring, hit })
    };
    pattern.directions().filter_map(cast).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::categories::{DRIVEABLE, EGO};
    use crate::log_spec::{LogSpec, SweepSlot};
    use crate::rig::world_from_ego;
    use crate::street::Street;

    const PATTERN: LidarPattern = LidarPattern { beams: 16, azimuths: 90, max_range_m: 70.0 };

    fn first_sweep() -> Vec<Return> {
        let ego = world_from_ego(6.0, 0.0);
        sweep(&Street::new(0).at(0.0, &ego), &ego, &PATTERN)
    }

    fn in_ego(found: &Return) -> Point3<f64> {
        ego_from_lidar() * Point3::from(found.point_m.map(f64::from))
    }

    #[test]
    fn beams_span_the_elevations() {
        let rays: Vec<_> = PATTERN.directions().collect();
        assert_eq!(rays.len(), 16 * 90);
        for (ring, elevation_deg) in [(0, -30.67), (15, 10.67)] {
            let found_deg = libm::asin(rays[ring].1.z).to_degrees();
            assert_eq!(rays[ring].0, ring);
            assert!((found_deg - elevation_deg).abs() < 1e-9, "{found_deg}");
        }
    }

    #[test]
    fn road_returns_lie_on_the_road() {
        let sweep = first_sweep();
        let road: Vec<_> = sweep.iter().filter(|r| r.hit.category == DRIVEABLE).collect();
        assert!(road.len() > 100, "{} returns", road.len());
        for z_m in road.into_iter().map(|found| in_ego(found).z) {
            assert!(z_m.abs() < 1e-5, "{z_m}");
        }
    }

    #[test]
    fn ego_returns_lie_on_the_car() {
        let sweep = first_sweep();
        let ego: Vec<_> = sweep.iter().filter(|r| r.hit.category == EGO).collect();
        assert!(ego.len() > 40, "{} returns", ego.len());
        for p in ego.into_iter().map(in_ego) {
            let inside = (0.29..1.81).contains(&p.x) && p.y.abs() < 0.61;
            assert!(inside && (p.z - 1.5).abs() < 1e-5, "{p:?}");
        }
    }

    #[test]
    fn track_returns_lie_in_their_boxes() {
        let street = Street::new(0);
        let mut seen = vec![0; street.tracks.len()];
        for found in first_sweep() {
            let Some(index) = found.hit.track else { continue };
            let track = &street.tracks[index];
            let in_world = world_from_ego(6.0, 0.0) * in_ego(&found);
            let p = track.world_from_box(0.0).inverse() * in_world;
            assert!((0..3).all(|axis| p[axis].abs() < track.size_m[axis] / 2.0), "{p:?}");
            seen[index] += 1;
        }
        assert!(seen.iter().filter(|&&count| count > 0).count() >= 6, "{seen:?}");
    }

    /// How far each coordinate of a point of the ego frame is from a face of 0.4 m voxels.
    fn voxels_off_a_face(p: Point3<f64>) -> impl Iterator<Item = f64> {
        let along = [p.x, p.y, p.z + 1.0].map(|metres| metres / 0.4);
        along.into_iter().map(|voxels| (voxels - voxels.round()).abs())
    }

    /// All returns of nano in the ego frame of a keyframe; of movers only those of its own sweep.
    fn composed(spec: &LogSpec, key: SweepSlot) -> Vec<Point3<f64>> {
        let world_from_ego = |slot: &SweepSlot| world_from_ego(spec.ego_speed_mps, slot.time_s());
        let place = |slot: SweepSlot| {
            let ego = world_from_ego(&slot);
            let returns = sweep(&Street::new(0).at(slot.time_s(), &ego), &ego, &spec.lidar);
            let kept = returns.into_iter().filter(move |found| {
                found.hit.category != EGO && (found.hit.track.is_none() || slot == key)
            });
            kept.map(move |found| world_from_ego(&key).inverse() * ego * in_ego(&found))
        };
        spec.sweep_slots().flat_map(place).collect()
    }

    #[test]
    fn no_surface_lies_on_faces_between_voxels() {
        let spec = LogSpec::nano();
        let keys: Vec<_> = spec.sweep_slots().filter(|slot| slot.is_key).collect();
        let points: Vec<_> = keys.into_iter().flat_map(|key| composed(&spec, key)).collect();
        // f32 at 70 m is good to 1e-5 voxel. Chance puts 4e-5 of all coordinates that near to a
        // face; a surface would put many more there.
        let near =
            points.iter().copied().flat_map(voxels_off_a_face).filter(|&off| off < 2e-5).count();
        assert!(points.len() > 20_000 && near < 8, "{near} of {} points", points.len());
    }
}
