//! What log to write.

use crate::lidar::LidarPattern;
use std::ops::Range;

/// Keyframes come at 2 Hz, as in nuScenes.
const KEYFRAME_PERIOD_US: i64 = 500_000;

/// The parameters of a log. The log is a function of them and of nothing else.
#[derive(Clone, Debug, PartialEq)]
pub struct LogSpec {
    /// Number of scenes; each drives down the same street, past oncoming cars of other speeds.
    pub scenes: usize,
    /// Keyframes per scene, half a second apart.
    pub keyframes: usize,
    /// Sweeps from one keyframe to the next, one of the two key sweeps counted.
    pub sweeps_per_keyframe: usize,
    /// Sweeps before the first keyframe, at the same pace.
    pub lead_in_sweeps: usize,
    /// The lidar.
    pub lidar: LidarPattern,
    /// Speed of the ego.
    pub ego_speed_mps: f64,
    /// Whether there are six cameras (rows only, no images are ever written).
    pub cameras: bool,
    /// Whether key sweeps have point labels.
    pub labels: bool,
    /// Whether there are box annotations.
    pub boxes: bool,
    /// The scenes whose point and label files are written; of the others there are table rows only.
    pub point_scenes: Range<usize>,
    /// Number of annotations in all, spread evenly over the scenes; people out of sight are added
    /// as needed. Otherwise every track of the street is annotated at every keyframe.
    pub annotations: Option<usize>,
}

/// The place of one sweep in its scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SweepSlot {
    /// The keyframe it belongs to: its own, or the one that follows.
    pub(crate) keyframe: usize,
    /// Whether it is that keyframe's own.
    pub(crate) is_key: bool,
    /// Its time after the scene's first keyframe.
    pub(crate) offset_us: i64,
}

impl SweepSlot {
    /// Its time after the scene's first keyframe, in seconds.
    pub(crate) fn time_s(&self) -> f64 {
        self.offset_us as f64 / 1e6
    }
}

impl LogSpec {
    /// A log of a few hundred kilobytes: 3 keyframes, 9 sweeps of about 1,340 points.
    pub fn nano() -> Self {
        Self {
            scenes: 1,
            keyframes: 3,
            sweeps_per_keyframe: 4,
            lead_in_sweeps: 0,
            lidar: LidarPattern { beams: 16, azimuths: 90, max_range_m: 70.0 },
            ego_speed_mps: 6.0,
            cameras: true,
            labels: true,
            boxes: true,
            point_scenes: 0..1,
            annotations: None,
        }
    }

    /// A scene as large as one of nuScenes: 40 keyframes, 400 sweeps of 34,688 rays (about 33,000
    /// returns).
    pub fn full() -> Self {
        Self {
            keyframes: 40,
            sweeps_per_keyframe: 10,
            lead_in_sweeps: 9,
            lidar: LidarPattern { beams: 32, azimuths: 1084, max_range_m: 150.0 },
            ..Self::nano()
        }
    }

    /// Tables as large as those of nuScenes' trainval: 850 scenes, 34,000 samples, 1.2 million
    /// annotations. One scene in the middle, of nano's sweeps, has its points too.
    pub fn tables() -> Self {
        Self {
            scenes: 850,
            keyframes: 40,
            sweeps_per_keyframe: 10,
            point_scenes: 425..426,
            annotations: Some(1_200_000),
            ..Self::nano()
        }
    }

    /// The same log with another number of scenes: all with points if all had them, otherwise the
    /// middle one.
    pub fn with_scenes(self, scenes: usize) -> Self {
        let all = self.point_scenes == (0..self.scenes);
        let point_scenes = if all { 0..scenes } else { scenes / 2..scenes / 2 + 1 };
        Self { scenes, point_scenes, ..self }
    }

    /// The sweeps of a scene, in the order of time.
    pub(crate) fn sweep_slots(&self) -> impl Iterator<Item = SweepSlot> {
        let pace = self.sweeps_per_keyframe as i64;
        let end = (self.keyframes as i64 - 1) * pace;
        (-(self.lead_in_sweeps as i64)..=end).map(move |step| SweepSlot {
            keyframe: (step.max(0) as usize).div_ceil(pace as usize),
            is_key: step >= 0 && step % pace == 0,
            offset_us: step * KEYFRAME_PERIOD_US / pace,
        })
    }

    /// How many annotations a scene has, given the tracks of its street.
    pub(crate) fn annotations_of(&self, scene: usize, track_count: usize) -> usize {
        match self.annotations {
            _ if !self.boxes => 0,
            None => self.keyframes * track_count,
            Some(all) => all * (scene + 1) / self.scenes - all * scene / self.scenes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_has_400_sweeps_at_20_hz() {
        let slots: Vec<_> = LogSpec::full().sweep_slots().collect();
        assert_eq!(slots.len(), 400);
        assert_eq!(slots.iter().filter(|slot| slot.is_key).count(), 40);
        assert!(slots.windows(2).all(|pair| pair[1].offset_us - pair[0].offset_us == 50_000));
        assert_eq!((slots[0].keyframe, slots[0].offset_us), (0, -450_000));
    }

    #[test]
    fn a_sweep_belongs_to_the_keyframe_that_follows() {
        let keyframes: Vec<_> = LogSpec::nano().sweep_slots().map(|slot| slot.keyframe).collect();
        assert_eq!(keyframes, [0, 1, 1, 1, 1, 2, 2, 2, 2]);
    }

    #[test]
    fn annotations_add_up() {
        let spec = LogSpec::tables();
        let all: usize = (0..spec.scenes).map(|scene| spec.annotations_of(scene, 36)).sum();
        assert_eq!(all, 1_200_000);
    }
}
