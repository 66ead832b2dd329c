//! What raw point classes and box types are called.

/// Nobody labelled the point: whatever the taxonomy says, it is of no class.
const UNDEFINED: i64 = 0;
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

/// The name of a point class; of one that has none, its number. `None` if nobody labelled the point.
pub(super) fn point_class(raw: i64) -> Option<String> {
    (raw != UNDEFINED).then(|| name(&POINT_CLASSES, raw))
}

fn name(names: &[&str], number: i64) -> String {
    let known = usize::try_from(number).ok().and_then(|place| names.get(place));
    known.map_or_else(|| number.to_string(), |name| (*name).to_owned())
}

#[cfg(test)]
mod tests {
    use occlabel_core::{ClassId, PointLabel};

    use super::*;
    use crate::raw_labels::{RawLabels, tests::options};

    #[test]
    fn fault_28_an_undefined_point_is_unlabelled_though_the_taxonomy_has_a_class_for_it() {
        let options = options();
        assert!(options.point_label("UNDEFINED").is_some());
        let mut classes = RawLabels::new(&options, point_class);
        assert_eq!(classes.label(0), PointLabel::Unlabelled);
        assert_eq!(classes.label(18), PointLabel::Class(ClassId(13)));
        assert!(classes.finish("f", &mut Vec::new()).unwrap().is_empty());
    }
}
