//! Class of a voxel (labels.md section 7).

use std::borrow::Cow;
use std::cmp::Reverse;

use occlabel_core::{
    BUNDLE, BackgroundSweep, ClassId, ClassSet, GridSpec, Instant, Kernel, Level, PlacedObject,
    RigidMap, TrackId, VoxelGrid, VoxelVote,
};
use serde::{Deserialize, Serialize};

use crate::ballot::{Ballot, BallotBox, TrackVote};

/// The `[voxelize]` table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VoteSettings {
    /// Which points compete.
    pub vote: Vote,
    /// What a surfel of a reconstruction counts as.
    pub surfels: Surfels,
}

/// What a surfel of a reconstruction counts as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Surfels {
    /// A point at its centre.
    Points,
    /// Points all over the ellipse that it covers.
    Extent,
}

/// Which points of a voxel compete for its class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Vote {
    /// All of them.
    Majority,
    /// Track points of a mover class alone, where there are any (MobileOcc).
    MoversFirst,
}

/// How a voxel's class is decided.
#[derive(Clone, Copy, Debug)]
pub struct VoteRules<'a> {
    /// Which points compete.
    pub vote: Vote,
    /// The classes of movers.
    pub movers: &'a ClassSet,
    /// `rank[class]`, one per class: on equal votes the lowest wins.
    pub rank: &'a [u8],
}

/// The class and instance of every voxel that holds a point; `None` elsewhere.
///
/// # Panics
/// If a point's class has no rank.
pub fn voxelize(
    instant: &Instant,
    spec: &GridSpec,
    rules: &VoteRules,
) -> VoxelGrid<Option<VoxelVote>> {
    let mut ballots = BallotBox::new(spec, rules.rank.len());
    cast_background(instant, spec, &mut ballots);
    claim_painted(instant, spec, &mut ballots);
    cast_objects(instant, spec, &mut ballots);
    let mut votes = VoxelGrid::filled(spec, None);
    let values = votes.values_mut();
    ballots.tally(|ballot| values[ballot.flat] = Some(rules.decide(&ballot)));
    votes
}

fn cast_background(instant: &Instant, spec: &GridSpec, ballots: &mut BallotBox) {
    let place = &RigidMap::from(&instant.grid_from_world);
    let reaches =
        |sweep: &&Cow<BackgroundSweep<ClassId>>| sweep.bundles.whole_reach(spec, place).meets(spec);
    for sweep in instant.background.iter().filter(reaches) {
        Level::best().run(CastSweep { sweep, place, spec, ballots });
    }
}

/// Casts the votes of a sweep, a bundle at a time.
struct CastSweep<'a> {
    sweep: &'a BackgroundSweep<ClassId>,
    place: &'a RigidMap,
    spec: &'a GridSpec,
    ballots: &'a mut BallotBox,
}

impl Kernel for CastSweep<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { sweep, place, spec, ballots } = self;
        let bundles = sweep.cloud.positions.chunks(BUNDLE).zip(sweep.cloud.labels.chunks(BUNDLE));
        for (number, (positions, labels)) in bundles.enumerate() {
            if sweep.bundles.reach(number * BUNDLE, spec, place).meets(spec) {
                let flats = spec.flats_of(place, positions).into_iter().zip(labels);
                for (flat, class) in flats {
                    if let Some(flat) = flat {
                        ballots.cast(flat, *class);
                    }
                }
            }
        }
    }
}

/// Instance by instance, and class by class: background points that masks told apart are their
/// instances' own. They voted for their class with the rest.
fn claim_painted(instant: &Instant, spec: &GridSpec, ballots: &mut BallotBox) {
    let place = RigidMap::from(&instant.grid_from_world);
    let mut claims: Vec<(TrackId, ClassId, usize)> = Vec::new();
    for sweep in instant.background.iter().filter(|sweep| !sweep.brushes.is_empty()) {
        let bundles = sweep.cloud.positions.chunks(BUNDLE);
        let flats =
            bundles.flat_map(|points| spec.flats_of(&place, points).into_iter().take(points.len()));
        let points = flats.zip(&sweep.cloud.labels).zip(&sweep.brushes);
        claims.extend(
            points.filter_map(|((flat, class), brush)| Some((brush.instance()?, *class, flat?))),
        );
    }
    claims.sort_unstable();
    for of_instance in claims.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        of_instance.iter().for_each(|(_, _, flat)| ballots.claim_for_track(*flat));
        ballots.close_track(of_instance[0].1, of_instance[0].0);
    }
}

/// Track by track, and class by class should a track have several.
fn cast_objects(instant: &Instant, spec: &GridSpec, ballots: &mut BallotBox) {
    let key =
        |placed: &PlacedObject| (placed.object.track, placed.object.cloud.labels.first().copied());
    let mut objects: Vec<&PlacedObject> = instant.objects.iter().collect();
    objects.sort_by_key(|placed| key(placed));
    for of_track in objects.chunk_by(|a, b| key(a) == key(b)) {
        let (track, class) = key(of_track[0]);
        for placed in of_track {
            Level::best().run(CastObject { placed, spec, ballots });
        }
        class.into_iter().for_each(|class| ballots.close_track(class, track));
    }
}

