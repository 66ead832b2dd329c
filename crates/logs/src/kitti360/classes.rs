//! Classes by their numbers (kitti360Scripts, `helpers/labels.py`): labels of points and pixels have
//! the one, boxes the other.

/// Names by the number in labels, and by that in boxes.
const NAMES: [(u16, Option<u16>, &str); 41] = [
    (4, None, "static"),
    (5, None, "dynamic"),
    (6, None, "ground"),
    (7, Some(1), "road"),
    (8, Some(3), "sidewalk"),
    (9, Some(2), "parking"),
    (10, Some(10), "rail track"),
    (11, Some(11), "building"),
    (12, Some(7), "wall"),
    (13, Some(8), "fence"),
    (14, Some(30), "guard rail"),
    (15, Some(31), "bridge"),
    (16, Some(32), "tunnel"),
    (17, Some(21), "pole"),
    (18, None, "polegroup"),
    (19, Some(23), "traffic light"),
    (20, Some(24), "traffic sign"),
    (21, Some(5), "vegetation"),
    (22, Some(4), "terrain"),
    (23, Some(9), "sky"),
    (24, Some(19), "person"),
    (25, Some(20), "rider"),
    (26, Some(13), "car"),
    (27, Some(14), "truck"),
    (28, Some(34), "bus"),
    (29, Some(16), "caravan"),
    (30, Some(15), "trailer"),
    (31, Some(33), "train"),
    (32, Some(17), "motorcycle"),
    (33, Some(18), "bicycle"),
    (34, Some(12), "garage"),
    (35, Some(6), "gate"),
    (36, Some(29), "stop"),
    (37, Some(22), "smallpole"),
    (38, Some(25), "lamp"),
    (39, Some(26), "trash bin"),
    (40, Some(27), "vending machine"),
    (41, Some(28), "box"),
    (42, Some(35), "unknown construction"),
    (43, Some(36), "unknown vehicle"),
    (44, Some(37), "unknown object"),
];

/// Boxes of these may move, and are tracks. The others are rough hulls of buildings, poles and the
/// like, which hold what is not theirs.
const MOVABLE: [&str; 11] = [
    "person",
    "rider",
    "car",
    "truck",
    "bus",
    "caravan",
    "trailer",
    "train",
    "motorcycle",
    "bicycle",
    "unknown vehicle",
];

/// The name of a label's class, if it has one.
pub(super) fn label_name(number: u16) -> Option<&'static str> {
    NAMES.iter().find(|(label, ..)| *label == number).map(|(.., name)| *name)
}

/// The name of a box's class, if it may move.
pub(super) fn movable_name(number: u16) -> Option<&'static str> {
    let known = NAMES.iter().find(|(_, boxed, _)| *boxed == Some(number));
    known.map(|(.., name)| *name).filter(|name| MOVABLE.contains(name))
}
