//! What held-out rays found, counted.

use super::DepthErrors;
use super::kind::Kind;

/// What the held-out rays of a keyframe, a scene or a log found. Tallies add up.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Rays that ended on the ground.
    pub ground: KindTally,
    /// Rays that ended on what is neither ground nor a track.
    pub structure: KindTally,
    /// Rays that ended on tracks.
    pub tracks: KindTally,
    /// Background returns of another time where a track stands now: not asked.
    pub covered: u64,
    /// Occupied voxels in which held-out rays ended, or which at least 3 of them crossed.
    pub occupied_asked: u64,
    /// Those of them in which none ended.
    pub contradicted: u64,
}

/// What rays of one kind found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KindTally {
    /// Returns in the grid.
    pub returns: u64,
    /// Those with an occupied voxel within the tolerance.
    pub hits: u64,
    /// Those in unobserved voxels.
    pub in_unobserved: u64,
    /// Crossings of voxels more than one voxel away from any held-out return.
    pub crossings: u64,
    /// Those of occupied voxels.
    pub crossings_of_occupied: u64,
    /// Those of unobserved voxels.
    pub crossings_of_unobserved: u64,
    /// How far from the return the ray meets the first occupied voxel.
    pub depth: DepthErrors,
    /// Rays with a return in the grid that meet no occupied voxel.
    pub meet_nothing: u64,
}

impl Tally {
    pub(super) fn of_mut(&mut self, kind: Kind) -> &mut KindTally {
        match kind {
            Kind::Ground => &mut self.ground,
            Kind::Structure => &mut self.structure,
            Kind::Track => &mut self.tracks,
        }
    }

    /// Returns in the grid that were asked.
    pub fn returns(&self) -> u64 {
        self.ground.returns + self.structure.returns + self.tracks.returns
    }

    /// Returns in unobserved voxels.
    pub fn in_unobserved(&self) -> u64 {
        self.ground.in_unobserved + self.structure.in_unobserved + self.tracks.in_unobserved
    }
}

impl std::ops::AddAssign<&Self> for Tally {
    fn add_assign(&mut self, other: &Self) {
        self.ground += &other.ground;
        self.structure += &other.structure;
        self.tracks += &other.tracks;
        self.covered += other.covered;
        self.occupied_asked += other.occupied_asked;
        self.contradicted += other.contradicted;
    }
}

impl std::ops::AddAssign<&Self> for KindTally {
    fn add_assign(&mut self, other: &Self) {
        self.returns += other.returns;
        self.hits += other.hits;
        self.in_unobserved += other.in_unobserved;
        self.crossings += other.crossings;
        self.crossings_of_occupied += other.crossings_of_occupied;
        self.crossings_of_unobserved += other.crossings_of_unobserved;
        self.depth += &other.depth;
        self.meet_nothing += other.meet_nothing;
    }
}
