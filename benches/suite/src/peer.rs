//! Our own times on what was exported for other programs, and what came out.

use nalgebra::Point3;
use occlabel_annotate::relabel;
use occlabel_core::{
    AggregatedScene, BackgroundSweep, ClassId, Instant, PointCloud, Timestamp, VoxelState,
};
use occlabel_pipeline::{LabelOptions, Lenses, label_keyframe};

use crate::args::Args;
use crate::clock::cost_of;
use crate::export::{keyframe, neighbours, without_boxes};
use crate::exported::Exported;
use crate::keyframe;
use crate::row::{Case, measure, print, tell};
use crate::stages::one_thread;
use crate::world::OpenLog;

const BENCH: &str = "peers";

pub(crate) fn run(args: &Args) {
    one_thread();
    let folder = Exported::at(args.folder());
    let log = without_boxes(&args.world);
    cast_rays(&folder, &log, args.rounds);
    find_neighbours(&folder, args.rounds);
    label(&folder, &log, args.rounds);
}

/// Rays that end in the grid, in one keyframe.
fn cast_rays(folder: &Exported, log: &OpenLog, rounds: usize) {
    let (rules, scene) = (log.rules("precise"), rays(folder));
    let instant = Instant::still(&scene);
    let cast = || keyframe::cast(&instant, &rules);
    let counts = cast();
    let voxels = || counts.hits.values().iter().zip(counts.crossings.values());
    let free = voxels().filter(|(hits, crossings)| **hits == 0 && **crossings > 0).count();
    let hit = voxels().filter(|(hits, _)| **hits > 0).count();
    let case = Case::new("rays, ours", "ray", instant.ray_count(), || cost_of(cast));
    print(&measure(BENCH, vec![case], rounds));
    tell(BENCH, "rays, ours: free", "voxels", free as f64);
    tell(BENCH, "rays, ours: hit", "voxels", hit as f64);
}

/// Classes of unlabelled points by their neighbours; the index is paid once and told apart.
fn find_neighbours(folder: &Exported, rounds: usize) {
    let (index, both) = (labelled(folder), labelled_and_queries(folder));
    let (labels, queries) = (index.background[0].cloud.len(), both.background[1].cloud.len());
    let relabel_all = |scene: &AggregatedScene<Option<ClassId>>| {
        let scene = scene.clone();
        cost_of(|| relabel(scene, &neighbours()))
    };
    let search = || {
        let (all, index) = (relabel_all(&both), relabel_all(&index));
        all.without(index)
    };
    let cases = vec![
        Case::new("neighbours, ours: index", "point", labels as u64, || relabel_all(&index)),
        Case::new("neighbours, ours", "query", queries as u64, search),
    ];
    print(&measure(BENCH, cases, rounds));
}

/// A whole keyframe, labels of points given; rays that end outside are left out, as the paper has it.
fn label(folder: &Exported, log: &OpenLog, rounds: usize) {
    let rules = log.rules_with("precise", &["raycast.outside=drop"]);
    let scene = points(folder);
    let (lenses, options) = (Lenses::default(), LabelOptions::labels(1));
    let keyframe = keyframe(log);
    let label = || label_keyframe(&log.scene, &scene, &lenses, keyframe, &rules, &options, |_| {});
    let first = label();
    let case = Case::new("keyframe, ours", "ray", first.rays, || cost_of(label));
    print(&measure(BENCH, vec![case], rounds));
    let seen = first.labels.mask_camera.values().iter().filter(|seen| **seen == 1).count();
    let states = first.labels.states.values();
    let states = |state| states.iter().filter(|found| **found == state).count() as f64;
    tell(BENCH, "keyframe, ours: free", "voxels", states(VoxelState::Free));
    tell(BENCH, "keyframe, ours: occupied", "voxels", states(VoxelState::Occupied));
    tell(BENCH, "keyframe, ours: seen", "voxels", seen as f64);
}

/// The classes of the exported queries.
pub(crate) fn voted(folder: &Exported) -> Vec<ClassId> {
    let mut relabelled = relabel(labelled_and_queries(folder), &neighbours());
    relabelled.background.remove(1).cloud.labels
}

fn labelled(folder: &Exported) -> AggregatedScene<Option<ClassId>> {
    let classes = folder.bytes("labelled.u8").into_iter().map(|class| Some(ClassId(class)));
    scene([sweep(Point3::origin(), folder.points("labelled.f64"), classes.collect())])
}

fn labelled_and_queries(folder: &Exported) -> AggregatedScene<Option<ClassId>> {
    let mut scene = labelled(folder);
    let queries = folder.points("queries.f64");
    let nothing = vec![None; queries.len()];
    scene.background.push(sweep(Point3::origin(), queries, nothing));
    scene
}

/// The exported points, sweep by sweep.
fn points(folder: &Exported) -> AggregatedScene<ClassId> {
    let (positions, origins) = (folder.points("points.f64"), folder.points("origins.f64"));
    let (classes, starts) = (folder.bytes("classes.u8"), folder.starts("starts.u64"));
    scene(starts.windows(2).zip(origins).map(|(part, origin)| {
        let part = part[0]..part[1];
        let labels = classes[part.clone()].iter().map(|class| ClassId(*class)).collect();
        sweep(origin, positions[part].to_vec(), labels)
    }))
}

/// The exported rays, sweep by sweep, in the grid frame.
fn rays(folder: &Exported) -> AggregatedScene<ClassId> {
    let (ends, starts) = (folder.points("rays.f64"), folder.starts("ray_starts.u64"));
    scene(starts.windows(2).filter(|part| part[0] < part[1]).map(|part| {
        let rays = ends[2 * part[0]..2 * part[1]].as_chunks::<2>().0;
        let positions = rays.iter().map(|[_, end]| *end).collect();
        sweep(rays[0][0], positions, vec![ClassId(0); rays.len()])
    }))
}

fn sweep<L>(
    origin: Point3<f64>,
    positions: Vec<Point3<f64>>,
    labels: Vec<L>,
) -> BackgroundSweep<L> {
    let cloud = PointCloud::from_one_origin(origin, positions, labels);
    BackgroundSweep::new(Timestamp(0), cloud)
}

fn scene<L>(sweeps: impl IntoIterator<Item = BackgroundSweep<L>>) -> AggregatedScene<L> {
    let background = sweeps.into_iter().collect();
    AggregatedScene::new(background, vec![])
}
