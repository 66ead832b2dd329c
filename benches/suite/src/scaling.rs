//! How cost grows: with rays, with voxels, with keyframes, with the length of the drive.

use occlabel_annotate::relabel;
use occlabel_core::{AggregatedScene, ClassId, GridSpec, Instant};
use occlabel_pipeline::{LabelOptions, Lenses, Rules, label_keyframe};

use crate::args::Args;
use crate::clock::cost_of;
use crate::keyframe::{cast, cast_into, instant, visits, walk_background};
use crate::row::{Case, measure, print};
use crate::stages::{one_thread, sorted};
use crate::world::OpenLog;

/// Every so many-th sweep is cast.
const STRIDES: [usize; 5] = [16, 8, 4, 2, 1];
const VOXEL_SIZES_M: [f64; 3] = [0.4, 0.2, 0.1];
const KEYFRAME_COUNTS: [usize; 4] = [1, 2, 4, 8];
/// Of two drives on one road, the second twice as long: 1.2 and 2.4 km, both far beyond the reach of
/// a grid and its rays.
const DURATIONS_S: [u32; 2] = [160, 320];
/// A long road, and few enough rays that the drives are simulated in seconds.
const LONG_ROAD: [&str; 6] = [
    "static.*.repeat.count=140",
    "mover.*.repeat.count=140",
    "keyframe_hz=0.5",
    "lidar.LIDAR_TOP.rate_hz=10",
    "lidar.LIDAR_TOP.pattern.spinning.azimuths=48",
    "lidar.LIDAR_TOP.pattern.spinning.beams.even.count=16",
];

/// A log and its points, ready to be labelled.
struct Ready {
    log: OpenLog,
    rules: Rules,
    aggregated: AggregatedScene<ClassId>,
}

pub(crate) fn run(args: &Args) {
    one_thread();
    let ready = Ready::new(&args.world, &[]);
    print(&measure("scaling", ready.with_rays(), args.rounds));
    print(&measure("scaling", ready.with_voxels(), args.rounds));
    print(&measure("scaling", ready.with_keyframes(), args.rounds));
    drop(ready);
    let drives = DURATIONS_S.map(|duration_s| (duration_s, Ready::of_length(duration_s)));
    let cases = drives.iter().flat_map(|(duration_s, drive)| drive.whole(*duration_s));
    print(&measure("scaling", cases.collect(), args.rounds));
}

impl Ready {
    fn new(world: &str, settings: &[String]) -> Self {
        let log = OpenLog::open(world, settings);
        let rules = log.rules("precise");
        let aggregated = relabel(sorted(&log, &rules), &rules.relabel(&log.scene));
        Self { log, rules, aggregated }
    }

    fn of_length(duration_s: u32) -> Self {
        let mut settings = LONG_ROAD.map(String::from).to_vec();
        settings.push(format!("duration_s={duration_s}"));
        Self::new("nuscenes_like", &settings)
    }

    /// The keyframe in the middle of the drive, from every so many-th sweep.
    fn middle(&self, stride: usize) -> Instant<'_> {
        let scene = &self.log.scene;
        let keyframe = &scene.keyframes[scene.keyframes.len() / 2];
        let mut instant = instant(scene, &self.aggregated, keyframe, &self.rules);
        instant.background = instant.background.into_iter().step_by(stride).collect();
        instant.objects.clear();
        instant
    }

    fn with_rays(&self) -> Vec<Case<'_>> {
        let case = |stride| {
            let instant = self.middle(stride);
            let rays = instant.ray_count();
            let cast = move || cast(&instant, &self.rules);
            Case::new(format!("rays, 1/{stride} of sweeps"), "ray", rays, move || cost_of(&cast))
        };
        STRIDES.map(case).into()
    }

    fn with_voxels(&self) -> Vec<Case<'_>> {
        let case = |size_m: f64| {
            let (instant, spec) = (self.middle(1), self.spec(size_m));
            let visits = visits(&walk_background(&instant, &spec));
            let cast = move || cast_into(&instant, &spec, &self.rules);
            Case::new(format!("rays, {size_m} m"), "voxel visit", visits, move || cost_of(&cast))
        };
        VOXEL_SIZES_M.map(case).into()
    }

    fn spec(&self, size_m: f64) -> GridSpec {
        let (min_m, max_m) = (self.rules.spec.min_m(), self.rules.spec.max_m());
        GridSpec::new(min_m.into(), max_m.into(), [size_m; 3]).expect("whole voxels")
    }

    fn with_keyframes(&self) -> Vec<Case<'_>> {
        let case = |keyframes: usize| {
            let label = move || self.label(keyframes);
            let name = format!("label_keyframe, {keyframes} keyframes");
            Case::new(name, "ray", self.rays() * keyframes as u64, move || cost_of(label))
        };
        KEYFRAME_COUNTS.map(case).into()
    }

    /// How many there are in the scene.
    fn rays(&self) -> u64 {
        self.log.ray_count()
    }

    /// Labels keyframes spread over the drive.
    fn label(&self, keyframes: usize) {
        let Self { log, rules, aggregated } = self;
        let all = &log.scene.keyframes;
        let (lenses, options) = (Lenses::default(), LabelOptions::labels(1));
        for keyframe in all.iter().step_by(all.len() / keyframes).take(keyframes) {
            let scene = &log.scene;
            drop(label_keyframe(scene, aggregated, &lenses, keyframe, rules, &options, |_| {}));
        }
    }

    /// The lidar pass of all keyframes, and everything from reading to labels.
    fn whole(&self, duration_s: u32) -> [Case<'_>; 2] {
        let Self { log, rules, aggregated } = self;
        let cast = move || {
            for keyframe in &log.scene.keyframes {
                let instant = instant(&log.scene, aggregated, keyframe, rules);
                drop(cast(&instant, rules));
            }
        };
        let all = move || {
            drop(relabel(sorted(log, rules), &rules.relabel(&log.scene)));
            self.label(log.scene.keyframes.len());
        };
        let (name, rays) = (format!("a drive of {duration_s} s"), self.rays());
        [
            Case::new(format!("rays, {name}"), "ray", rays, move || cost_of(cast)),
            Case::new(format!("everything, {name}"), "ray", rays, move || cost_of(all)),
        ]
    }
}
