//! What label files say.

use std::collections::BTreeMap;

use occlabel_core::{Fault, PointLabel};

use crate::ReadOptions;

/// Nobody labelled the point.
const UNLABELED: u16 = 0;

/// Names of raw labels (semantic-kitti-api, `config/semantic-kitti.yaml`).
const NAMES: [(u16, &str); 33] = [
    (1, "outlier"),
    (10, "car"),
    (11, "bicycle"),
    (13, "bus"),
    (15, "motorcycle"),
    (16, "on-rails"),
    (18, "truck"),
    (20, "other-vehicle"),
    (30, "person"),
    (31, "bicyclist"),
    (32, "motorcyclist"),
    (40, "road"),
    (44, "parking"),
    (48, "sidewalk"),
    (49, "other-ground"),
    (50, "building"),
    (51, "fence"),
    (52, "other-structure"),
    (60, "lane-marking"),
    (70, "vegetation"),
    (71, "trunk"),
    (72, "terrain"),
    (80, "pole"),
    (81, "traffic-sign"),
    (99, "other-object"),
    (252, "moving-car"),
    (253, "moving-bicyclist"),
    (254, "moving-person"),
    (255, "moving-motorcyclist"),
    (256, "moving-on-rails"),
    (257, "moving-bus"),
    (258, "moving-truck"),
    (259, "moving-other-vehicle"),
];

/// The labels of `count` points from a file of 32-bit little-endian numbers: the class in the lower
/// half, the instance in the upper one; and what to say of classes that only `unknown_as` stands in
/// for.
///
/// # Errors
/// If there is not one label for each point, or the taxonomy does not name a class.
pub(crate) fn decode_labels(
    bytes: &[u8],
    file: &str,
    count: usize,
    options: &ReadOptions,
) -> Result<(Vec<PointLabel>, Option<Fault>), Fault> {
    if bytes.len() != 4 * count {
        let expected = format!("{} bytes, a label for each of {count} points", 4 * count);
        return Err(Fault::new("label-count", file, expected, format!("{} bytes", bytes.len())));
    }
    let raw: Vec<u16> =
        bytes.chunks_exact(4).map(|word| u16::from_le_bytes([word[0], word[1]])).collect();
    let mut counts: BTreeMap<u16, usize> = BTreeMap::new();
    raw.iter().for_each(|class| *counts.entry(*class).or_default() += 1);
    let meaning = |class: u16| (class, meaning(class, options));
    let meanings: BTreeMap<u16, PointLabel> = counts.keys().copied().map(meaning).collect();
    let unknown = unknown(&counts, options).map(|found| {
        let fault = Fault::new("unknown-label", file, "classes that the taxonomy names", found);
        options.unknown(fault)
    });
    Ok((raw.iter().map(|class| meanings[class]).collect(), unknown.transpose()?))
}

fn meaning(class: u16, options: &ReadOptions) -> PointLabel {
    match class {
        UNLABELED => PointLabel::Unlabelled,
        class => options.point_label(&name(class)).unwrap_or(PointLabel::Unlabelled),
    }
}

/// The classes that the taxonomy does not name, each with how many points are of it.
fn unknown(counts: &BTreeMap<u16, usize>, options: &ReadOptions) -> Option<String> {
    let is_known = |class| class == UNLABELED || options.taxonomy.points.contains_key(&name(class));
    let unknown = counts.iter().filter(|&(&class, _)| !is_known(class));
    let told =
        |(class, count): (&u16, &usize)| format!("{class} ({}) of {count} points", name(*class));
    let list: Vec<String> = unknown.map(told).collect();
    (!list.is_empty()).then(|| list.join(", "))
}

/// The name of a class; of one that has none, its number.
fn name(class: u16) -> String {
    let known = NAMES.iter().find(|(number, _)| *number == class);
    known.map_or_else(|| class.to_string(), |(_, name)| (*name).to_owned())
}
