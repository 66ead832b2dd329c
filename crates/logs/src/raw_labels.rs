//! Raw labels of points: numbers, which go by their names, and what the taxonomy says of these.

use std::collections::BTreeMap;
use std::fmt;

use occlabel_core::{Fault, PointLabel};

use crate::ReadOptions;

/// The rule of a label that the taxonomy does not name.
pub(crate) const UNKNOWN_LABEL: &str = "unknown-label";

/// The raw labels of a sweep, as they come up, and what they mean.
pub(crate) struct RawLabels<'a, N> {
    options: &'a ReadOptions,
    name: N,
    /// In the order in which they came up.
    seen: Vec<Seen>,
    places: BTreeMap<i64, usize>,
    /// By the lowest byte of a label: where in `seen` the last such label may stand. Labels of all
    /// known formats are near 0, so that hardly any point is looked up in `places`.
    memo: [usize; 256],
}

struct Seen {
    raw: i64,
    label: PointLabel,
    /// Its name, if the taxonomy does not have that.
    unknown: Option<String>,
    points: u64,
}

impl<'a, N: Fn(i64) -> Option<String>> RawLabels<'a, N> {
    /// None yet. `name` tells what a label is called; `None`: nobody labelled the point.
    pub(crate) fn new(options: &'a ReadOptions, name: N) -> Self {
        Self { options, name, seen: Vec::new(), places: BTreeMap::new(), memo: [0; 256] }
    }

    /// What the labels of more points mean.
    pub(crate) fn labels<R: Into<i64>>(
        &mut self,
        raw: impl IntoIterator<Item = R>,
    ) -> Vec<PointLabel> {
        raw.into_iter().map(|raw| self.label(raw.into())).collect()
    }

    /// What one more point's label means; nobody labelled a point whose label means nothing.
    pub(crate) fn label(&mut self, raw: i64) -> PointLabel {
        let byte = usize::from(raw as u8);
        let mut place = self.memo[byte];
        if self.seen.get(place).is_none_or(|seen| seen.raw != raw) {
            place = self.place(raw);
            self.memo[byte] = place;
        }
        let seen = &mut self.seen[place];
        seen.points += 1;
        seen.label
    }

    fn place(&mut self, raw: i64) -> usize {
        if let Some(place) = self.places.get(&raw) {
            return *place;
        }
        let place = self.seen.len();
        self.seen.push(self.look_up(raw));
        self.places.insert(raw, place);
        place
    }

    fn look_up(&self, raw: i64) -> Seen {
        let name = (self.name)(raw);
        let label = name.as_ref().and_then(|name| self.options.point_label(name));
        let unknown = name.filter(|name| !self.options.taxonomy.points.contains_key(name));
        Seen { raw, label: label.unwrap_or(PointLabel::Unlabelled), unknown, points: 0 }
    }

    /// The labels of `file` that the taxonomy does not name; `warnings` tell of them.
    ///
    /// # Errors
    /// If there are such, and no class stands in for them.
    pub(crate) fn finish(
        self,
        file: &str,
        warnings: &mut Vec<Fault>,
    ) -> Result<UnknownLabels, Fault> {
        let counted = |seen: Seen| Some(((seen.raw, seen.unknown?), seen.points));
        let unknown = UnknownLabels { points: self.seen.into_iter().filter_map(counted).collect() };
        if !unknown.is_empty() {
            let expected = "raw labels that the taxonomy names";
            let fault = Fault::new(UNKNOWN_LABEL, file, expected, unknown.to_string());
            warnings.push(self.options.unknown(fault)?);
        }
        Ok(unknown)
    }
}

/// Raw labels that the taxonomy does not name.
///
/// Prints as `LABEL (NAME) of COUNT points, …`, in order of labels.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnknownLabels {
    /// How many points have a label, by its number and name.
    points: BTreeMap<(i64, String), u64>,
}

impl UnknownLabels {
    /// Whether the taxonomy names all of them.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Adds the points of others.
    pub fn add(&mut self, others: Self) {
        for (label, points) in others.points {
            *self.points.entry(label).or_default() += points;
        }
    }
}

