//! The stages that are counted, each on the drive as the stages before it leave it.

use std::hint::black_box;

use occlabel_core::Sweep;
use occlabel_occlusion::{Eye, matter};
use occlabel_pipeline::boxes_at;
use occlabel_raycast::classify;

use crate::prepared::Prepared;
use crate::watched;

/// A stage to count.
pub(crate) struct Stage {
    /// Its name.
    pub(crate) name: &'static str,
    /// The function of `watched` that is counted.
    pub(crate) watched: &'static str,
    /// Makes what it needs, and runs it.
    pub(crate) run: fn(),
}

/// All of them.
pub(crate) const STAGES: &[Stage] = &[
    Stage { name: "split", watched: "split", run: split },
    Stage { name: "relabel", watched: "relabel", run: relabel },
    Stage { name: "voxelize", watched: "voxelize", run: voxelize },
    Stage { name: "rays-precise", watched: "rays", run: || rays("precise") },
    Stage { name: "rays-occ3d-nuscenes", watched: "rays", run: || rays("occ3d-nuscenes") },
    Stage { name: "cameras-precise", watched: "cameras", run: || cameras("precise") },
    Stage { name: "cameras-occ3d-nuscenes", watched: "cameras", run: || cameras("occ3d-nuscenes") },
    Stage { name: "keyframe", watched: "keyframe", run: keyframe },
    Stage { name: "ray-scores", watched: "score", run: score },
];

fn split() {
    let Prepared { drive, rules } = Prepared::new("precise");
    let with_boxes = |(header, cloud): (_, &_)| {
        let boxes = boxes_at(&drive.scene.tracks, header, &rules);
        (Sweep { header, cloud: Clone::clone(cloud) }, boxes)
    };
    let sweeps: Vec<_> = drive.scene.sweeps.iter().zip(&drive.clouds).map(with_boxes).collect();
    black_box(watched::split(&sweeps, &rules));
}

fn relabel() {
    let prepared = Prepared::new("precise");
    let settings = prepared.rules.relabel(&prepared.drive.scene);
    black_box(watched::relabel(prepared.sorted(), &settings));
}

fn voxelize() {
    let prepared = Prepared::new("precise");
    black_box(watched::voxelize(&prepared.instant(&prepared.aggregated()), &prepared.rules));
}

fn rays(preset: &str) {
    let prepared = Prepared::new(preset);
    black_box(watched::rays(&prepared.instant(&prepared.aggregated()), &prepared.rules));
}

fn cameras(preset: &str) {
    let prepared = Prepared::new(preset);
    let (rules, keyframe) = (&prepared.rules, prepared.keyframe());
    let (aggregated, ground) = (prepared.aggregated(), &rules.taxonomy.flat);
    let instant = prepared.instant(&aggregated);
    let votes = watched::voxelize(&instant, rules);
    let states = classify(&watched::rays(&instant, rules), &votes, ground, &rules.states);
    let eye = Eye {
        bit: 0,
        camera: &prepared.drive.scene.cameras[0].camera,
        grid_from_camera: instant.grid_from_world * keyframe.exposures[0].world_from_camera,
    };
    black_box(watched::cameras(&[eye], &matter(&states, &votes, ground), rules));
}

fn keyframe() {
    let prepared = Prepared::new("precise");
    black_box(watched::keyframe(&prepared, &prepared.aggregated()));
}

fn score() {
    let prepared = Prepared::new("precise");
    let labelled = watched::keyframe(&prepared, &prepared.aggregated());
    black_box(watched::score(&labelled.labels.semantics, &prepared.rules));
}
