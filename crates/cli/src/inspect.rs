//! `inspect`: what a log holds, from its tables.

use std::collections::BTreeMap;

use occlabel_core::{Scene, printable};

use crate::args::InspectArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::input::open;
use crate::lacks::lacks;

pub(crate) fn run(args: &InspectArgs, console: &Console) -> Result<Outcome, Stop> {
    let opened = open(&args.log, &args.config)?;
    let names = opened.source.scene_names();
    console.result(&format!("{} scenes", names.len()));
    let (mut outcome, mut faults) = (Outcome::Complete, Vec::new());
    for name in names {
        match opened.source.describe(&name) {
            Ok(lines) => lines.iter().for_each(|line| console.result(&printable(line))),
            Err(fault) => console.warning(&name, &fault),
        }
        let scene = match opened.source.load(&name) {
            Ok(scene) => scene,
            Err(fault) => {
                faults.push(fault);
                continue;
            }
        };
        describe(&scene).iter().for_each(|line| console.result(&printable(line)));
        lacks(&scene, &opened.config).iter().for_each(|lack| console.warning(&name, lack));
        scene.warnings.iter().for_each(|fault| console.warning(&name, fault));
        for refusal in &scene.refused {
            outcome = Outcome::Degraded;
            console.warning(&name, &refusal.fault);
        }
    }
    if faults.is_empty() { Ok(outcome) } else { Err(Stop::Failed(faults)) }
}

fn describe(scene: &Scene) -> Vec<String> {
    let mut lines = vec![scene.name.clone()];
    lines.push(format!("  time span    {:.3} s", span_s(scene)));
    for (lidar, (sweeps, labelled)) in sweeps_by_lidar(scene) {
        lines.push(format!("  lidar        {lidar}: {sweeps} sweeps, {labelled} labelled"));
    }
    for named in &scene.cameras {
        let camera = &named.camera;
        let mask = if camera.body_mask.is_some() { ", body mask" } else { "" };
        let (model, size) = (camera.model.name(), format!("{} x {}", camera.width, camera.height));
        lines.push(format!("  camera       {}: {model}, {size}{mask}", named.name));
    }
    for (category, (tracks, boxes)) in tracks_by_category(scene) {
        lines.push(format!("  tracks       {category}: {tracks} with {boxes} boxes"));
    }
    for keyframe in &scene.keyframes {
        let (token, cameras) = (&keyframe.token, keyframe.exposures.len());
        lines.push(format!("  keyframe     {token}: {} ns, {cameras} cameras", keyframe.time.0));
    }
    lines
}

fn span_s(scene: &Scene) -> f64 {
    match (scene.sweeps.first(), scene.sweeps.last()) {
        (Some(first), Some(last)) => last.time.seconds_since(first.time),
        _ => 0.0,
    }
}

/// Sweeps, and labelled ones among them.
fn sweeps_by_lidar(scene: &Scene) -> BTreeMap<&str, (usize, usize)> {
    let mut counts = BTreeMap::new();
    for sweep in &scene.sweeps {
        let (sweeps, labelled) = counts.entry(sweep.lidar.as_str()).or_insert((0, 0));
        *sweeps += 1;
        *labelled += usize::from(sweep.labelled);
    }
    counts
}

/// Tracks and their annotated boxes.
fn tracks_by_category(scene: &Scene) -> BTreeMap<&str, (usize, usize)> {
    let mut counts = BTreeMap::new();
    for track in &scene.tracks {
        let (tracks, boxes) = counts.entry(track.category.as_str()).or_insert((0, 0));
        *tracks += 1;
        *boxes += track.boxes.len();
    }
    counts
}
