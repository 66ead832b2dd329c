//! A scene and the points of its sweeps.

use std::convert::Infallible;

use nalgebra::{Rotation3, Vector3};
use occlabel_core::camera::{Camera, CameraModel, Intrinsics, Pinhole};
use occlabel_core::{
    AggregatedScene, Box3, BoxTrack, ClassId, Exposure, Keyframe, Meaning, NamedCamera,
    OccupancyLabels, PointCloud, PointLabel, PointsOf, Pose, Scene, SweepHeader, Timestamp,
    TrackId,
};
use occlabel_pipeline::{LabelOptions, Lenses, Rules, aggregate_scene, label_keyframe};

/// A scene with what its reader would deliver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drive {
    pub(crate) scene: Scene,
    /// The points of each sweep, in the lidar's frame; the header's `file` is the index.
    pub(crate) clouds: Vec<PointCloud<PointLabel>>,
}

impl Drive {
    pub(crate) fn add_sweep(&mut self, header: SweepHeader, cloud: PointCloud<PointLabel>) {
        let file = self.clouds.len().to_string();
        self.scene.sweeps.push(SweepHeader { file, ..header });
        self.clouds.push(cloud);
    }

    /// A keyframe at a sweep, with the exposures of cameras by their poses.
    pub(crate) fn add_keyframe(&mut self, sweep: usize, world_from_cameras: &[Pose]) {
        let time = self.scene.sweeps[sweep].time;
        let exposure = |(camera, pose): (usize, &Pose)| Exposure {
            camera,
            time,
            world_from_camera: *pose,
            image: None,
        };
        let exposures = world_from_cameras.iter().enumerate().map(exposure).collect();
        let token = format!("at-{}", time.0);
        self.scene.keyframes.push(Keyframe { token, time, sweep, exposures });
    }

    /// The labels of every keyframe.
    pub(crate) fn labels(&self, rules: &Rules) -> Vec<OccupancyLabels> {
        self.labels_of(rules, |_| true, 1)
    }

    /// The labels of the only keyframe.
    pub(crate) fn label(&self, rules: &Rules) -> OccupancyLabels {
        let mut labels = self.labels(rules);
        assert_eq!(labels.len(), 1, "one keyframe");
        labels.remove(0)
    }

    /// The sorted and labelled points of the sweeps that `is_read` lets through.
    pub(crate) fn aggregate(
        &self,
        rules: &Rules,
        is_read: impl Fn(usize) -> bool + Sync,
    ) -> AggregatedScene<ClassId> {
        let read = |header: &SweepHeader| -> Result<_, Infallible> {
            let index: usize = header.file.parse().expect("the file is the index");
            Ok(is_read(index).then(|| self.clouds[index].clone()))
        };
        let Ok(aggregated) = aggregate_scene(&self.scene, rules, read, |_| ());
        aggregated
    }

    /// The labels of every keyframe from the sweeps that `is_read` lets through.
    pub(crate) fn labels_of(
        &self,
        rules: &Rules,
        is_read: impl Fn(usize) -> bool + Sync,
        shards: usize,
    ) -> Vec<OccupancyLabels> {
        let aggregated = self.aggregate(rules, is_read);
        let (options, lenses) = (LabelOptions::with_evidence(shards), Lenses::default());
        let keyframes = self.scene.keyframes.iter();
        keyframes
            .map(|k| {
                label_keyframe(&self.scene, &aggregated, &lenses, k, rules, &options, |_| ()).labels
            })
            .collect()
    }
}

/// A time in seconds.
pub(crate) fn at(seconds: f64) -> Timestamp {
    Timestamp((seconds * 1e9).round() as i64)
}

/// The header of a labelled sweep of the lidar TOP.
pub(crate) fn header(seconds: f64, world_from_ego: Pose, ego_from_lidar: Pose) -> SweepHeader {
    SweepHeader {
        time: at(seconds),
        lidar: "TOP".into(),
        source_id: String::new(),
        file: String::new(),
        world_from_ego,
        ego_from_lidar,
        labelled: true,
        points_of: PointsOf::Moment,
    }
}

/// A track of a class, by its annotated boxes.
pub(crate) fn track(id: u16, class: ClassId, boxes: Vec<(Timestamp, Box3)>) -> BoxTrack {
    BoxTrack {
        id: TrackId(id),
        source_id: format!("track-{id}"),
        category: "any".into(),
        meaning: Meaning::Class(class),
        boxes,
    }
}

/// A pinhole that sees `half_angle_rad` to each side of its axis, in a square image.
pub(crate) fn camera(name: &str, pixels: u32, half_angle_rad: f64) -> NamedCamera {
    let half = f64::from(pixels) / 2.0;
    let focal = half / libm::tan(half_angle_rad);
    let k = [[focal, 0.0, half], [0.0, focal, half], [0.0, 0.0, 1.0]];
    let intrinsics = Intrinsics::from_matrix(&k).expect("a matrix of a camera");
    let camera = Camera {
        model: CameraModel::Pinhole(Pinhole::new(intrinsics)),
        width: pixels,
        height: pixels,
        body_mask: None,
        rolling_shutter: None,
    };
    NamedCamera { name: name.into(), camera }
}

/// Where a camera stands that looks level along x of `frame`.
pub(crate) fn looking_ahead(frame: &Pose) -> Pose {
    // Columns: the camera's x (right), y (down), z (forward) in the vehicle's axes.
    let axes = [-Vector3::y(), -Vector3::z(), Vector3::x()];
    let turn = Rotation3::from_basis_unchecked(&axes);
    frame * Pose::from_parts(Vector3::zeros().into(), turn.into())
}

/// Asserts that two label sets are the same in every array, bit by bit.
#[track_caller]
pub(crate) fn same_arrays(a: &OccupancyLabels, b: &OccupancyLabels, what: &str) {
    same_but_flow(a, b, what);
    let bits = |labels: &OccupancyLabels| labels.evidence().flow.map(|v| v.map(f32::to_bits));
    assert!(bits(a) == bits(b), "flow: {what}");
}

/// The same, without flow, whose last bits hang on how a pose came about.
#[track_caller]
pub(crate) fn same_but_flow(a: &OccupancyLabels, b: &OccupancyLabels, what: &str) {
    assert!(a.semantics == b.semantics, "semantics: {what}");
    assert!(a.mask_lidar == b.mask_lidar, "mask_lidar: {what}");
    assert!(a.mask_camera == b.mask_camera, "mask_camera: {what}");
    assert!(a.evidence().hits == b.evidence().hits, "hits: {what}");
    assert!(a.evidence().crossings == b.evidence().crossings, "crossings: {what}");
    assert!(a.evidence().state == b.evidence().state, "state: {what}");
    assert!(a.evidence().instances == b.evidence().instances, "instances: {what}");
    assert!(a.evidence().camera_bits == b.evidence().camera_bits, "camera_bits: {what}");
}
