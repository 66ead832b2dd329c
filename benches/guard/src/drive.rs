//! One second down the street: ten sweeps, two keyframes, a car, a camera.

use std::f64::consts::TAU;

use nalgebra::{Point3, Rotation3, Vector3};
use occlabel_core::camera::{Camera, CameraModel, Intrinsics, Pinhole};
use occlabel_core::{
    Box3, BoxTrack, Exposure, Keyframe, Meaning, NamedCamera, PointCloud, PointLabel, PointsOf,
    Pose, Scene, SweepHeader, Taxonomy, Timestamp, TrackId,
};

use crate::street::{CAR_SIZE_M, Solid, car_centre, street};

const SWEEPS: usize = 10;
const SWEEP_S: f64 = 0.1;
/// Every so many-th sweep is labelled, and a keyframe.
const KEYFRAME_STRIDE: usize = 5;
const BEAMS: usize = 16;
const AZIMUTHS: usize = 360;
const MAX_RANGE_M: f64 = 60.0;
/// Ranges err by up to so much, so that points lie on no plane.
const NOISE_M: f64 = 0.02;
const EGO_SPEED_MPS: f64 = 8.0;

/// The scene, and the points of each sweep in the lidar's frame.
pub(crate) struct Drive {
    pub(crate) scene: Scene,
    pub(crate) clouds: Vec<PointCloud<PointLabel>>,
}

impl Drive {
    pub(crate) fn new(taxonomy: &Taxonomy) -> Self {
        let sweeps: Vec<_> = (0..SWEEPS).map(header).collect();
        let clouds =
            sweeps.iter().map(|header| cloud(header, &street(time_s(header), taxonomy))).collect();
        let keyframes: Vec<_> =
            (0..SWEEPS).step_by(KEYFRAME_STRIDE).map(|at| keyframe(&sweeps[at], at)).collect();
        let scene = Scene {
            name: "street".into(),
            tracks: vec![car_track(&keyframes, taxonomy)],
            cameras: vec![NamedCamera { name: "CAM_FRONT".into(), camera: camera() }],
            sweeps,
            keyframes,
            ..Scene::default()
        };
        Self { scene, clouds }
    }
}

fn header(at: usize) -> SweepHeader {
    let time_s = at as f64 * SWEEP_S;
    SweepHeader {
        time: Timestamp((time_s * 1e9).round() as i64),
        lidar: "TOP".into(),
        source_id: at.to_string(),
        file: at.to_string(),
        world_from_ego: Pose::translation(EGO_SPEED_MPS * time_s, -1.7, 0.0),
        ego_from_lidar: Pose::translation(0.9, 0.03, 1.84),
        labelled: at.is_multiple_of(KEYFRAME_STRIDE),
        points_of: PointsOf::Moment,
    }
}

fn time_s(header: &SweepHeader) -> f64 {
    header.time.0 as f64 / 1e9
}

fn cloud(header: &SweepHeader, solids: &[Solid]) -> PointCloud<PointLabel> {
    let world_from_lidar = header.world_from_lidar();
    let origin = world_from_lidar * Point3::origin();
    let seed = time_s(header) * 1000.0;
    let mut cloud = PointCloud::with_origins(vec![Point3::origin()]);
    for (number, direction) in directions().enumerate() {
        let hit = |solid: &Solid| Some((solid.distance_m(&origin, &direction)?, solid.class));
        let nearest = solids.iter().filter_map(hit).min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((range_m, class)) = nearest.filter(|(range_m, _)| *range_m < MAX_RANGE_M) {
            let noise_m = NOISE_M * libm::sin(number as f64 * 12.9898 + seed);
            let label =
                if header.labelled { PointLabel::Class(class) } else { PointLabel::Unlabelled };
            cloud.push(Point3::from(direction * (range_m + noise_m)), label, 0);
        }
    }
    cloud
}

/// Unit vectors, beam by beam, none along an axis.
fn directions() -> impl Iterator<Item = Vector3<f64>> {
    (0..BEAMS).flat_map(|beam| {
        let (up, out) = libm::sincos(-0.43 + 0.04 * beam as f64);
        (0..AZIMUTHS).map(move |step| {
            let (left, ahead) = libm::sincos(TAU * (step as f64 + 0.3) / AZIMUTHS as f64);
            Vector3::new(out * ahead, out * left, up)
        })
    })
}

/// A keyframe whose camera looks level ahead.
fn keyframe(sweep: &SweepHeader, at: usize) -> Keyframe {
    // Columns: the camera's x (right), y (down), z (forward) in the ego's axes.
    let axes = [-Vector3::y(), -Vector3::z(), Vector3::x()];
    let turn = Rotation3::from_basis_unchecked(&axes);
    let ego_from_camera = Pose::from_parts(Vector3::new(1.7, 0.02, 1.5).into(), turn.into());
    let world_from_camera = sweep.world_from_ego * ego_from_camera;
    let exposure = Exposure { camera: 0, time: sweep.time, world_from_camera, image: None };
    Keyframe { token: at.to_string(), time: sweep.time, sweep: at, exposures: vec![exposure] }
}

fn car_track(keyframes: &[Keyframe], taxonomy: &Taxonomy) -> BoxTrack {
    let boxed = |keyframe: &Keyframe| {
        let centre = car_centre(keyframe.time.0 as f64 / 1e9);
        let world_from_box = Pose::translation(centre.x, centre.y, centre.z);
        (keyframe.time, Box3 { world_from_box, size_m: CAR_SIZE_M })
    };
    let class = taxonomy.class_named("car").expect("a class of Occ3D");
    BoxTrack {
        id: TrackId(1),
        source_id: "car".into(),
        category: "vehicle.car".into(),
        meaning: Meaning::Class(class),
        boxes: keyframes.iter().map(boxed).collect(),
    }
}

fn camera() -> Camera {
    let matrix = [[315.0, 0.0, 200.0], [0.0, 315.0, 112.5], [0.0, 0.0, 1.0]];
    let intrinsics = Intrinsics::from_matrix(&matrix).expect("a matrix of a camera");
    Camera {
        model: CameraModel::Pinhole(Pinhole::new(intrinsics)),
        width: 400,
        height: 225,
        body_mask: None,
        rolling_shutter: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};

    #[test]
    fn the_drive_has_rays_of_every_class_and_hits_the_car() {
        let text = shipped_taxonomy("occ3d-nuscenes").unwrap();
        let taxonomy = parse_taxonomy(text, "occ3d-nuscenes").unwrap();
        let drive = Drive::new(&taxonomy);
        let points: usize = drive.clouds.iter().map(PointCloud::len).sum();
        assert!((40_000..57_600).contains(&points), "{points} points");
        for name in ["car", "driveable_surface", "sidewalk", "manmade", "vegetation"] {
            let label = PointLabel::Class(taxonomy.class_named(name).unwrap());
            let count = drive.clouds[0].labels.iter().filter(|found| **found == label).count();
            assert!(count > 10, "{count} points of {name}");
        }
    }
}
