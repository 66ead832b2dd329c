//! The tracks of a scene: `tracks.json`.

use std::path::Path;

use occlabel_core::{Box3, BoxTrack, Fault, Loss, Timestamp, TrackId};
use serde::Deserialize;

use super::json::{A_PLACEMENT, Placement, read_json};
use crate::ReadOptions;
use crate::notes::Notes;
use crate::tracks::{A_SIZE, TrackBox, TrackBoxes, checked_size};

/// A track of the file.
#[derive(Clone, Debug, Deserialize)]
struct TrackRow {
    id: String,
    category: String,
    boxes: Vec<BoxRow>,
}

/// A box of a track: its centre and turn in world, its length, width and height.
#[derive(Clone, Debug, Deserialize)]
struct BoxRow {
    time_ns: i64,
    #[serde(flatten)]
    placement: Placement,
    size: [f64; 3],
}

/// A scene's tracks, and which of them each row of the file became: files of points name tracks by rows.
#[derive(Clone, Debug, Default)]
pub(super) struct SceneTracks {
    pub(super) tracks: Vec<BoxTrack>,
    pub(super) by_row: Vec<Option<TrackId>>,
}

impl SceneTracks {
    /// Reads the tracks. A box that cannot be used is refused.
    ///
    /// # Errors
    /// If the file is no list of tracks, a track has two boxes at a time, or a category is unknown.
    pub(super) fn read(
        root: &Path,
        file: &str,
        options: &ReadOptions,
        notes: &mut Notes,
    ) -> Result<Self, Fault> {
        let rows: Vec<TrackRow> = read_json(root, file)?;
        let mut boxes = TrackBoxes::default();
        for track in &rows {
            for row in &track.boxes {
                let fault = |rule, expected: String, found: String| {
                    Fault::new(rule, file, expected, found).record(&track.id)
                };
                let Some(boxed) = notes.accept(Loss::Annotation, row.boxed(&fault)) else {
                    continue;
                };
                let (id, category) = (&track.id, &track.category);
                let time = Timestamp(row.time_ns);
                boxes.add(TrackBox { track: id, category, time, boxed }, notes, fault)?;
            }
        }
        let tracks = boxes.tracks(options, file, notes)?;
        let id = |row: &TrackRow| id_of(&tracks, &row.id);
        let by_row = rows.iter().map(id).collect();
        Ok(Self { tracks, by_row })
    }
}

/// The track of a name.
pub(super) fn id_of(tracks: &[BoxTrack], source_id: &str) -> Option<TrackId> {
    tracks.iter().find(|track| track.source_id == source_id).map(|track| track.id)
}

impl BoxRow {
    fn boxed(&self, fault: &impl Fn(&'static str, String, String) -> Fault) -> Result<Box3, Fault> {
        let world_from_box = self.placement.pose();
        let size_m = checked_size(self.size.into());
        Ok(Box3 {
            world_from_box: world_from_box
                .map_err(|found| fault("box-pose", A_PLACEMENT.into(), found))?,
            size_m: size_m.map_err(|found| fault("box-size", A_SIZE.into(), found))?,
        })
    }
}
