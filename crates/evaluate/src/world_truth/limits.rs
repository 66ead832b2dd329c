//! What figures have to reach.

use std::collections::BTreeMap;
use std::fmt;

use occlabel_core::Fault;
use serde::Deserialize;

use super::figures::FIGURES;
use super::quality::Quality;

/// Bounds on the figures over everything, by name, such as a file gives them:
///
/// ```toml
/// [at_least]
/// occupied_precision = 0.995
/// [at_most]
/// trail_rate = 0.001
/// ```
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(try_from = "LimitsFile")]
pub struct Limits {
    at_least: BTreeMap<String, f64>,
    at_most: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LimitsFile {
    #[serde(default)]
    at_least: BTreeMap<String, f64>,
    #[serde(default)]
    at_most: BTreeMap<String, f64>,
}

/// The figures that need denser rays or cameras, and are left out where neither is asked for.
pub const COSTLY_FIGURES: &[&str] =
    &["surface_recall_dense", "mask_camera_iou", "mask_camera_sight_iou", "occupied_camera_iou"];

/// A figure that does not keep its limit, or could not be asked at all.
#[derive(Clone, Debug, PartialEq)]
pub struct Miss {
    /// The figure's name.
    pub figure: String,
    /// What it is; none if there was nothing to ask.
    pub found: Option<f64>,
    /// What it has to be, in words.
    pub expected: String,
}

impl Limits {
    /// Bounds from below and from above.
    ///
    /// # Errors
    /// If a name is no figure's, or a bound is not finite.
    pub fn new(
        at_least: BTreeMap<String, f64>,
        at_most: BTreeMap<String, f64>,
    ) -> Result<Self, Fault> {
        at_least.iter().chain(&at_most).try_for_each(|(name, &bound)| check(name, bound))?;
        Ok(Self { at_least, at_most })
    }

    /// What the preset `precise` has to reach on noise-free worlds: sweeps taken at one instant, no
    /// faults of annotation, 32 beams at 20 Hz for 20 s.
    pub fn precise() -> Self {
        let named = |(name, bound): (&str, f64)| (String::from(name), bound);
        Self {
            at_least: PRECISE_AT_LEAST.into_iter().map(named).collect(),
            at_most: PRECISE_AT_MOST.into_iter().map(named).collect(),
        }
    }

    /// The limits on all but some figures, and the names of those that go.
    pub fn without(mut self, figures: &[&str]) -> (Self, Vec<String>) {
        let mut gone = Vec::new();
        for bounds in [&mut self.at_least, &mut self.at_most] {
            let taken = figures.iter().filter_map(|name| bounds.remove_entry(*name));
            gone.extend(taken.map(|(name, _)| name));
        }
        (self, gone)
    }

    /// The limits that a quality does not keep, in order of name, the lower limits first.
    pub fn misses(&self, quality: &Quality) -> Vec<Miss> {
        let below = self.at_least.iter().filter_map(|(name, &bound)| {
            miss(quality, name, |found| found >= bound, || format!("at least {bound}"))
        });
        let above = self.at_most.iter().filter_map(|(name, &bound)| {
            miss(quality, name, |found| found <= bound, || format!("at most {bound}"))
        });
        below.chain(above).collect()
    }
}

const PRECISE_AT_LEAST: [(&str, f64); 7] = [
    ("occupied_precision", 0.995),
    ("surface_recall", 0.99),
    ("free_purity", 0.999),
    ("free_recall", 0.995),
    ("class_accuracy", 0.99),
    ("mask_lidar_iou", 0.99),
    ("mask_camera_iou", 0.97),
];

const PRECISE_AT_MOST: [(&str, f64); 3] =
    [("occupied_distance_excess_voxels", 0.02), ("trail_rate", 0.001), ("flow_error_mps", 0.05)];

impl TryFrom<LimitsFile> for Limits {
    type Error = Fault;

    fn try_from(file: LimitsFile) -> Result<Self, Fault> {
        Self::new(file.at_least, file.at_most)
    }
}

impl fmt::Display for Miss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.found {
            Some(found) => write!(f, "{}: {found:.6}, expected {}", self.figure, self.expected),
            None => write!(f, "{}: nothing to judge, expected {}", self.figure, self.expected),
        }
    }
}

fn miss(
    quality: &Quality,
    name: &str,
    is_kept: impl Fn(f64) -> bool,
    expected: impl Fn() -> String,
) -> Option<Miss> {
    let found = quality.all.get(name).and_then(|value| value.value);
    let is_missed = !found.is_some_and(is_kept);
    is_missed.then(|| Miss { figure: name.into(), found, expected: expected() })
}

fn check(name: &str, bound: f64) -> Result<(), Fault> {
    if !FIGURES.iter().any(|figure| figure.name == name) {
        let expected = "the name of a figure, as docs/quality.md lists them";
        return Err(Fault::new("limit-name", "limits", expected, format!("`{name}`")));
    }
    if !bound.is_finite() {
        let found = format!("{bound}");
        return Err(Fault::new("limit-bound", "limits", "a finite bound", found).record(name));
    }
    Ok(())
}
