//! The numbers of `vectors/rays.py`, which states the formulas in NumPy.

use nalgebra::{Point3, Vector3};
use occlabel_core::{GridSpec, VoxelGrid};
use occlabel_evaluate::rays::{
    FlowTally, InstanceGrids, PanopticTally, RayGrid, RayPair, RayPqAt, RayPqClass, RaySet,
    RayTally, challenge_score, choose_origins, first_hit, ray_pairs,
};
use serde::Deserialize;

use crate::support::spec;

const VECTORS: &str = include_str!("../vectors/rays.json");

/// How far our numbers may be from theirs.
const CLOSE: f64 = 1e-9;

#[derive(Deserialize)]
struct Vectors {
    ray_set: TheirSet,
    origins: TheirOrigins,
    first_hits: TheirHits,
    scores: Scores,
}

#[derive(Deserialize)]
struct TheirSet {
    count: usize,
    sum: [f64; 3],
    digest: i64,
    some: Vec<(usize, f64, f64, f64)>,
}

#[derive(Deserialize)]
struct TheirOrigins {
    all: Vec<[f64; 3]>,
    chosen: Vec<[f64; 3]>,
}

#[derive(Deserialize)]
struct TheirHits {
    shape: [usize; 3],
    size_m: [f64; 3],
    free: u8,
    grid: Vec<u8>,
    rays: Vec<[f64; 8]>,
}

#[derive(Deserialize)]
struct Scores {
    shape: [usize; 3],
    size_m: [f64; 3],
    free: u8,
    things: Vec<u8>,
    flow_classes: Vec<u8>,
    thresholds_m: Vec<f64>,
    pitches: Vec<f64>,
    azimuths: Vec<f64>,
    frames: Vec<TheirFrame>,
    rays: usize,
    ray_iou: Vec<Vec<Option<f64>>>,
    mean: f64,
    ave: Vec<Option<f64>>,
    mave: f64,
    score: f64,
    pq: Vec<Vec<Option<f64>>>,
    sq: Vec<Vec<Option<f64>>>,
    rq: Vec<Vec<Option<f64>>>,
    mean_pq: f64,
}

#[derive(Deserialize)]
struct TheirFrame {
    truth: Vec<u8>,
    prediction: Vec<u8>,
    truth_instances: Vec<u16>,
    prediction_instances: Vec<u16>,
    truth_flow: Vec<f32>,
    prediction_flow: Vec<f32>,
    origins: Vec<[f64; 3]>,
}

/// A frame as grids, and its rays.
struct Frame {
    semantics: [VoxelGrid<u8>; 2],
    instances: [VoxelGrid<u16>; 2],
    flow: [VoxelGrid<[f32; 3]>; 2],
    pairs: Vec<RayPair>,
}

fn vectors() -> Vectors {
    serde_json::from_str(VECTORS).unwrap()
}

#[track_caller]
fn close(what: &str, ours: Option<f64>, theirs: Option<f64>) {
    let is_close = match (ours, theirs) {
        (Some(ours), Some(theirs)) => (ours - theirs).abs() < CLOSE,
        (ours, theirs) => ours == theirs,
    };
    assert!(is_close, "{what}: ours {ours:?}, theirs {theirs:?}");
}

#[track_caller]
fn all_close(what: &str, ours: &[Option<f64>], theirs: &[Option<f64>]) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    ours.iter().zip(theirs).for_each(|(ours, theirs)| close(what, *ours, *theirs));
}

impl Scores {
    fn spec(&self) -> GridSpec {
        spec(self.shape, self.size_m)
    }

    fn frames(&self) -> Vec<Frame> {
        let rays = RaySet::new(&self.pitches, &self.azimuths).unwrap();
        self.frames.iter().map(|frame| frame.read(&self.spec(), self.free, &rays)).collect()
    }
}

impl TheirFrame {
    fn read(&self, spec: &GridSpec, free: u8, rays: &RaySet) -> Frame {
        let semantics = [&self.truth, &self.prediction]
            .map(|classes| VoxelGrid::from_values(spec, classes.clone()));
        let instances = [&self.truth_instances, &self.prediction_instances]
            .map(|ids| VoxelGrid::from_values(spec, ids.clone()));
        let flow = [&self.truth_flow, &self.prediction_flow].map(|eighths| {
            let velocities = eighths.as_chunks::<2>().0.iter();
            let velocities = velocities.map(|[x, y]| [x / 8.0, y / 8.0, 0.0]).collect();
            VoxelGrid::from_values(spec, velocities)
        });
        let grid = |side: usize| RayGrid::new(spec, &semantics[side], free).unwrap();
        let origins: Vec<Point3<f64>> = self.origins.iter().copied().map(Point3::from).collect();
        let pairs = ray_pairs(&grid(0), &grid(1), &origins, rays).unwrap();
        Frame { semantics, instances, flow, pairs }
    }
}

