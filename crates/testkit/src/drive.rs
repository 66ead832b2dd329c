//! One scene: a drive down the street, and what its rows and files are called.

use crate::log_spec::{LogSpec, SweepSlot};
use crate::nuscenes_log::VERSION;
use crate::pose::Pose;
use crate::rig::{Camera, world_from_ego};
use crate::shared_rows::LIDAR;
use crate::street::Street;
use crate::token::{row_key, token};

/// The time of the first keyframe of the first scene.
const START_US: i64 = 1_600_000_000_000_000;
/// From one scene's first keyframe to the next one's.
const SCENE_PERIOD_US: i64 = 60_000_000;

/// One scene of a log.
pub(crate) struct Drive<'a> {
    pub(crate) spec: &'a LogSpec,
    pub(crate) number: usize,
    pub(crate) street: Street,
    pub(crate) slots: Vec<SweepSlot>,
    pub(crate) annotation_count: usize,
}

impl<'a> Drive<'a> {
    pub(crate) fn new(spec: &'a LogSpec, number: usize) -> Self {
        let street = Street::new(number);
        let annotation_count = spec.annotations_of(number, street.tracks.len());
        let street = street.with_crowd(annotation_count.div_ceil(spec.keyframes));
        Self { spec, number, street, slots: spec.sweep_slots().collect(), annotation_count }
    }

    /// A row's token; lanes number the sensors or tracks, steps their rows.
    pub(crate) fn token(&self, table: &str, lane: usize, step: usize) -> String {
        token(table, row_key(self.number, lane, step))
    }

    /// The tokens before and after a row in its chain of `length`, empty at the ends.
    pub(crate) fn neighbours(
        &self,
        table: &str,
        lane: usize,
        step: usize,
        length: usize,
    ) -> [String; 2] {
        let before = step.checked_sub(1);
        let after = Some(step + 1).filter(|&next| next < length);
        [before, after]
            .map(|other| other.map(|step| self.token(table, lane, step)).unwrap_or_default())
    }

    pub(crate) fn logfile(&self) -> String {
        format!("sim-{:04}", self.number + 1)
    }

    /// A time of the log, from one after the scene's first keyframe.
    pub(crate) fn timestamp_us(&self, offset_us: i64) -> i64 {
        START_US + self.number as i64 * SCENE_PERIOD_US + offset_us
    }

    pub(crate) fn world_from_ego(&self, offset_us: i64) -> Pose {
        world_from_ego(self.spec.ego_speed_mps, offset_us as f64 / 1e6)
    }

    /// The key sweeps with their places among all sweeps, one for each keyframe.
    pub(crate) fn key_slots(&self) -> impl Iterator<Item = (usize, &SweepSlot)> {
        self.slots.iter().enumerate().filter(|(_, slot)| slot.is_key)
    }

    pub(crate) fn cloud_file(&self, slot: &SweepSlot) -> String {
        let folder = if slot.is_key { "samples" } else { "sweeps" };
        let (logfile, time) = (self.logfile(), self.timestamp_us(slot.offset_us));
        format!("{folder}/{LIDAR}/{logfile}__{LIDAR}__{time}.pcd.bin")
    }

    /// The label file of a key sweep, by its place among all sweeps.
    pub(crate) fn label_file(&self, sweep: usize) -> String {
        format!("lidarseg/{VERSION}/{}_lidarseg.bin", self.token("sample_data", 0, sweep))
    }

    pub(crate) fn image_file(&self, camera: &Camera, offset_us: i64) -> String {
        let (logfile, time) = (self.logfile(), self.timestamp_us(offset_us));
        format!("samples/{0}/{logfile}__{0}__{time}.jpg", camera.channel)
    }
}