/// Casts the votes of a track's points in one sweep, which are of one class.
struct CastObject<'a> {
    placed: &'a PlacedObject<'a>,
    spec: &'a GridSpec,
    ballots: &'a mut BallotBox,
}

impl Kernel for CastObject<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { placed, spec, ballots } = self;
        let Some(grid_from_box) = &placed.grid_from_box else { return };
        let (place, cloud) = (RigidMap::from(grid_from_box), &placed.object.cloud);
        for (positions, labels) in cloud.positions.chunks(BUNDLE).zip(cloud.labels.chunks(BUNDLE)) {
            let flats = spec.flats_of(&place, positions).into_iter().zip(labels);
            for (flat, class) in flats {
                if let Some(flat) = flat {
                    ballots.cast_for_track(flat, *class);
                }
            }
        }
    }
}

impl VoteRules<'_> {
    fn decide(&self, ballot: &Ballot) -> VoxelVote {
        let moving = match self.vote {
            Vote::Majority => None,
            Vote::MoversFirst => self.most_votes(&self.mover_counts(ballot.tracks)),
        };
        let class = moving.or_else(|| self.most_votes(ballot.counts)).expect("a ballot has votes");
        VoxelVote { class, instance: leading_track(ballot.tracks, class) }
    }

    /// Track points of mover classes, by class.
    fn mover_counts(&self, tracks: &[TrackVote]) -> Vec<u32> {
        let mut counts = vec![0; self.rank.len()];
        for vote in tracks.iter().filter(|vote| self.movers.contains(vote.class)) {
            counts[vote.class.index()] += vote.count;
        }
        counts
    }

    /// The class with most votes, ties by rank; `None` if nobody voted.
    fn most_votes(&self, counts: &[u32]) -> Option<ClassId> {
        (0..counts.len())
            .filter(|&class| counts[class] > 0)
            .max_by_key(|&class| (counts[class], Reverse(self.rank[class])))
            .map(|class| ClassId(class as u8))
    }
}

