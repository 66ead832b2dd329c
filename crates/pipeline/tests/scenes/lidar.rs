//! A lidar without noise.

use nalgebra::{Point3, Vector3};
use occlabel_core::{PointCloud, PointLabel, Pose};

use super::{Body, cast};

/// Directions all around, `step_deg` apart, away from every axis.
pub(crate) fn directions(step_deg: f64) -> Vec<Vector3<f64>> {
    let rows = (180.0 / step_deg) as usize;
    let columns = (360.0 / step_deg) as usize;
    let direction = |row: usize, column: usize| {
        let polar = ((row as f64 + 0.47) * step_deg).to_radians();
        let azimuth = ((column as f64 + 0.31) * step_deg).to_radians();
        let ((flat, up), (left, ahead)) = (libm::sincos(polar), libm::sincos(azimuth));
        Vector3::new(flat * ahead, flat * left, up)
    };
    (0..rows).flat_map(|row| (0..columns).map(move |column| direction(row, column))).collect()
}

/// What a lidar sees of a world: the first surface along each direction, with its class.
pub(crate) fn look(
    world: &[Body],
    map_from_lidar: &Pose,
    directions: &[Vector3<f64>],
) -> PointCloud<PointLabel> {
    let mut cloud = PointCloud::with_origins(vec![Point3::origin()]);
    let origin = map_from_lidar * Point3::origin();
    for direction in directions {
        if let Some((distance, body)) = cast(world, &origin, &(map_from_lidar * direction)) {
            cloud.push(Point3::from(direction * distance), PointLabel::Class(body.class), 0);
        }
    }
    cloud
}
