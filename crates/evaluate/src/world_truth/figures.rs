//! The list of figures: what each is called, means, and is computed from.

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::share::{Share, mean_ratio};
use super::tally::{Counts, Question, Size};

/// What a figure is computed from: counts of a ring, a class, or everything.
#[derive(Clone, Debug, Default)]
pub(crate) struct Basis {
    /// The sum of the counts.
    pub(crate) counts: Counts,
    /// Class accuracy of each class.
    pub(crate) accuracies: Vec<Share>,
    /// Completeness of each object.
    pub(crate) objects: Vec<Share>,
}

/// One figure of the list.
pub(crate) struct Figure {
    /// Its short name in the table.
    pub(crate) code: &'static str,
    /// Its name in JSON and in limits.
    pub(crate) name: &'static str,
    /// What it is, within its group.
    pub(crate) words: &'static str,
    /// The heading that it stands under.
    pub(crate) group: &'static str,
    /// Whether it says something of a single class.
    pub(crate) is_by_class: bool,
    value: fn(&Basis) -> Option<f64>,
    count: fn(&Basis) -> u64,
}

const OCCUPIED: &str = "Voxels labelled occupied";
const SURFACE: &str = "The true surface";
const AIR: &str = "The air";
const MASKS: &str = "Masks, as overlap (IoU)";
const MOTION: &str = "Velocity of movers, m/s";

macro_rules! share {
    ($code:literal, $name:literal, $words:literal, $group:ident, $by_class:literal, $question:ident) => {
        Figure {
            code: $code,
            name: $name,
            words: $words,
            group: $group,
            is_by_class: $by_class,
            value: |basis| basis.counts.share(Question::$question).ratio(),
            count: |basis| basis.counts.share(Question::$question).of,
        }
    };
}

macro_rules! size {
    ($code:literal, $name:literal, $words:literal, $group:ident, $of:ident, $size:ident) => {
        Figure {
            code: $code,
            name: $name,
            words: $words,
            group: $group,
            is_by_class: true,
            value: |basis| basis.counts.size(Size::$size).$of(),
            count: |basis| basis.counts.size(Size::$size).count(),
        }
    };
}

/// All figures, in the order of the table.
#[rustfmt::skip]
pub(crate) const FIGURES: &[Figure] = &[
    share!("A1", "occupied_precision", "a solid reaches into them", OCCUPIED, true, OccupiedPrecision),
    share!("A1n", "occupied_precision_noise", "... or lies within 3 sigma", OCCUPIED, true, OccupiedPrecisionNoise),
    share!("A5", "class_accuracy", "of those right: the true class", OCCUPIED, true, ClassAccuracy),
    Figure {
        code: "A5m",
        name: "class_accuracy_mean",
        words: "... mean over classes",
        group: OCCUPIED,
        is_by_class: false,
        value: |basis| mean_ratio(&basis.accuracies),
        count: |basis| asked(&basis.accuracies),
    },
    share!("A5p", "class_present", "... a class that passes the voxel", OCCUPIED, true, ClassPresent),
    share!("A5h", "class_hit", "... the class most rays met there", OCCUPIED, true, ClassHit),
    size!("A7", "occupied_distance_voxels", "centre to surface, voxels: mean", OCCUPIED, mean, OccupiedDistance),
    size!("A7p", "occupied_distance_p95_voxels", "... 95th percentile", OCCUPIED, percentile_95, OccupiedDistance),
    Figure {
        code: "A7x",
        name: "occupied_distance_excess_voxels",
        words: "... mean above the true surface's",
        group: OCCUPIED,
        is_by_class: true,
        value: distance_excess,
        count: |basis| basis.counts.size(Size::OccupiedDistance).count(),
    },
    share!("PI", "people_iou", "people: overlap of label and truth", OCCUPIED, false, People),
    share!("A2", "surface_recall", "5 rays end there: is occupied", SURFACE, true, SurfaceRecall),
    share!("A2d", "surface_recall_dense", "... of a 4 times denser pattern", SURFACE, true, SurfaceRecallDense),
    Figure {
        code: "A9",
        name: "object_completeness",
        words: "objects' seen voxels: mean recall",
        group: SURFACE,
        is_by_class: true,
        value: |basis| mean_ratio(&basis.objects),
        count: |basis| asked(&basis.objects),
    },
    Figure {
        code: "A9w",
        name: "object_completeness_worst",
        words: "... of the worst object",
        group: SURFACE,
        is_by_class: true,
        value: |basis| basis.objects.iter().filter_map(|share| share.ratio()).reduce(f64::min),
        count: |basis| asked(&basis.objects),
    },
    size!("A7s", "surface_distance_voxels", "centre to surface, voxels: mean", SURFACE, mean, SurfaceDistance),
    size!("A7sp", "surface_distance_p95_voxels", "... 95th percentile", SURFACE, percentile_95, SurfaceDistance),
    share!("A3", "free_purity", "labelled free: under 5 % solid", AIR, false, FreePurity),
    share!("A3s", "free_purity_strict", "... nothing solid at all", AIR, false, FreePurityStrict),
    share!("A4", "free_recall", "empty and crossed: labelled free", AIR, false, FreeRecall),
    share!("A8", "trail_rate", "swept by movers: labelled occupied", AIR, false, TrailRate),
    share!("A6", "mask_lidar_iou", "lidar, with exact visibility", MASKS, false, MaskLidar),
    share!("A6c", "mask_camera_iou", "cameras, the rule on exact voxels", MASKS, false, MaskCamera),
    share!("A6g", "mask_camera_sight_iou", "cameras, true lines of sight", MASKS, false, MaskCameraSight),
    share!("A10", "occupied_camera_iou", "occupied, where cameras look", MASKS, false, OccupiedCamera),
    size!("FE", "flow_error_mps", "end-point error: mean", MOTION, mean, FlowError),
    size!("FEp", "flow_error_p95_mps", "... 95th percentile", MOTION, percentile_95, FlowError),
    size!("FEc", "flow_error_right_class_mps", "... mean where the class is right", MOTION, mean, FlowErrorRightClass),
    share!("FEn", "flow_missing", "truth has one, the label has not", MOTION, true, FlowMissing),
    share!("FEs", "static_flow", "stands still, labelled as moving", MOTION, true, StaticFlow),
    size!("PV", "people_speed_error_mps", "people: mean velocity in x, y", MOTION, mean, PeopleSpeedError),
];

