//! Each stage on a whole scene, or on three of its keyframes.

use std::convert::Infallible;

use occlabel_aggregate::{TrackBox, split_sweep};
use occlabel_annotate::relabel;
use occlabel_core::{AggregatedScene, ClassId, Instant, Keyframe, OccupancyLabels, Sweep};
use occlabel_labels::{evidence_npz, labels_npz};
use occlabel_occlusion::visible;
use occlabel_pipeline::{Rules, boxes_at, label_keyframe, sort_scene};
use occlabel_raycast::count;
use occlabel_voxelize::voxelize;

use crate::args::Args;
use crate::clock::cost_of;
use crate::keyframe::{eyes, instant, matter_at, visits};
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
    let keyframes = KEYFRAMES_AT.map(|at| &log.scene.keyframes[log.scene.keyframes.len() * at / 8]);
    let once_a_keyframe = Keyframes { log: &log, aggregated: &aggregated, keyframes, rules };
    print(&measure("stages", once_a_keyframe.cases(), args.rounds));
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

/// What is done once a keyframe.
struct Keyframes<'a> {
    log: &'a OpenLog,
    aggregated: &'a AggregatedScene<ClassId>,
    keyframes: [&'a Keyframe; 3],
    rules: Rules,
}

impl Keyframes<'_> {
    fn cases(&self) -> Vec<Case<'_>> {
        let instants: Vec<Instant> = (self.keyframes)
            .map(|at| instant(&self.log.scene, self.aggregated, at, &self.rules))
            .into();
        let rays = instants.iter().map(Instant::ray_count).sum();
        let visits = instants.iter().map(|instant| visits(instant, &self.rules.spec)).sum();
        let pixel_rules = self.log.rules("occ3d-nuscenes");
        let instants = std::rc::Rc::new(instants);
        let rays_of = |rules: Rules| {
            let instants = instants.clone();
            move || {
                cost_of(|| {
                    instants.iter().for_each(|at| drop(count(at, &rules.spec, &rules.rays(), 1)));
                })
            }
        };
        let votes = {
            let instants = instants.clone();
            let cast = move |at: &_| drop(voxelize(at, &self.rules.spec, &self.rules.votes()));
            move || cost_of(|| instants.iter().for_each(cast))
        };
        let mut cases = vec![
            Case::new("voxelize", "point", rays, votes),
            Case::new("rays, precise", "ray", rays, rays_of(self.rules.clone())),
            Case::new("rays, precise", "voxel visit", visits, rays_of(self.rules.clone())),
            Case::new("rays, occ3d-nuscenes", "ray", rays, rays_of(pixel_rules.clone())),
            self.cameras("cameras, all-centers", self.rules.clone(), &instants),
            self.cameras("cameras, pixels", pixel_rules, &instants),
            self.whole(rays),
        ];
        cases.extend(self.files());
        cases
    }

    /// All cameras of the keyframes; what stands in their way is that of `precise`.
    fn cameras<'a>(&'a self, name: &'static str, rules: Rules, instants: &[Instant]) -> Case<'a> {
        let looks: Vec<_> = (self.keyframes.iter().zip(instants))
            .map(|(keyframe, instant)| {
                let eyes = eyes(&self.log.scene, keyframe, instant);
                (eyes, matter_at(instant, &self.rules))
            })
            .collect();
        let eyes: usize = looks.iter().map(|(eyes, _)| eyes.len()).sum();
        let look = move || {
            let see = |(eyes, matter): &(Vec<_>, _)| {
                drop(visible(eyes, &rules.spec, matter, &rules.occlusion));
            };
            cost_of(|| looks.iter().for_each(see))
        };
        Case::new(name, "image", eyes as u64, look)
    }

    fn whole(&self, rays: u64) -> Case<'_> {
        let label = || self.keyframes.iter().for_each(|keyframe| drop(self.label(keyframe)));
        Case::new("label_keyframe, precise", "ray", rays, move || cost_of(label))
    }

    fn label(&self, keyframe: &Keyframe) -> OccupancyLabels {
        let Self { log, aggregated, rules, .. } = self;
        label_keyframe(&log.scene, aggregated, keyframe, rules, 1, |_| {}).labels
    }

    fn files(&self) -> [Case<'_>; 2] {
        let labels = std::rc::Rc::new(self.keyframes.map(|keyframe| self.label(keyframe)));
        let voxels = (labels.len() * self.rules.spec.len()) as u64;
        let (of_labels, of_evidence) = (labels.clone(), labels);
        [
            Case::new("labels.npz", "voxel", voxels, move || {
                cost_of(|| of_labels.iter().map(labels_npz).map(|npz| npz.len()).sum::<usize>())
            }),
            Case::new("evidence.npz", "voxel", voxels, move || {
                let npz = |labels: &OccupancyLabels| evidence_npz(&labels.evidence).len();
                cost_of(|| of_evidence.iter().map(npz).sum::<usize>())
            }),
        ]
    }
}
