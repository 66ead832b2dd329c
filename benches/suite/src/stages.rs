//! Each stage on a whole scene, or on three of its keyframes.

use std::convert::Infallible;

use occlabel_aggregate::{TrackBox, split_sweep};
use occlabel_annotate::relabel;
use occlabel_core::{AggregatedScene, ClassId, Keyframe, Scene, Sweep};
use occlabel_pipeline::{Rules, boxes_at, sort_scene};

use crate::args::Args;
use crate::clock::cost_of;
use crate::keyframe_stages::KeyframeStages;
use crate::row::{Case, measure, print};
use crate::world::OpenLog;

/// Where in the drive the measured keyframes are, in eighths.
const KEYFRAMES_AT: [usize; 3] = [1, 4, 6];

pub(crate) fn run(args: &Args) {
    one_thread();
    let log = OpenLog::open(&args.world, &[]);
    let rules = log.rules("precise");
    let sorted = sorted(&log, &rules);
    let settings = rules.relabel(&log.scene);
    print(&measure("stages", once_a_scene(&log, &rules, &sorted), args.rounds));
    let aggregated = relabel(sorted, &settings);
    let keyframes = KeyframeStages::new(&log, &aggregated, &some_keyframes(&log.scene));
    print(&measure("stages", keyframes.cases(), args.rounds));
}

/// The keyframes that are measured.
pub(crate) fn some_keyframes(scene: &Scene) -> [&Keyframe; 3] {
    KEYFRAMES_AT.map(|at| &scene.keyframes[scene.keyframes.len() * at / 8])
}

/// All work on the thread that measures: what is compared is cost, not scheduling.
pub(crate) fn one_thread() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the first pool");
}

/// The scene's sweeps, sorted.
pub(crate) fn sorted(log: &OpenLog, rules: &Rules) -> AggregatedScene<Option<ClassId>> {
    let read = |header: &_| Ok::<_, Infallible>(Some(log.points(header)));
    let Ok(sorted) = sort_scene(&log.scene, rules, read);
    sorted
}

fn once_a_scene<'a>(
    log: &'a OpenLog,
    rules: &'a Rules,
    sorted: &'a AggregatedScene<Option<ClassId>>,
) -> Vec<Case<'a>> {
    let sweeps: Vec<(Sweep, Vec<TrackBox>)> = (log.scene.sweeps.iter())
        .map(|header| {
            let boxes = boxes_at(&log.scene.tracks, header, rules);
            (Sweep { header, cloud: log.points(header) }, boxes)
        })
        .collect();
    let points: usize = sweeps.iter().map(|(sweep, _)| sweep.cloud.len()).sum();
    let labels = sorted.background.iter().flat_map(|sweep| &sweep.cloud.labels);
    let queries = labels.filter(|label| label.is_none()).count();
    let settings = rules.relabel(&log.scene);
    let read = || log.scene.sweeps.iter().map(|sweep| log.points(sweep).len()).sum::<usize>();
    let split = move || {
        sweeps.iter().for_each(|(sweep, boxes)| drop(split_sweep(sweep, boxes, &rules.split)));
    };
    let relabel = move || {
        let sorted = sorted.clone();
        cost_of(|| relabel(sorted, &settings))
    };
    vec![
        Case::new("read", "point", points as u64, move || cost_of(read)),
        Case::new("split", "point", points as u64, move || cost_of(&split)),
        Case::new("relabel", "query", queries as u64, relabel),
    ]
}
