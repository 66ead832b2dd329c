//! What raw point classes and box types mean: they are looked up in the taxonomy by their names.

use std::collections::BTreeMap;

use occlabel_core::{Fault, PointLabel};

use super::segment::Place;
use crate::ReadOptions;

/// Nobody labelled the point: whatever the taxonomy says, it is of no class.
const UNDEFINED: i32 = 0;
/// Names of point classes by number: `Segmentation.Type` without its `TYPE_`.
const POINT_CLASSES: [&str; 23] = [
    "UNDEFINED",
    "CAR",
    "TRUCK",
    "BUS",
    "OTHER_VEHICLE",
    "MOTORCYCLIST",
    "BICYCLIST",
    "PEDESTRIAN",
    "SIGN",
    "TRAFFIC_LIGHT",
    "POLE",
    "CONSTRUCTION_CONE",
    "BICYCLE",
    "MOTORCYCLE",
    "BUILDING",
    "VEGETATION",
    "TREE_TRUNK",
    "CURB",
    "ROAD",
    "LANE_MARKER",
    "OTHER_GROUND",
    "WALKABLE",
    "SIDEWALK",
];
/// Names of box types by number: `Label.Type` without its `TYPE_`.
const BOX_TYPES: [&str; 5] = ["UNKNOWN", "VEHICLE", "PEDESTRIAN", "SIGN", "CYCLIST"];

/// The name of a box type; of one that has none, its number.
pub(super) fn box_type(kind: i64) -> String {
    name(&BOX_TYPES, kind)
}

fn name(names: &[&str], number: i64) -> String {
    let known = usize::try_from(number).ok().and_then(|place| names.get(place));
    known.map_or_else(|| number.to_string(), |name| (*name).to_owned())
}

/// The classes of a sweep's points, as they come up.
pub(super) struct PointClasses<'a> {
    options: &'a ReadOptions,
    /// By raw class: what it means, how many points have it, and whether the taxonomy names it.
    seen: BTreeMap<i32, (PointLabel, usize, bool)>,
}

impl<'a> PointClasses<'a> {
    /// None yet.
    pub(super) fn new(options: &'a ReadOptions) -> Self {
        Self { options, seen: BTreeMap::new() }
    }

    /// What a raw class means; nobody labelled a point whose class means nothing.
    pub(super) fn label(&mut self, raw: i32) -> PointLabel {
        if raw == UNDEFINED {
            return PointLabel::Unlabelled;
        }
        let (label, count, _) = self.seen.entry(raw).or_insert_with(|| {
            let name = name(&POINT_CLASSES, raw.into());
            let label = self.options.point_label(&name).unwrap_or(PointLabel::Unlabelled);
            (label, 0, self.options.taxonomy.points.contains_key(&name))
        });
        *count += 1;
        *label
    }

    /// What to say of classes that mean nothing, if a class stands in for them.
    ///
    /// # Errors
    /// If there are such, and none does.
    pub(super) fn finish(self, place: &Place) -> Result<Option<Fault>, Fault> {
        let unknown = self.seen.iter().filter(|(_, (_, _, is_known))| !is_known);
        let told = |(raw, (_, count, _)): (&i32, &(PointLabel, usize, bool))| {
            format!("{raw} ({}) of {count} points", name(&POINT_CLASSES, (*raw).into()))
        };
        let found: Vec<String> = unknown.map(told).collect();
        if found.is_empty() {
            return Ok(None);
        }
        let expected = "point classes that the taxonomy names";
        let fault = place.fault("unknown-label", expected, found.join(", "));
        self.options.unknown(fault).map(Some)
    }
}

#[cfg(test)]
mod tests {
    use occlabel_core::{ClassId, Taxonomy};

    use super::*;

    fn options() -> ReadOptions {
        let taxonomy: Taxonomy =
            toml::from_str(include_str!("../../../../configs/taxonomies/occ3d-waymo.toml"))
                .expect("a taxonomy");
        ReadOptions::of(taxonomy)
    }

    #[test]
    fn fault_28_an_undefined_point_is_unlabelled_though_the_taxonomy_has_a_class_for_it() {
        let options = options();
        assert!(options.point_label("UNDEFINED").is_some());
        let mut classes = PointClasses::new(&options);
        assert_eq!(classes.label(0), PointLabel::Unlabelled);
        assert_eq!(classes.label(18), PointLabel::Class(ClassId(13)));
        let place = Place { file: "f".into(), record: "r".into(), offset: None };
        assert_eq!(classes.finish(&place), Ok(None));
    }
}