/// The track with most points of the class, ties by the lower id.
fn leading_track(tracks: &[TrackVote], class: ClassId) -> Option<TrackId> {
    (tracks.iter())
        .filter(|vote| vote.class == class)
        .max_by_key(|vote| (vote.count, Reverse(vote.track)))
        .map(|vote| vote.track)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};
    use occlabel_core::{
        AggregatedScene, BackgroundSweep, Box3, BoxGrowth, Brush, GrownBox, ObjectSweep,
        PointCloud, Pose, Timestamp,
    };
    use proptest::prelude::*;
    use std::cell::Cell;

    const ROAD: u8 = 0;
    const CAR: u8 = 1;
    const PERSON: u8 = 2;
    const RANK: [u8; 3] = [2, 1, 0];

    /// What stands in the one voxel: background classes, and (class, track) of track points.
    #[derive(Clone, Debug)]
    struct Held {
        background: Vec<u8>,
        tracks: Vec<(u8, u16)>,
    }

    fn spec() -> GridSpec {
        GridSpec::new([0.0; 3], [1.0; 3], [1.0; 3]).unwrap()
    }

    fn cloud(classes: Vec<ClassId>) -> PointCloud<ClassId> {
        let positions = vec![Point3::new(0.5, 0.5, 0.5); classes.len()];
        PointCloud::from_one_origin(Point3::origin(), positions, classes)
    }

    fn object(&(class, track): &(u8, u16)) -> ObjectSweep {
        let boxed = Box3 { world_from_box: Pose::identity(), size_m: Vector3::repeat(2.0) };
        let cloud = cloud(vec![ClassId(class)]);
        ObjectSweep { track: TrackId(track), time: Some(Timestamp(0)), boxed, cloud }
    }

    fn vote(held: &Held, vote: Vote) -> Option<VoxelVote> {
        let classes = held.background.iter().map(|&class| ClassId(class)).collect();
        let background = vec![BackgroundSweep::new(Timestamp(0), cloud(classes))];
        let scene = AggregatedScene::new(background, held.tracks.iter().map(object).collect());
        let growth = BoxGrowth { scale: 1.0, margin_m: 0.0 };
        let mut instant = Instant::still(&scene);
        instant.objects.extend(scene.objects.iter().map(|object| PlacedObject {
            object,
            grid_from_seen_box: Pose::identity(),
            seen: GrownBox::new(&object.boxed.size_m, &growth),
            grid_from_box: Some(Pose::identity()),
        }));
        let movers = [ClassId(CAR), ClassId(PERSON)].into_iter().collect();
        *voxelize(&instant, &spec(), &VoteRules { vote, movers: &movers, rank: &RANK }).at([0; 3])
    }

    fn won(class: u8, instance: u16) -> Option<VoxelVote> {
        let instance = (instance > 0).then_some(TrackId(instance));
        Some(VoxelVote { class: ClassId(class), instance })
    }

    #[test]
    fn section_7_most_points_win() {
        let held = Held { background: vec![ROAD, ROAD, PERSON], tracks: vec![(CAR, 4)] };
        assert_eq!(vote(&held, Vote::Majority), won(ROAD, 0));
        assert_eq!(vote(&Held { background: vec![], tracks: vec![] }, Vote::Majority), None);
    }

    #[test]
    fn section_7_ties_go_by_priority_not_by_id() {
        let held = Held { background: vec![ROAD, CAR, PERSON], tracks: vec![] };
        assert_eq!(vote(&held, Vote::Majority), won(PERSON, 0));
    }

    #[test]
    fn section_7_movers_first_lets_one_track_point_of_a_mover_beat_the_road() {
        let held = Held { background: vec![ROAD, ROAD, PERSON, PERSON], tracks: vec![(CAR, 9)] };
        assert_eq!(vote(&held, Vote::MoversFirst), won(CAR, 9));
        let background_only =
            Held { background: vec![ROAD, ROAD, PERSON], tracks: vec![(ROAD, 9)] };
        assert_eq!(vote(&background_only, Vote::MoversFirst), won(ROAD, 9));
    }

    #[test]
    fn section_7_the_instance_is_the_leading_track_of_the_winning_class() {
        let tracks = vec![(CAR, 7), (CAR, 3), (CAR, 3), (PERSON, 1), (CAR, 7)];
        assert_eq!(vote(&Held { background: vec![], tracks }, Vote::Majority), won(CAR, 3));
    }

    #[test]
    fn section_7_points_that_masks_told_apart_are_their_instances_own() {
        let classes = [CAR, CAR, CAR, ROAD, CAR].map(ClassId).to_vec();
        let mut sweep = BackgroundSweep::new(Timestamp(0), cloud(classes));
        sweep.brushes = [9, 0, 8, 9, 8].map(Brush::of_instance).to_vec();
        let scene = AggregatedScene::new(vec![sweep], Vec::new());
        let movers = [ClassId(CAR)].into_iter().collect();
        let voted = |vote| {
            let rules = VoteRules { vote, movers: &movers, rank: &RANK };
            *voxelize(&Instant::still(&scene), &spec(), &rules).at([0; 3])
        };
        assert_eq!(voted(Vote::Majority), won(CAR, 8));
        assert_eq!(voted(Vote::MoversFirst), won(CAR, 8));
    }

    /// The oracle: count by scanning, in the words of the rule.
    fn by_counting(held: &Held, vote: Vote) -> Option<VoxelVote> {
        let is_mover = |class: u8| class != ROAD;
        let any_mover = held.tracks.iter().any(|(class, _)| is_mover(*class));
        let points = |class: u8| {
            let of_tracks = held.tracks.iter().filter(|(c, _)| *c == class).count();
            match vote {
                Vote::MoversFirst if any_mover => {
                    if is_mover(class) {
                        of_tracks
                    } else {
                        0
                    }
                }
                _ => of_tracks + held.background.iter().filter(|c| **c == class).count(),
            }
        };
        let most = (0..3).map(points).max()?;
        let class = [PERSON, CAR, ROAD].into_iter().find(|&class| points(class) == most)?;
        let of_track = |id: u16| held.tracks.iter().filter(|t| **t == (class, id)).count();
        let best = (1..5).map(of_track).max()?;
        let instance = (1..5).find(|&id| best > 0 && of_track(id) == best).unwrap_or(0);
        if most == 0 { None } else { won(class, instance) }
    }

    #[test]
    fn section_7_the_vote_is_what_counting_says() {
        let (held_any, tied) = (Cell::new(0), Cell::new(0));
        let held = (
            prop::collection::vec(0_u8..3, 0..6),
            prop::collection::vec((0_u8..3, 1_u16..5), 0..6),
        );
        proptest!(ProptestConfig::with_cases(3_000), |((background, tracks) in held)| {
            let held = Held { background, tracks };
            for rule in [Vote::Majority, Vote::MoversFirst] {
                prop_assert_eq!(vote(&held, rule), by_counting(&held, rule));
            }
            held_any.set(held_any.get() + usize::from(!held.background.is_empty() && !held.tracks.is_empty()));
            let count = |c: u8| held.background.iter().filter(|b| **b == c).count();
            tied.set(tied.get() + usize::from(held.tracks.is_empty() && count(0) == count(1) && count(0) > 0));
        });
        assert!(
            held_any.get() > 1_000 && tied.get() > 20,
            "{} mixed, {} tied",
            held_any.get(),
            tied.get()
        );
    }
}