fn asked(shares: &[Share]) -> u64 {
    shares.iter().filter(|share| share.of > 0).count() as u64
}

fn distance_excess(basis: &Basis) -> Option<f64> {
    let mean = |size| basis.counts.size(size).mean();
    Some(mean(Size::OccupiedDistance)? - mean(Size::SurfaceDistance)?)
}

/// A figure's value, and how many voxels (or objects, or classes) it rests on.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Value {
    /// The figure; none if nothing could be asked.
    pub value: Option<f64>,
    /// The ratio's denominator, or the number of things the mean or percentile is of.
    pub count: u64,
}

/// Every figure of a ring, a class, or everything, by its name in `docs/quality.md`.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures(Vec<(&'static str, Value)>);

impl Figures {
    /// All figures.
    pub(crate) fn of(basis: &Basis) -> Self {
        Self(FIGURES.iter().map(|figure| named(figure, basis)).collect())
    }

    /// The figures that say something of a single class.
    pub(crate) fn of_class(basis: &Basis) -> Self {
        let by_class = FIGURES.iter().filter(|figure| figure.is_by_class);
        Self(by_class.map(|figure| named(figure, basis)).collect())
    }

    /// A figure by its name, if there is one of that name here.
    pub fn get(&self, name: &str) -> Option<Value> {
        let found = self.0.iter().find(|(known, _)| *known == name);
        found.map(|(_, value)| *value)
    }

    /// Whether nothing was counted.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.iter().all(|(_, value)| value.count == 0)
    }
}

fn named(figure: &Figure, basis: &Basis) -> (&'static str, Value) {
    (figure.name, Value { value: (figure.value)(basis), count: (figure.count)(basis) })
}

impl Serialize for Figures {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        self.0.iter().try_for_each(|(name, value)| map.serialize_entry(name, value))?;
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_codes_are_told_once() {
        let mut names: Vec<_> = FIGURES.iter().flat_map(|f| [f.name, f.code]).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 2 * FIGURES.len());
    }

    #[test]
    fn the_page_explains_every_figure() {
        let page = include_str!("../../../../docs/quality.md");
        for figure in FIGURES {
            let row = format!("| {} | `{}` |", figure.code, figure.name);
            assert!(page.contains(&row), "{row}");
        }
    }
}