#[test]
fn the_published_ray_set_is_theirs() {
    let (theirs, ours) = (vectors().ray_set, RaySet::published());
    let directions: Vec<Vector3<f64>> = ours.directions().collect();
    assert_eq!((directions.len(), theirs.count), (14_040, 14_040));
    for axis in 0..3 {
        let sum = directions.iter().map(|direction| direction[axis]).sum();
        close("sum", Some(sum), Some(theirs.sum[axis]));
    }
    for (at, x, y, z) in theirs.some {
        assert!((directions[at] - Vector3::new(x, y, z)).norm() < 1e-15, "direction {at}");
    }
    let rounded = directions.iter().flatten().map(|c| (c * 1e6).round() as i128);
    let digest = rounded.fold(0, |digest, c| (digest * 1_000_003 + c).rem_euclid((1 << 61) - 1));
    assert_eq!(digest, i128::from(theirs.digest));
}

#[test]
fn the_chosen_origins_are_theirs() {
    let TheirOrigins { all, chosen } = vectors().origins;
    let all: Vec<Point3<f64>> = all.into_iter().map(Point3::from).collect();
    let chosen: Vec<Point3<f64>> = chosen.into_iter().map(Point3::from).collect();
    assert_eq!((all.len(), chosen.len()), (60, 8));
    assert_eq!(choose_origins(&all), chosen);
}

#[test]
fn rays_end_where_theirs_end() {
    let theirs = vectors().first_hits;
    let spec = spec(theirs.shape, theirs.size_m);
    let semantics = VoxelGrid::from_values(&spec, theirs.grid);
    let grid = RayGrid::new(&spec, &semantics, theirs.free).unwrap();
    let mut hits = 0;
    for [px, py, pz, x, y, z, class, depth_m] in theirs.rays {
        let end = first_hit(&grid, &Point3::new(px, py, pz), &Vector3::new(x, y, z));
        let hit = end.hit().map(|hit| grid.class(hit.flat as usize));
        assert_eq!(f64::from(hit.unwrap_or(theirs.free)), class);
        close("depth", Some(end.depth_m()), Some(depth_m));
        hits += i32::from(hit.is_some());
    }
    assert!(hits > 20, "{hits}");
}

#[test]
fn ray_iou_is_theirs() {
    let theirs = vectors().scores;
    let tally = |frame: &Frame| {
        let mut tally = RayTally::new(theirs.free.into(), &theirs.thresholds_m);
        tally.count(&frame.pairs, &frame.semantics[0], &frame.semantics[1]);
        tally
    };
    let tallies: Vec<RayTally> = theirs.frames().iter().map(tally).collect();
    let [forth, back] = [[0, 1, 2], [2, 1, 0]].map(|order| {
        let mut all = tallies[order[0]].clone();
        order[1..].iter().for_each(|&frame| all.add(&tallies[frame]));
        all
    });
    assert_eq!(forth, back);
    let ours = forth.ray_iou();
    assert_eq!(ours.truth_rays.iter().sum::<u64>(), theirs.rays as u64);
    for (ours, theirs) in ours.by_threshold.iter().zip(&theirs.ray_iou) {
        all_close("RayIoU", &ours.by_class, theirs);
    }
    let table = &theirs.ray_iou[0];
    assert_eq!((table[2], table[5]), (Some(0.0), None), "predicted only, and nowhere");
    close("mean", ours.mean, Some(theirs.mean));
}

#[test]
fn velocity_errors_and_the_score_are_theirs() {
    let theirs = vectors().scores;
    let (mut tally, mut rays) =
        (FlowTally::new(&theirs.flow_classes), RayTally::new(6, &theirs.thresholds_m));
    for Frame { semantics, flow, pairs, .. } in theirs.frames() {
        let mut frame = FlowTally::new(&theirs.flow_classes);
        frame.count(&pairs, [0, 1].map(|side| (&semantics[side], &flow[side])));
        tally.add(&frame);
        rays.count(&pairs, &semantics[0], &semantics[1]);
    }
    let ours = tally.score();
    all_close("AVE", &ours.by_class, &theirs.ave);
    close("mAVE", ours.mean, Some(theirs.mave));
    assert!(theirs.mave < 1.0 && ours.unknown_rays == 0);
    close("score", challenge_score(rays.ray_iou().mean, ours.mean), Some(theirs.score));
}

#[test]
fn ray_pq_is_theirs() {
    let theirs = vectors().scores;
    let new = || PanopticTally::new(theirs.free.into(), &theirs.things, &theirs.thresholds_m);
    let mut tally = new();
    for Frame { semantics, instances, pairs, .. } in theirs.frames() {
        let [truth, prediction] = [0, 1]
            .map(|side| InstanceGrids { semantics: &semantics[side], instances: &instances[side] });
        let mut frame = new();
        frame.count(&pairs, truth, prediction);
        tally.add(&frame);
    }
    let ours = tally.ray_pq();
    let figures = |at: &RayPqAt, figure: fn(RayPqClass) -> f64| -> Vec<Option<f64>> {
        at.by_class.iter().map(|class| class.map(figure)).collect()
    };
    for (at, ours) in ours.by_threshold.iter().enumerate() {
        all_close("PQ", &figures(ours, |class| class.pq), &theirs.pq[at]);
        all_close("SQ", &figures(ours, |class| class.sq), &theirs.sq[at]);
        all_close("RQ", &figures(ours, |class| class.rq), &theirs.rq[at]);
    }
    close("mean PQ", ours.mean, Some(theirs.mean_pq));
}
