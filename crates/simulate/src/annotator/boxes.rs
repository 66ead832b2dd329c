//! The boxes that the annotator draws.

use nalgebra::{Translation3, Vector3};
use occlabel_core::{Box3, BoxTrack, Fault, Meaning, Pose, Taxonomy, Timestamp, TrackId};

use crate::World;
use crate::annotator::{LoggedPoses, Sightings, Unboxed};
use crate::check::unknown;
use crate::noise::{Chance, Kind};
use crate::rotation::yaw_pitch_roll;
use crate::schedule::SweepKey;

/// What the annotator draws from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Boxes<'a> {
    pub(crate) world: &'a World,
    pub(crate) poses: &'a LoggedPoses,
    pub(crate) sightings: &'a Sightings,
    /// The reference sweeps of the keyframes.
    pub(crate) keyframes: &'a [SweepKey],
}

impl Boxes<'_> {
    /// The tracks of all movers that have a box, in byte order of their names, numbered from 1.
    pub(crate) fn tracks(&self, taxonomy: &Taxonomy) -> Result<Vec<BoxTrack>, Fault> {
        let mut tracks = Vec::new();
        for (at, mover) in self.world.movers.iter().enumerate() {
            let meaning = meaning(taxonomy, &mover.name, &mover.category)?;
            let boxes: Vec<_> = if self.is_unboxed(at) {
                Vec::new()
            } else {
                self.keyframes.iter().filter_map(|key| self.annotated(key, at)).collect()
            };
            if !boxes.is_empty() {
                tracks.push(BoxTrack {
                    id: TrackId(tracks.len() as u16 + 1),
                    source_id: mover.name.clone(),
                    category: mover.category.clone(),
                    meaning,
                    boxes,
                });
            }
        }
        Ok(tracks)
    }

    fn is_unboxed(&self, mover: usize) -> bool {
        match &self.world.annotator.unlabelled_movers {
            Unboxed::Named(names) => names.contains(&self.world.movers[mover].name),
            Unboxed::Share(share) => {
                Chance::of(self.world.seed, Kind::Mover, mover, 0).uniform(0) < *share
            }
        }
    }

    /// A mover's box at a keyframe, unless it is missing there.
    ///
    /// It is drawn around what the reference lidar sees, so it stands in the log's world, drift and
    /// miscalibration included.
    fn annotated(&self, key: &SweepKey, mover: usize) -> Option<(Timestamp, Box3)> {
        let annotator = &self.world.annotator;
        let chance = Chance::of(self.world.seed, Kind::Box, mover, key.number);
        let drawn = chance.uniform(0) >= annotator.missing_boxes
            && self.sightings.has(key.time, mover, annotator.min_points);
        drawn.then(|| {
            let time_s = self.sightings.box_time(key.time, mover).seconds_since(Timestamp(0));
            let exact = self.world.movers[mover].box_at(time_s, &self.world.ground);
            let logged = self.poses.logged_from_true(self.world, key.lidar, key.time);
            (key.time, self.jittered(&exact, &logged, &chance))
        })
    }

    fn jittered(&self, exact: &Box3, logged_from_true: &Pose, chance: &Chance) -> Box3 {
        let annotator = &self.world.annotator;
        let normals = |first| Vector3::from_fn(|axis, _| chance.normal_of(first + axis as u64));
        let moved = Translation3::from(normals(0) * annotator.jitter_m);
        let turned = yaw_pitch_roll(chance.normal_of(3) * annotator.jitter_yaw_rad, 0.0, 0.0);
        let size_m = exact.size_m + normals(4) * annotator.jitter_size_m;
        Box3 {
            world_from_box: logged_from_true * exact.world_from_box * moved * turned,
            size_m: size_m.sup(&(exact.size_m / 2.0)),
        }
    }
}

fn meaning(taxonomy: &Taxonomy, mover: &str, category: &str) -> Result<Meaning, Fault> {
    let key = format!("mover {mover}.category");
    let known = taxonomy.boxes.get(category).copied();
    let names = taxonomy.boxes.keys();
    known.ok_or_else(|| unknown(&key, "a box category of the taxonomy", names, category))
}
