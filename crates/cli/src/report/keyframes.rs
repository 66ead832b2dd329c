//! Keyframes, counted and drawn.

use occlabel_core::Fault;
use occlabel_dialects::KeyframeKey;
use occlabel_view::{
    KeyframeAt, Painted, Run, RunKeyframe, RunScene, Thumbnail, VoxelTotals, png, thumbnail,
};
use rayon::prelude::*;

use crate::console::Console;
use crate::report::run_report::RunReport;
use crate::shown_set::ShownSet;

/// Every scene with the totals of its keyframes. A keyframe that cannot be read is told as such.
///
/// # Errors
/// If the labels contradict themselves.
pub(crate) fn scenes(
    labels: &ShownSet,
    told: &RunReport,
    console: &Console,
) -> Result<Vec<RunScene>, Fault> {
    let mut scenes = Vec::new();
    for name in labels.scene_names() {
        let scene = scene(labels, name, told.seconds_of(name))?;
        for (token, why) in &scene.unreadable {
            console.info(&format!("{name}: keyframe {token} cannot be read: {why}"));
        }
        scenes.push(scene);
    }
    Ok(scenes)
}

fn scene(labels: &ShownSet, name: &str, seconds: Option<f64>) -> Result<RunScene, Fault> {
    let keys = labels.keyframes(name, &[])?;
    let totals: Vec<_> = keys.par_iter().map(|key| totals(labels, key)).collect();
    let mut scene = RunScene { name: name.to_owned(), seconds, ..RunScene::default() };
    for (KeyframeKey { token, .. }, totals) in keys.into_iter().zip(totals) {
        match totals {
            Ok(totals) => scene.keyframes.push(RunKeyframe { token, totals }),
            Err(fault) => scene.unreadable.push((token, fault.to_string())),
        }
    }
    Ok(scene)
}

fn totals(labels: &ShownSet, key: &KeyframeKey) -> Result<VoxelTotals, Fault> {
    let read = labels.set.read(key)?;
    let classes = usize::from(labels.set.classes().free_index());
    let (lidar, camera) = (read.mask_lidar.as_ref(), read.mask_camera.as_ref());
    Ok(VoxelTotals::of(classes, &read.semantics, lidar, camera))
}

/// The keyframes that the page wants to show, drawn small.
///
/// # Errors
/// If one can no longer be read.
pub(crate) fn thumbnails(labels: &ShownSet, run: &Run) -> Result<Vec<Thumbnail>, Fault> {
    let draw = |at: &KeyframeAt| draw(labels, run, *at);
    run.wanted_thumbnails().par_iter().map(draw).collect()
}

fn draw(labels: &ShownSet, run: &Run, at: KeyframeAt) -> Result<Thumbnail, Fault> {
    let RunScene { name, keyframes, .. } = &run.scenes[at.scene];
    let scene = labels.scene(Some(name))?;
    let token = keyframes[at.keyframe].token.clone();
    let read = labels.set.read(&KeyframeKey { scene: name.clone(), token })?;
    let painted = Painted {
        spec: &read.spec,
        semantics: &read.semantics,
        mask_lidar: read.mask_lidar.as_ref(),
        mask_camera: read.mask_camera.as_ref(),
        free: scene.free,
        palette: &scene.palette,
        heading_rad: None,
    };
    Ok(Thumbnail { at, png: png(&thumbnail(&painted)) })
}
