//! Labels of points as files of KITTI's kind have them: numbers, which go by their names.

use std::collections::BTreeMap;

use occlabel_core::{Fault, PointLabel};

use crate::ReadOptions;

/// Nobody labelled the point.
const UNLABELED: u16 = 0;

/// The raw classes of `count` points from a file of 32-bit little-endian numbers: the class in the
/// lower half, the instance in the upper one.
///
/// # Errors
/// If there is not one label for each point.
pub(crate) fn decode_labels(bytes: &[u8], file: &str, count: usize) -> Result<Vec<u16>, Fault> {
    if bytes.len() != 4 * count {
        let expected = format!("{} bytes, a label for each of {count} points", 4 * count);
        return Err(Fault::new("label-count", file, expected, format!("{} bytes", bytes.len())));
    }
    Ok(bytes.chunks_exact(4).map(|word| u16::from_le_bytes([word[0], word[1]])).collect())
}

/// What raw classes mean.
pub(crate) struct PointNames<'a> {
    pub(crate) options: &'a ReadOptions,
    /// The name of a class, if it has one.
    pub(crate) name: fn(u16) -> Option<&'static str>,
}

impl PointNames<'_> {
    /// A label for each raw class; and what to say of classes that only `unknown_as` stands in for.
    ///
    /// # Errors
    /// If the taxonomy does not name a class.
    pub(crate) fn labels(
        &self,
        raw: &[u16],
        file: &str,
    ) -> Result<(Vec<PointLabel>, Option<Fault>), Fault> {
        let mut counts: BTreeMap<u16, usize> = BTreeMap::new();
        raw.iter().for_each(|class| *counts.entry(*class).or_default() += 1);
        let meaning = |class: u16| (class, self.meaning(class));
        let meanings: BTreeMap<u16, PointLabel> = counts.keys().copied().map(meaning).collect();
        let unknown = self.unknown(&counts).map(|found| {
            let fault = Fault::new("unknown-label", file, "classes that the taxonomy names", found);
            self.options.unknown(fault)
        });
        Ok((raw.iter().map(|class| meanings[class]).collect(), unknown.transpose()?))
    }

    fn meaning(&self, class: u16) -> PointLabel {
        match class {
            UNLABELED => PointLabel::Unlabelled,
            class => self.options.point_label(&self.name(class)).unwrap_or(PointLabel::Unlabelled),
        }
    }

    /// The classes that the taxonomy does not name, each with how many points are of it.
    fn unknown(&self, counts: &BTreeMap<u16, usize>) -> Option<String> {
        let known = &self.options.taxonomy.points;
        let is_known = |class| class == UNLABELED || known.contains_key(&self.name(class));
        let unknown = counts.iter().filter(|&(&class, _)| !is_known(class));
        let told = |(class, count): (&u16, &usize)| {
            format!("{class} ({}) of {count} points", self.name(*class))
        };
        let list: Vec<String> = unknown.map(told).collect();
        (!list.is_empty()).then(|| list.join(", "))
    }

    /// The name of a class; of one that has none, its number.
    fn name(&self, class: u16) -> String {
        (self.name)(class).map_or_else(|| class.to_string(), str::to_owned)
    }
}
