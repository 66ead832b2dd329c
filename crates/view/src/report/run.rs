//! A run as its page tells it.

use super::totals::VoxelTotals;

/// All that is known of a run. Any part may be empty: other people's labels come without a report.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// What it is called: the name of its folder.
    pub name: String,
    /// The classes in order of their indices.
    pub classes: Vec<RunClass>,
    /// The scenes by name.
    pub scenes: Vec<RunScene>,
    /// What, by whom, of what, how long: names and values in the order in which they are told.
    pub facts: Vec<(String, String)>,
    /// The configuration as text.
    pub config: Option<String>,
    /// Seconds by stage, summed over threads.
    pub stages: Vec<(String, f64)>,
    /// Points dropped by reason.
    pub drops: Vec<(String, u64)>,
    /// What was odd or lost.
    pub remarks: Vec<Remark>,
    /// How right the labels are, where that was measured.
    pub quality: Vec<QualityTable>,
    /// What a reader has to know of this page.
    pub notes: Vec<String>,
}

/// A class and its colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunClass {
    /// Its name.
    pub name: String,
    /// Red, green, blue.
    pub color: [u8; 3],
}

/// A scene of a run.
#[derive(Clone, Debug, Default)]
pub struct RunScene {
    /// Its name.
    pub name: String,
    /// Those that could be read, in order of time.
    pub keyframes: Vec<RunKeyframe>,
    /// Those that could not: token, and why.
    pub unreadable: Vec<(String, String)>,
    /// Seconds of all stages, if the report tells.
    pub seconds: Option<f64>,
}

/// A keyframe of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunKeyframe {
    /// Its name.
    pub token: String,
    /// What its voxels are.
    pub totals: VoxelTotals,
}

/// Something odd or lost.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Remark {
    /// Whether something was skipped or degraded.
    pub is_loss: bool,
    /// The rule that was broken.
    pub rule: String,
    /// The scene, if it is one's.
    pub scene: String,
    /// Where, what was expected, what was found.
    pub text: String,
}

/// How right labels are, by one way to measure.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct QualityTable {
    /// What was measured, against what.
    pub title: String,
    /// The heads of its columns, the figure's first.
    pub columns: Vec<String>,
    /// A figure a row.
    pub rows: Vec<Vec<String>>,
}

/// A keyframe drawn small.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thumbnail {
    /// Of which keyframe.
    pub at: super::KeyframeAt,
    /// Its bytes.
    pub png: Vec<u8>,
}

impl RunScene {
    /// What the voxels of all its keyframes are.
    pub(super) fn totals(&self) -> VoxelTotals {
        let mut sum = VoxelTotals::default();
        self.keyframes.iter().for_each(|keyframe| sum += &keyframe.totals);
        sum
    }
}

impl Run {
    /// What the voxels of all keyframes are.
    pub(super) fn totals(&self) -> VoxelTotals {
        let mut sum = VoxelTotals::default();
        self.scenes.iter().for_each(|scene| sum += &scene.totals());
        sum
    }

    /// How many keyframes could be read.
    pub(super) fn keyframes(&self) -> usize {
        self.scenes.iter().map(|scene| scene.keyframes.len()).sum()
    }

    /// What was odd or lost of a scene.
    pub(super) fn remarks_of(&self, scene: &str) -> impl Iterator<Item = &Remark> {
        self.remarks.iter().filter(move |remark| remark.scene == scene)
    }
}
