//! Any small scene, labelled as a whole.

use std::convert::Infallible;

use occlabel_core::{
    ClassId, Exposure, Keyframe, NamedCamera, OccupancyLabels, PointCloud, PointLabel, PointsOf,
    Scene, SweepHeader, Timestamp,
};
use occlabel_occlusion::Lenses;

use super::bytes::Bytes;
use super::cameras::{any_model, with_image};
use super::rules::any_rules;
use super::tracks::any_track;
use crate::{
    LabelOptions, Rules, aggregate_scene, label_keyframe, own_points, own_view, sort_scene,
};

/// A scene whose clouds are known by the number that is their sweep's file.
struct Drive {
    scene: Scene,
    clouds: Vec<PointCloud<PointLabel>>,
}

/// Labels the keyframe of a scene by some rules: the same in one shard and in three, with evidence and
/// without, and nothing in them contradicts the rest.
pub(super) fn scene(bytes: &[u8]) -> bool {
    let mut bytes = Bytes(bytes);
    let Some(rules) = any_rules(&mut bytes) else { return false };
    let drive = any_drive(&mut bytes);
    let whole = labels(&drive, &rules, &LabelOptions::with_evidence(1));
    let parts = labels(&drive, &rules, &LabelOptions::labels(3));
    let arrays = |labels: &OccupancyLabels| {
        let OccupancyLabels { semantics, mask_lidar, mask_camera, states, .. } = labels.clone();
        (semantics, mask_lidar, mask_camera, states)
    };
    assert_eq!(arrays(&whole), arrays(&parts));
    assert_sense(&whole, &rules);
    true
}

fn labels(drive: &Drive, rules: &Rules, options: &LabelOptions) -> OccupancyLabels {
    let Drive { scene, clouds } = drive;
    let read = |sweep: &SweepHeader| -> Result<_, Infallible> {
        Ok(sweep.file.parse::<usize>().ok().map(|number| clouds[number].clone()))
    };
    let Ok(sorted) = sort_scene(scene, rules, read);
    let Ok(aggregated) = aggregate_scene(scene, rules, read, |_| {});
    assert!(aggregated.point_count() <= sorted.point_count());
    let keyframe = &scene.keyframes[0];
    let (lenses, points) = (Lenses::default(), own_points(scene, &aggregated, keyframe, rules));
    assert_eq!(points.values().len(), own_view(scene, keyframe, rules).values().len());
    label_keyframe(scene, &aggregated, &lenses, keyframe, rules, options, |_| {}).labels
}

fn assert_sense(labels: &OccupancyLabels, rules: &Rules) {
    let (free, classes) = (rules.taxonomy.free, rules.taxonomy.names.len());
    let evidence = labels.evidence.as_ref().expect("evidence was wanted");
    for at in 0..rules.spec.len() {
        let class = labels.semantics.values()[at];
        let state = labels.states.values()[at] as u8;
        let (lidar, camera) = (labels.mask_lidar.values()[at], labels.mask_camera.values()[at]);
        assert!(class == free || usize::from(class) < classes);
        assert!(camera <= lidar && lidar <= 1, "masks {lidar} {camera}");
        assert_eq!(state, evidence.state.values()[at]);
        assert!(class == free || evidence.hits.values()[at] > 0, "a class without a hit");
        let is_known = evidence.flow.values()[at].iter().all(|speed| !speed.is_nan());
        assert!(is_known || evidence.instances.values()[at] > 0, "no flow where there is no track");
    }
}

fn any_drive(bytes: &mut Bytes) -> Drive {
    let mut scene = Scene { name: "any".into(), ..Scene::default() };
    scene.sweeps = (0..1 + bytes.below(3)).map(|number| any_sweep(bytes, number)).collect();
    scene.sweeps.sort_by_key(|sweep| sweep.time);
    let tracks = bytes.below(3) as u16;
    scene.tracks = (1..=tracks).map(|id| any_track(bytes, id, any_time)).collect();
    let cameras = (0..bytes.below(3)).filter_map(|_| {
        let model = any_model(bytes).ok()?;
        Some(NamedCamera { name: "any".into(), camera: with_image(model, bytes)? })
    });
    scene.cameras = cameras.collect();
    scene.keyframes = vec![any_keyframe(bytes, &scene)];
    let clouds = scene.sweeps.iter().map(|_| any_cloud(bytes)).collect();
    Drive { scene, clouds }
}

fn any_sweep(bytes: &mut Bytes, number: usize) -> SweepHeader {
    // One of the sweeps may be left out, as one that cannot be read.
    let file = if bytes.below(16) == 15 { "absent".into() } else { number.to_string() };
    SweepHeader {
        time: any_time(bytes),
        lidar: "LIDAR_TOP".into(),
        source_id: number.to_string(),
        file,
        world_from_ego: bytes.pose(),
        ego_from_lidar: bytes.pose(),
        labelled: bytes.flag(),
        points_of: PointsOf::Moment,
    }
}

fn any_keyframe(bytes: &mut Bytes, scene: &Scene) -> Keyframe {
    let sweep = bytes.below(scene.sweeps.len());
    let time = scene.sweeps[sweep].time;
    let exposure = |camera| Exposure { camera, time, world_from_camera: bytes.pose(), image: None };
    let exposures = (0..scene.cameras.len()).map(exposure).collect();
    Keyframe { token: "any".into(), time, sweep, exposures }
}

/// Up to 60 points of one or two origins.
fn any_cloud(bytes: &mut Bytes) -> PointCloud<PointLabel> {
    let origins = (0..1 + bytes.below(2)).map(|_| bytes.place()).collect();
    let mut cloud = PointCloud::with_origins(origins);
    for _ in 0..bytes.below(60) {
        if !bytes.has_more() {
            break;
        }
        let (label, origin) = (any_label(bytes), bytes.below(cloud.origins.len()) as u32);
        cloud.push(bytes.numbers().into(), label, origin);
    }
    cloud
}

fn any_label(bytes: &mut Bytes) -> PointLabel {
    match bytes.below(20) {
        18 => PointLabel::Ignored,
        19 | 17 => PointLabel::Unlabelled,
        class => PointLabel::Class(ClassId(class as u8)),
    }
}

/// Within about four seconds.
fn any_time(bytes: &mut Bytes) -> Timestamp {
    Timestamp(bytes.whole() >> 31)
}

/// Nothing but zeros, and noise.
pub(super) fn scenes() -> Vec<Vec<u8>> {
    let noise = |seed: u32| (0..900_u32).map(|at| (seed + at * at * 7 + at / 3) as u8).collect();
    vec![vec![0; 64], noise(3), noise(50), noise(111)]
}
