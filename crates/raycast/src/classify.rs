//! The verdict on each voxel (labels.md section 9).

use occlabel_core::{ClassSet, RayCounts, VoxelGrid, VoxelState, VoxelVote};
use serde::{Deserialize, Serialize};

use crate::Crossings;

/// The `[states]` table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateSettings {
    /// A voxel with at least so many points is occupied.
    pub occupied_min_hits: u32,
    /// Else one with at least so many crossings is free.
    pub free_min_crossings: u32,
    /// What to believe where a voxel was both hit and crossed.
    pub conflict: Conflict,
    /// Under `ratio`: the least share of hits in hits and crossings that an occupied voxel needs.
    pub min_hit_ratio: f64,
}

impl StateSettings {
    /// What must be kept of the crossings to judge by these settings.
    pub fn crossings(&self) -> Crossings {
        match self.conflict {
            Conflict::OccupiedWins if self.free_min_crossings <= 1 => Crossings::Whether,
            _ => Crossings::HowMany,
        }
    }
}

/// What to believe where a voxel was both hit and crossed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Conflict {
    /// The hits.
    OccupiedWins,
    /// The hits, if they are a fair share of the evidence.
    Ratio,
}

/// Judges each voxel by its counts.
///
/// # Panics
/// If the grids differ in shape.
pub fn classify(
    counts: &RayCounts,
    votes: &VoxelGrid<Option<VoxelVote>>,
    flat: &ClassSet,
    settings: &StateSettings,
) -> VoxelGrid<VoxelState> {
    assert_eq!(counts.hits.shape(), votes.shape(), "grids of one shape");
    let mut hits = counts.hits.values().iter();
    counts.crossings.zip_map(votes, |&crossings, vote| {
        let hits = *hits.next().expect("as many hits as votes");
        judge(hits, crossings, vote.as_ref(), flat, settings)
    })
}

fn judge(
    hits: u32,
    crossings: u32,
    vote: Option<&VoxelVote>,
    flat: &ClassSet,
    settings: &StateSettings,
) -> VoxelState {
    let is_hit = hits >= settings.occupied_min_hits
        && vote.is_some_and(|vote| !is_contradicted(hits, crossings, vote, flat, settings));
    if is_hit {
        VoxelState::Occupied
    } else if crossings >= settings.free_min_crossings {
        VoxelState::Free
    } else {
        VoxelState::Unobserved
    }
}

/// Whether too many rays went through what was hit. Never so for the ground, which rays graze, nor
/// for tracks, whose boxes vouch for them.
fn is_contradicted(
    hits: u32,
    crossings: u32,
    vote: &VoxelVote,
    flat: &ClassSet,
    settings: &StateSettings,
) -> bool {
    let ratio = f64::from(hits) / (f64::from(hits) + f64::from(crossings));
    settings.conflict == Conflict::Ratio
        && !flat.contains(vote.class)
        && vote.instance.is_none()
        && ratio < settings.min_hit_ratio
}

#[cfg(test)]
mod tests {
    use super::*;
    use occlabel_core::{ClassId, TrackId};

    const ROAD: ClassId = ClassId(11);
    const POLE: ClassId = ClassId(15);

    fn settings(conflict: Conflict) -> StateSettings {
        StateSettings { occupied_min_hits: 2, free_min_crossings: 3, conflict, min_hit_ratio: 0.25 }
    }

    fn state(
        hits: u32,
        crossings: u32,
        class: ClassId,
        instance: u16,
        conflict: Conflict,
    ) -> VoxelState {
        let instance = (instance > 0).then_some(TrackId(instance));
        let vote = (hits > 0).then_some(VoxelVote { class, instance });
        let flat = [ROAD].into_iter().collect();
        judge(hits, crossings, vote.as_ref(), &flat, &settings(conflict))
    }

    #[test]
    fn section_9_hits_then_crossings_then_nothing() {
        let judged = |hits, crossings| state(hits, crossings, POLE, 0, Conflict::OccupiedWins);
        assert_eq!(judged(2, 99), VoxelState::Occupied);
        assert_eq!(judged(1, 3), VoxelState::Free);
        assert_eq!(judged(1, 2), VoxelState::Unobserved);
        assert_eq!(judged(0, 0), VoxelState::Unobserved);
    }

    #[test]
    fn section_9_ratio_lets_crossings_judge_what_they_contradict() {
        assert_eq!(state(2, 6, POLE, 0, Conflict::Ratio), VoxelState::Occupied, "0.25 is enough");
        assert_eq!(state(2, 7, POLE, 0, Conflict::Ratio), VoxelState::Free);
        assert_eq!(state(2, 99, ROAD, 0, Conflict::Ratio), VoxelState::Occupied, "flat");
        assert_eq!(state(2, 99, POLE, 4, Conflict::Ratio), VoxelState::Occupied, "a track");
    }

    #[test]
    fn section_9_a_threshold_of_zero_does_not_invent_a_class() {
        let none = StateSettings { occupied_min_hits: 0, ..settings(Conflict::OccupiedWins) };
        assert_eq!(judge(0, 9, None, &ClassSet::default(), &none), VoxelState::Free);
    }
}
