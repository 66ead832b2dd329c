//! Once per keyframe: from the aggregated scene to the labels.

use nalgebra::Point3;
use occlabel_aggregate::{Moment, TrackBox, compose};
use occlabel_core::{
    AggregatedScene, ClassId, Evidence, Keyframe, OccupancyLabels, Pose, RayCounts, Scene,
    VoxelGrid, VoxelState, VoxelVote,
};
use occlabel_occlusion::{Eye, Lenses, matter, visible};
use occlabel_raycast::{
    Casting, Crossings, RaySource, StateSettings, classify, count, count_hits, seen,
};

use crate::Rules;
use crate::aggregate_scene::standing_boxes;
use crate::flow::flow;
use crate::laid_over::{lay_over, votes_beside};

/// A stage, as named to whoever watches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// Reading sweeps and sorting their points.
    Aggregate,
    /// Giving unlabelled points a class.
    Relabel,
    /// Placing everything at the keyframe and voting.
    Voxelize,
    /// Counting and judging rays.
    Raycast,
    /// Casting the cameras' rays.
    Occlusion,
    /// Deriving flow and the arrays to write.
    Finish,
}

/// What is wanted of a keyframe, and over how many threads.
#[derive(Clone, Copy, Debug)]
pub struct LabelOptions {
    /// Whether the evidence is wanted too: full counts cost more than what decides the labels.
    pub evidence: bool,
    /// How many threads the rays are shared out over; does not show in the labels.
    pub shards: usize,
}

impl LabelOptions {
    /// The labels alone.
    pub fn labels(shards: usize) -> Self {
        Self { evidence: false, shards }
    }

    /// Labels with their evidence.
    pub fn with_evidence(shards: usize) -> Self {
        Self { evidence: true, shards }
    }

    fn casting(&self, states: &StateSettings) -> Casting {
        let crossings = if self.evidence { Crossings::HowMany } else { states.crossings() };
        Casting::new(crossings, self.shards)
    }
}

/// A keyframe's labels, and what they cost.
#[derive(Clone, Debug)]
pub struct LabelledKeyframe {
    /// The arrays.
    pub labels: OccupancyLabels,
    /// How many rays they rest on.
    pub rays: u64,
}

/// Labels a keyframe. `lenses` are those of the scene, the same for all its keyframes; `enter` is
/// told which stage begins.
pub fn label_keyframe(
    scene: &Scene,
    aggregated: &AggregatedScene<ClassId>,
    lenses: &Lenses,
    keyframe: &Keyframe,
    rules: &Rules,
    options: &LabelOptions,
    mut enter: impl FnMut(Stage),
) -> LabelledKeyframe {
    let (spec, ground) = (&rules.spec, &rules.taxonomy.flat);

    enter(Stage::Voxelize);
    let standing = standing_boxes(&scene.tracks, keyframe.time, rules);
    let moment = moment(scene, keyframe, rules, &standing);
    let instant = compose(aggregated, &moment, &rules.window);
    let bodies = aggregated.bodies_at(keyframe.time);
    let mut votes = votes_beside(bodies, &instant, spec, &rules.votes());

    enter(Stage::Raycast);
    let source = rules.rays().settings.source;
    let counts = match source {
        RaySource::Lidar => count(&instant, spec, &rules.rays(), &options.casting(&rules.states)),
        RaySource::Camera => count_hits(&instant, spec),
    };
    let mut states = classify(&counts, &votes, ground, &rules.states);
    lay_over(bodies, &moment.grid_from_world, spec, &mut votes, &mut states);
    let occupied = occupied_votes(votes, &states);
    // Taken either way: the counts of a fine grid are not held while cameras look.
    let counts = options.evidence.then(|| saturated(counts));

    enter(Stage::Occlusion);
    let eyes = open_eyes(scene, keyframe, &moment.grid_from_world);
    let camera_bits =
        visible(&eyes, lenses, spec, &matter(&states, &occupied, ground), &rules.occlusion);
    let (states, occupied) = match source {
        RaySource::Lidar => (states, occupied),
        RaySource::Camera => only_seen(&states, occupied, &camera_bits),
    };

    enter(Stage::Finish);
    let mut labels = arrays(rules.taxonomy.free, states, &occupied, &camera_bits);
    labels.evidence = counts.map(|counts| {
        let flow = flow(scene, &instant, bodies, &occupied, spec, &rules.boxes);
        evidence(counts, &labels.states, &occupied, camera_bits, flow)
    });
    LabelledKeyframe { labels, rays: instant.ray_count() }
}

