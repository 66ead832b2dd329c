//! The drive and a preset, and what the stages make of them.

use std::convert::Infallible;

use nalgebra::Point3;
use occlabel_aggregate::{Moment, TrackBox, compose};
use occlabel_annotate::{BoxSource, box_at, relabel};
use occlabel_core::{AggregatedScene, BoxTrack, ClassId, Instant, Keyframe, SweepHeader};
use occlabel_pipeline::{
    Autos, Config, Rules, parse_taxonomy, preset, shipped_taxonomy, sort_scene,
};

use crate::drive::Drive;

/// The taxonomy of the drive.
const TAXONOMY: &str = "occ3d-nuscenes";

/// The drive, and the rules of a preset.
pub(crate) struct Prepared {
    pub(crate) drive: Drive,
    pub(crate) rules: Rules,
}

impl Prepared {
    pub(crate) fn new(preset: &str) -> Self {
        let rules = rules(preset);
        Self { drive: Drive::new(&rules.taxonomy), rules }
    }

    /// The keyframe that is labelled.
    pub(crate) fn keyframe(&self) -> &Keyframe {
        &self.drive.scene.keyframes[1]
    }

    /// The scene, sorted.
    pub(crate) fn sorted(&self) -> AggregatedScene<Option<ClassId>> {
        let read = |header: &SweepHeader| -> Result<_, Infallible> {
            let at: usize = header.file.parse().expect("the file is the index");
            Ok(Some(self.drive.clouds[at].clone()))
        };
        let Ok(sorted) = sort_scene(&self.drive.scene, &self.rules, read);
        sorted
    }

    /// The scene, sorted and relabelled.
    pub(crate) fn aggregated(&self) -> AggregatedScene<ClassId> {
        relabel(self.sorted(), &self.rules.relabel(&self.drive.scene))
    }

    /// The instant of the keyframe.
    pub(crate) fn instant<'a>(&self, aggregated: &'a AggregatedScene<ClassId>) -> Instant<'a> {
        let reference = self.drive.scene.reference_sweep(self.keyframe());
        let grid_from_world = self.rules.world_from_grid(reference).inverse();
        let standing: Vec<_> =
            self.drive.scene.tracks.iter().filter_map(|track| self.standing(track)).collect();
        let moment = Moment {
            time: self.keyframe().time,
            grid_from_world,
            ego: reference.world_from_ego * Point3::origin(),
            reference_lidar: grid_from_world * reference.world_from_lidar() * Point3::origin(),
            standing: &standing,
        };
        compose(aggregated, &moment, &self.rules.window)
    }

    /// A track's box at the keyframe.
    fn standing(&self, track: &BoxTrack) -> Option<TrackBox> {
        let (boxed, source) = box_at(track, self.keyframe().time, &self.rules.boxes)?;
        let stands = source != BoxSource::Extrapolated;
        stands.then(|| TrackBox { track: track.id, class: track.class(), boxed })
    }
}

fn rules(name: &str) -> Rules {
    let text = preset(name).expect("a shipped preset");
    let mut config = Config::from_layers(name, text, None, &[]).expect("a shipped preset");
    let autos = Autos { ego_box_m: None, taxonomy: TAXONOMY.into(), reference_lidar: "TOP".into() };
    let text = shipped_taxonomy(TAXONOMY).expect("a shipped taxonomy");
    let taxonomy = parse_taxonomy(text, TAXONOMY).expect("a shipped taxonomy");
    config.resolve(&autos, &taxonomy);
    Rules::new(&config, taxonomy.into()).expect("rules of a shipped preset")
}