impl fmt::Display for UnknownLabels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, ((raw, name), points)) in self.points.iter().enumerate() {
            let comma = if i > 0 { ", " } else { "" };
            write!(f, "{comma}{raw} ({name}) of {points} points")?;
        }
        Ok(())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::cell::Cell;

    use occlabel_core::ClassId;
    use proptest::prelude::*;

    use super::*;

    /// The taxonomy of Occ3D-Waymo, which names `ROAD`, `CAR` and `UNDEFINED`.
    pub(crate) fn options() -> ReadOptions {
        let taxonomy = include_str!("../../../configs/taxonomies/occ3d-waymo.toml");
        ReadOptions::of(toml::from_str(taxonomy).expect("a taxonomy"))
    }

    /// 0 is nobody's, what ends with the byte 18 is a road, the taxonomy does not name the others.
    fn name(raw: i64) -> Option<String> {
        match raw {
            0 => None,
            _ if raw & 0xff == 18 => Some("ROAD".into()),
            _ => Some(format!("n{raw}")),
        }
    }

    #[test]
    fn fault_26_unknown_labels_are_refused_with_their_counts_in_order() {
        let options = options();
        let mut labels = RawLabels::new(&options, name);
        let read = labels.labels([300, 18, 0, -1, 300, 274, 9]);
        let road = PointLabel::Class(ClassId(13));
        let mut expected = [PointLabel::Unlabelled; 7];
        (expected[1], expected[5]) = (road, road);
        assert_eq!(read, expected);
        let mut warnings = Vec::new();
        let fault = labels.finish("f", &mut warnings).unwrap_err();
        assert_eq!((fault.rule, fault.place.as_str()), (UNKNOWN_LABEL, "f"));
        assert_eq!(fault.found, "-1 (n-1) of 1 points, 9 (n9) of 1 points, 300 (n300) of 2 points");
        assert!(
            fault.hint.is_some_and(|hint| hint.contains("--unknown-as")) && warnings.is_empty()
        );
    }

    #[test]
    fn fault_26_a_class_stands_in_and_the_counts_come_back() {
        let options = ReadOptions { unknown_as: Some(ClassId(1)), ..options() };
        let mut labels = RawLabels::new(&options, name);
        let read = labels.labels([9, 18, 0, 9]);
        let [taken, road] = [1, 13].map(|class| PointLabel::Class(ClassId(class)));
        assert_eq!(read, [taken, road, PointLabel::Unlabelled, taken]);
        let mut warnings = Vec::new();
        let unknown = labels.finish("f", &mut warnings).unwrap();
        assert_eq!(unknown.to_string(), "9 (n9) of 2 points");
        assert_eq!(warnings.len(), 1);
        assert_eq!(warnings[0].found, "9 (n9) of 2 points, taken as `vehicle`");
    }

    #[test]
    fn known_labels_leave_nothing_to_say() {
        let options = options();
        let mut labels = RawLabels::new(&options, name);
        labels.labels([18, 0, 274]);
        let mut warnings = Vec::new();
        assert!(labels.finish("f", &mut warnings).unwrap().is_empty() && warnings.is_empty());
        assert_eq!(UnknownLabels::default().to_string(), "");
    }

    #[test]
    fn a_label_is_looked_up_once_whatever_its_byte() {
        let (options, looked_up) = (options(), Cell::new(0));
        let counted = |raw| {
            looked_up.set(looked_up.get() + 1);
            name(raw)
        };
        let mut labels = RawLabels::new(&options, counted);
        labels.labels([7, 263, -249, i64::MAX, i64::MIN].repeat(100));
        assert_eq!(looked_up.get(), 5);
    }

    #[test]
    fn unknown_labels_add_up() {
        let of = |list: &[(i64, &str, u64)]| UnknownLabels {
            points: list.iter().map(|(raw, name, n)| ((*raw, (*name).into()), *n)).collect(),
        };
        let mut sum = UnknownLabels::default();
        sum.add(of(&[(70, "ufo, or so", 3), (9, "elk", 1)]));
        sum.add(of(&[(9, "elk", 40)]));
        assert_eq!(sum, of(&[(9, "elk", 41), (70, "ufo, or so", 3)]));
        assert_eq!(sum.to_string(), "9 (elk) of 41 points, 70 (ufo, or so) of 3 points");
    }

    /// The obvious way: each point by itself.
    fn oracle(raw: &[i64], options: &ReadOptions) -> (Vec<PointLabel>, String) {
        let is_unknown = |raw: &&i64| name(**raw).is_some_and(|name| name != "ROAD");
        let mut counts: BTreeMap<i64, u64> = BTreeMap::new();
        raw.iter().filter(is_unknown).for_each(|raw| *counts.entry(*raw).or_default() += 1);
        let label = |raw: &i64| name(*raw).and_then(|name| options.point_label(&name));
        let labels = raw.iter().map(|raw| label(raw).unwrap_or(PointLabel::Unlabelled));
        let told = counts.iter().map(|(raw, n)| format!("{raw} (n{raw}) of {n} points"));
        (labels.collect(), told.collect::<Vec<_>>().join(", "))
    }

    #[test]
    fn many_labels_are_as_each_by_itself() {
        let options = ReadOptions { unknown_as: Some(ClassId(1)), ..options() };
        let one = prop_oneof![0i64..30, 250i64..280, -3i64..3, any::<i64>()];
        let compared = Cell::new(0);
        let mut runner = proptest::test_runner::TestRunner::deterministic();
        let run = runner.run(&prop::collection::vec(one, 0..400), |raw| {
            let mut labels = RawLabels::new(&options, name);
            let read = labels.labels(raw.clone());
            let unknown = labels.finish("f", &mut Vec::new()).unwrap().to_string();
            compared.set(compared.get() + raw.len());
            prop_assert_eq!((read, unknown), oracle(&raw, &options));
            Ok(())
        });
        run.unwrap();
        assert!(compared.get() > 20_000, "{}", compared.get());
    }
}
