//! A scene's tracks, from boxes that come one by one.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use occlabel_core::{Box3, BoxTrack, Fault, Loss, Timestamp, TrackId};

use crate::ReadOptions;
use crate::notes::Notes;

/// The rule of a category that the taxonomy does not name.
pub(crate) const UNKNOWN_CATEGORY: &str = "unknown-category";

/// The boxes of a scene by the source's ids of their tracks.
#[derive(Debug, Default)]
pub(crate) struct TrackBoxes {
    by_id: BTreeMap<String, Boxes>,
}

#[derive(Debug)]
struct Boxes {
    category: String,
    boxes: BTreeMap<Timestamp, Box3>,
}

/// A box as a log has it, placed in world.
pub(crate) struct TrackBox<'a> {
    pub(crate) track: &'a str,
    pub(crate) category: &'a str,
    pub(crate) time: Timestamp,
    pub(crate) boxed: Box3,
}

impl TrackBoxes {
    /// Adds a box; one of another category than its track's is refused. `fault` makes a fault at
    /// the box's record of a rule, what was expected and what was found.
    ///
    /// # Errors
    /// If the track already has a box at that time.
    pub(crate) fn add(
        &mut self,
        row: TrackBox<'_>,
        notes: &mut Notes,
        fault: impl Fn(&'static str, String, String) -> Fault,
    ) -> Result<(), Fault> {
        let empty = || Boxes { category: row.category.to_owned(), boxes: BTreeMap::new() };
        let track = self.by_id.entry(row.track.to_owned()).or_insert_with(empty);
        if track.category != row.category {
            let expected = format!("category `{}` of track `{}`", track.category, row.track);
            let found = format!("`{}`", row.category);
            notes.refuse(Loss::Annotation, fault("track-category", expected, found));
        } else if track.boxes.insert(row.time, row.boxed).is_some() {
            let found = format!("two of `{}`", row.track);
            return Err(fault("track-time", "one box of a track at a time".into(), found));
        }
        Ok(())
    }

    /// The box of a track at a time.
    pub(crate) fn at(&self, track: &str, time: Timestamp) -> Option<&Box3> {
        self.by_id.get(track)?.boxes.get(&time)
    }

    /// The tracks, 1..N in byte order of their ids; those of a category that means nothing are left
    /// out. Faults name `file`.
    ///
    /// # Errors
    /// If a category is unknown, or there are more than 65535 tracks.
    pub(crate) fn tracks(
        self,
        options: &ReadOptions,
        file: &str,
        notes: &mut Notes,
    ) -> Result<Vec<BoxTrack>, Fault> {
        self.check_categories(options, file, notes)?;
        let mut tracks = Vec::with_capacity(self.by_id.len());
        for (source_id, Boxes { category, boxes }) in self.by_id {
            let id = TrackId(track_number(tracks.len() + 1, file)?);
            let Some(meaning) = options.box_meaning(&category) else { continue };
            let boxes = boxes.into_iter().collect();
            tracks.push(BoxTrack { id, source_id, category, meaning, boxes });
        }
        Ok(tracks)
    }

    /// Refuses or notes the categories that the taxonomy does not name, with how many boxes are
    /// theirs.
    fn check_categories(
        &self,
        options: &ReadOptions,
        file: &str,
        notes: &mut Notes,
    ) -> Result<(), Fault> {
        let mut unknown: BTreeMap<&str, usize> = BTreeMap::new();
        for Boxes { category, boxes } in self.by_id.values() {
            if !options.taxonomy.boxes.contains_key(category) {
                *unknown.entry(category).or_default() += boxes.len();
            }
        }
        if unknown.is_empty() {
            return Ok(());
        }
        let list = |(name, count): (&&str, &usize)| format!("`{name}` of {count} boxes");
        let found = unknown.iter().map(list).collect::<Vec<_>>().join(", ");
        let fault = Fault::new(UNKNOWN_CATEGORY, file, "categories of the taxonomy", found);
        notes.warn(options.unknown(fault)?);
        Ok(())
    }
}

/// A box's length, width and height, or what was found instead.
///
/// # Errors
/// If a side is not above 0 or not finite.
pub(crate) fn checked_size(size_m: Vector3<f64>) -> Result<Vector3<f64>, String> {
    match size_m.iter().all(|side| side.is_finite() && *side > 0.0) {
        true => Ok(size_m),
        false => Err(format!("{} x {} x {} m", size_m.x, size_m.y, size_m.z)),
    }
}

/// What `checked_size` expects.
pub(crate) const A_SIZE: &str = "length, width and height above 0";

fn track_number(number: usize, file: &str) -> Result<u16, Fault> {
    u16::try_from(number).map_err(|_| {
        let expected = format!("at most {} tracks in a scene", u16::MAX);
        Fault::new("track-count", file, expected, "more")
    })
}