/// The moment of a keyframe, with the boxes that stand then.
pub(crate) fn moment<'a>(
    scene: &Scene,
    keyframe: &Keyframe,
    rules: &Rules,
    standing: &'a [TrackBox],
) -> Moment<'a> {
    let reference = scene.reference_sweep(keyframe);
    let grid_from_world = rules.world_from_grid(reference).inverse();
    let reference_lidar = grid_from_world * reference.world_from_lidar() * Point3::origin();
    let ego = reference.world_from_ego * Point3::origin();
    Moment { time: keyframe.time, grid_from_world, ego, reference_lidar, standing }
}

pub(crate) fn open_eyes<'a>(
    scene: &'a Scene,
    keyframe: &Keyframe,
    grid_from_world: &Pose,
) -> Vec<Eye<'a>> {
    let eye = |exposure: &occlabel_core::Exposure| Eye {
        bit: exposure.camera,
        camera: &scene.cameras[exposure.camera].camera,
        grid_from_camera: grid_from_world * exposure.world_from_camera,
    };
    keyframe.exposures.iter().map(eye).collect()
}

/// States and votes of what cameras see, which are all that is known.
fn only_seen(
    states: &VoxelGrid<VoxelState>,
    occupied: VoxelGrid<Option<VoxelVote>>,
    camera_bits: &VoxelGrid<u16>,
) -> (VoxelGrid<VoxelState>, VoxelGrid<Option<VoxelVote>>) {
    let states = seen(states, camera_bits);
    let occupied = occupied_votes(occupied, &states);
    (states, occupied)
}

/// The votes of occupied voxels alone.
fn occupied_votes(
    mut votes: VoxelGrid<Option<VoxelVote>>,
    states: &VoxelGrid<VoxelState>,
) -> VoxelGrid<Option<VoxelVote>> {
    for (vote, state) in votes.values_mut().iter_mut().zip(states.values()) {
        *vote = vote.filter(|_| *state == VoxelState::Occupied);
    }
    votes
}

/// Hits and crossings, as far as 16 bits go.
fn saturated(counts: RayCounts) -> [VoxelGrid<u16>; 2] {
    let saturate = |count: &u32| u16::try_from(*count).unwrap_or(u16::MAX);
    [counts.hits, counts.crossings].map(|grid| grid.map(saturate))
}

/// The arrays of labels.md section 11, but for the evidence.
fn arrays(
    free: u8,
    states: VoxelGrid<VoxelState>,
    occupied: &VoxelGrid<Option<VoxelVote>>,
    camera_bits: &VoxelGrid<u16>,
) -> OccupancyLabels {
    let is_observed = |state: &VoxelState| u8::from(*state != VoxelState::Unobserved);
    OccupancyLabels {
        semantics: occupied.map(|vote| vote.map_or(free, |vote| vote.class.0)),
        mask_lidar: states.map(is_observed),
        mask_camera: states
            .zip_map(camera_bits, |state, &bits| is_observed(state) & u8::from(bits != 0)),
        states,
        evidence: None,
    }
}

fn evidence(
    [hits, crossings]: [VoxelGrid<u16>; 2],
    states: &VoxelGrid<VoxelState>,
    occupied: &VoxelGrid<Option<VoxelVote>>,
    camera_bits: VoxelGrid<u16>,
    flow: VoxelGrid<[f32; 3]>,
) -> Evidence {
    let instance = |vote: &VoxelVote| vote.instance.map_or(0, |track| track.0);
    Evidence {
        hits,
        crossings,
        state: states.map(|state| *state as u8),
        instances: occupied.map(|vote| vote.as_ref().map_or(0, instance)),
        flow,
        camera_bits,
    }
}
