//! Votes, counted for the voxels that get any.

use occlabel_core::{ClassId, GridSpec, TrackId};

/// The votes of all voxels: a dense histogram for each voxel that holds a point, none for the rest.
pub(crate) struct BallotBox {
    classes: usize,
    /// For each voxel the number of its ballot, counted from 1; 0 where there is none.
    ballot_of: Vec<u32>,
    /// For each ballot its voxel.
    voxels: Vec<u32>,
    /// For each ballot its histogram.
    counts: Vec<u32>,
    /// Votes of track points once more, with their tracks.
    track_votes: Vec<TrackVote>,
    /// For each ballot the votes of the track that votes now, and the ballots where it has any.
    now: Vec<u32>,
    now_at: Vec<u32>,
}

/// Votes of one track in one voxel, sorted by voxel, class and track.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct TrackVote {
    ballot: u32,
    pub(crate) class: ClassId,
    pub(crate) track: TrackId,
    pub(crate) count: u32,
}

/// What was counted in one voxel.
pub(crate) struct Ballot<'a> {
    /// The voxel's place in the flat array.
    pub(crate) flat: usize,
    /// Points by class, track points and background together.
    pub(crate) counts: &'a [u32],
    /// Track points by class and track.
    pub(crate) tracks: &'a [TrackVote],
}

impl BallotBox {
    pub(crate) fn new(spec: &GridSpec, classes: usize) -> Self {
        Self {
            classes,
            ballot_of: vec![0; spec.len()],
            voxels: Vec::new(),
            counts: Vec::new(),
            track_votes: Vec::new(),
            now: Vec::new(),
            now_at: Vec::new(),
        }
    }

    /// Counts a point.
    #[inline]
    pub(crate) fn cast(&mut self, flat: usize, class: ClassId) -> u32 {
        let ballot = match self.ballot_of[flat] {
            0 => self.open(flat),
            number => number - 1,
        };
        self.counts[ballot as usize * self.classes + class.index()] += 1;
        ballot
    }

    /// Counts a point of the track that votes now.
    #[inline]
    pub(crate) fn cast_for_track(&mut self, flat: usize, class: ClassId) {
        let ballot = self.cast(flat, class);
        self.note_track(ballot);
    }

    /// Notes that a point that was counted before is one of the track that votes now.
    pub(crate) fn claim_for_track(&mut self, flat: usize) {
        let ballot = self.ballot_of[flat].checked_sub(1).expect("a voxel with a point");
        self.note_track(ballot);
    }

    #[inline]
    fn note_track(&mut self, ballot: u32) {
        let votes = &mut self.now[ballot as usize];
        if *votes == 0 {
            self.now_at.push(ballot);
        }
        *votes += 1;
    }

    /// Puts down the votes of the track that voted, all of one class.
    pub(crate) fn close_track(&mut self, class: ClassId, track: TrackId) {
        for ballot in self.now_at.drain(..) {
            let count = std::mem::take(&mut self.now[ballot as usize]);
            self.track_votes.push(TrackVote { ballot, class, track, count });
        }
    }

    fn open(&mut self, flat: usize) -> u32 {
        let ballot = self.voxels.len() as u32;
        self.voxels.push(flat as u32);
        self.counts.resize(self.counts.len() + self.classes, 0);
        self.now.push(0);
        self.ballot_of[flat] = ballot + 1;
        ballot
    }

    /// Hands every ballot to `decide`.
    pub(crate) fn tally(mut self, mut decide: impl FnMut(Ballot)) {
        self.track_votes.sort_unstable();
        let merged = merge_equal(&self.track_votes);
        let mut tracks = merged.as_slice();
        for (number, counts) in self.counts.chunks_exact(self.classes).enumerate() {
            let own = tracks.iter().take_while(|vote| vote.ballot == number as u32).count();
            let (of_voxel, rest) = tracks.split_at(own);
            tracks = rest;
            decide(Ballot { flat: self.voxels[number] as usize, counts, tracks: of_voxel });
        }
    }
}

fn merge_equal(sorted: &[TrackVote]) -> Vec<TrackVote> {
    sorted
        .chunk_by(|a, b| (a.ballot, a.class, a.track) == (b.ballot, b.class, b.track))
        .map(|same| TrackVote { count: same.iter().map(|vote| vote.count).sum(), ..same[0] })
        .collect()
}
