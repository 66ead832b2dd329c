//! The rays of RayIoU, beside the textbook's.

use std::hint::black_box;

use nalgebra::{Point3, Vector3};
use occlabel_annotate::relabel;
use occlabel_core::{AggregatedScene, ClassId, GridSpec, Keyframe, VoxelGrid};
use occlabel_evaluate::rays::{
    RayEnd, RayGrid, RaySet, cast_rays, choose_origins, first_hit, ray_pairs, textbook_first_hit,
};
use occlabel_pipeline::{LabelOptions, Lenses, Rules, label_keyframe};

use crate::args::Args;
use crate::clock::cost_of;
use crate::row::{Case, measure, print, tell_ratio};
use crate::stages::{one_thread, some_keyframes, sorted};
use crate::world::OpenLog;

/// A way to cast a ray.
type How = fn(&RayGrid, &Point3<f64>, &Vector3<f64>) -> RayEnd;

/// The labels of a keyframe, and where its rays begin.
struct Labelled {
    semantics: VoxelGrid<u8>,
    origins: Vec<Point3<f64>>,
}

/// Three keyframes; each is judged as if it had predicted the next.
struct Pass<'a> {
    spec: &'a GridSpec,
    free: u8,
    keyframes: [Labelled; 3],
    rays: RaySet,
    directions: Vec<Vector3<f64>>,
}

pub(crate) fn run(args: &Args) {
    one_thread();
    let log = OpenLog::open(&args.world, &[]);
    let rules = log.rules("occ3d-nuscenes");
    let pass = Pass::new(&log, &rules);
    pass.check();
    let rows = measure("rays", pass.cases(), args.rounds);
    print(&rows);
    tell_ratio("rays", "textbook / fans", &rows[0], &rows[2]);
}

impl Labelled {
    fn new(
        log: &OpenLog,
        aggregated: &AggregatedScene<ClassId>,
        keyframe: &Keyframe,
        rules: &Rules,
    ) -> Self {
        let (lenses, options) = (Lenses::default(), LabelOptions::labels(1));
        let run =
            label_keyframe(&log.scene, aggregated, &lenses, keyframe, rules, &options, |_| {});
        let grid_from_world = rules.world_from_grid(log.scene.reference_sweep(keyframe)).inverse();
        let origin = |keyframe| {
            let sweep = log.scene.reference_sweep(keyframe);
            grid_from_world * sweep.world_from_lidar() * Point3::origin()
        };
        let origins: Vec<Point3<f64>> = log.scene.keyframes.iter().map(origin).collect();
        Self { semantics: run.labels.semantics, origins: choose_origins(&origins) }
    }
}

impl<'a> Pass<'a> {
    fn new(log: &OpenLog, rules: &'a Rules) -> Self {
        let aggregated = relabel(sorted(log, rules), &rules.relabel(&log.scene));
        let keyframes = some_keyframes(&log.scene)
            .map(|keyframe| Labelled::new(log, &aggregated, keyframe, rules));
        let (rays, free) = (RaySet::published(), rules.taxonomy.free);
        let directions = rays.directions().collect();
        Self { spec: &rules.spec, free, keyframes, rays, directions }
    }

    fn grid(&self, keyframe: usize) -> RayGrid<'_> {
        let semantics = &self.keyframes[keyframe % 3].semantics;
        RayGrid::new(self.spec, semantics, self.free).expect("a grid of the rules")
    }

    /// That every ray ends where the textbook has it.
    fn check(&self) {
        for (at, keyframe) in self.keyframes.iter().enumerate() {
            let grid = self.grid(at);
            for origin in &keyframe.origins {
                let ends = cast_rays(&grid, origin, &self.rays).expect("a finite origin");
                for (direction, end) in self.directions.iter().zip(ends) {
                    let textbook = textbook_first_hit(&grid, origin, direction);
                    let flat = |end: RayEnd| end.hit().map(|hit| hit.flat);
                    assert_eq!(flat(end), flat(textbook), "{origin} {direction}");
                    assert!((end.depth_m() - textbook.depth_m()).abs() < 1e-9);
                }
            }
        }
    }

    fn cases(&self) -> Vec<Case<'_>> {
        let one_by_one = |how: How| {
            move || cost_of(|| (0..3).map(|at| self.cast_one_by_one(at, how)).sum::<usize>())
        };
        let fans = || cost_of(|| (0..3).map(|at| self.cast_fans(at)).sum::<usize>());
        let rays = self.keyframes.iter().map(|keyframe| keyframe.origins.len() * self.rays.len());
        let casts = rays.sum::<usize>() + (0..3).map(|at| self.cast_fans(at)).sum::<usize>();
        vec![
            Case::new("textbook", "ray", casts as u64, one_by_one(textbook_first_hit)),
            Case::new("one by one, exactly", "ray", casts as u64, one_by_one(first_hit)),
            Case::new("fans, with their columns", "ray", casts as u64, fans),
        ]
    }

    /// Into the truth, and where something is hit into the prediction; how many are hit.
    fn cast_one_by_one(&self, at: usize, how: How) -> usize {
        let (truth, prediction) = (self.grid(at), self.grid(at + 1));
        let mut hits = 0;
        for origin in &self.keyframes[at].origins {
            for direction in &self.directions {
                if how(&truth, origin, direction).hit().is_some() {
                    black_box(how(&prediction, origin, direction));
                    hits += 1;
                }
            }
        }
        hits
    }

    /// The same, all rays of an azimuth at once.
    fn cast_fans(&self, at: usize) -> usize {
        let (truth, prediction) = (self.grid(at), self.grid(at + 1));
        let origins = &self.keyframes[at].origins;
        ray_pairs(&truth, &prediction, origins, &self.rays).expect("finite origins").len()
    }
}
