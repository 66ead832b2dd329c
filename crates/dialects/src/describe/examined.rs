//! What was found in the files of keyframes.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use occlabel_core::{Fault, GridSpec, VoxelGrid};

use crate::decode::Places;
use crate::describe::ids::{self, IdCounts};
use crate::describe::{MotionCounts, VoxelTally, motion, raw};
use crate::{Class, ClassTable, Dialect, Holds, IGNORED, KeyframeLabels, LabelSet, Wanted};

/// What was found in the files of keyframes, added up in any order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Examined {
    /// How often each id stands in the files.
    pub ids: IdCounts,
    /// What the voxels say.
    pub tally: VoxelTally,
    /// Masks by their names: how many voxels are neither 0 nor 1, and of how many.
    pub odd_masks: BTreeMap<String, (u64, u64)>,
    /// What keyframes have in common with the next, where poses are known.
    pub motion: MotionCounts,
    /// Keyframes that the dialect cannot be read from.
    pub refused: u64,
    /// Which of them is the first, and why.
    pub first_refusal: Option<(usize, String)>,
}

impl Examined {
    /// What is in a keyframe of a set, by its place in [`LabelSet::keyframes`].
    ///
    /// # Errors
    /// If a file cannot be read at all.
    pub fn of_keyframe(set: &LabelSet, at: usize) -> Result<Self, Fault> {
        let key = &set.keyframes()[at];
        let mut found = Self::of(set.dialect(), &|name| set.place(key, name), set.spec(), at)?;
        found.motion = motion_from(set, at).unwrap_or_default();
        Ok(found)
    }

    /// What is in the files of a keyframe, taken for a dialect's.
    pub(crate) fn of(
        dialect: &Dialect,
        places: Places<'_>,
        spec: &GridSpec,
        at: usize,
    ) -> Result<Self, Fault> {
        let ids = raw::class_ids(dialect, places)?.unwrap_or_default();
        let read = read_anyhow(dialect, places, spec, &ids);
        let mut found = Self { ids, ..Self::default() };
        match read {
            Ok(labels) => found.tally = VoxelTally::of(&labels, &dialect.classes),
            Err(fault) => {
                found.refused = 1;
                found.first_refusal = Some((at, fault.to_string()));
                found.odd_masks = odd_masks(dialect, places)?;
            }
        }
        Ok(found)
    }
}

impl AddAssign for Examined {
    fn add_assign(&mut self, other: Self) {
        for (id, count) in other.ids {
            *self.ids.entry(id).or_default() += count;
        }
        self.tally += other.tally;
        for (name, (odd, all)) in other.odd_masks {
            let sum = self.odd_masks.entry(name).or_default();
            *sum = (sum.0 + odd, sum.1 + all);
        }
        self.motion += other.motion;
        self.refused += other.refused;
        self.first_refusal =
            [self.first_refusal.take(), other.first_refusal].into_iter().flatten().min();
    }
}

/// What a keyframe has in common with the next of its scene; `None` if either is not read, or its files
/// do not tell where it stood.
fn motion_from(set: &LabelSet, at: usize) -> Option<MotionCounts> {
    let [one, other] = [set.keyframes().get(at)?, set.keyframes().get(at + 1)?];
    if one.scene != other.scene || !motion::tells_poses(set.dialect()) {
        return None;
    }
    let wanted = Wanted { extras: true, ..Wanted::default() };
    let [one, other] = [set.read_with(one, &wanted).ok()?, set.read_with(other, &wanted).ok()?];
    let other_from_world = motion::world_from_grid(&other)?.inverse();
    let other_from_one = other_from_world * motion::world_from_grid(&one)?;
    Some(MotionCounts::of([&one, &other], &other_from_one, set.classes()))
}

/// The labels of a keyframe; voxels whose ids are no class have no label.
fn read_anyhow(
    dialect: &Dialect,
    places: Places<'_>,
    spec: &GridSpec,
    ids: &IdCounts,
) -> Result<KeyframeLabels, Fault> {
    let unknown = ids::unknown(ids, &dialect.classes);
    let ids: Vec<u16> = unknown.keys().filter_map(|id| u16::try_from(*id).ok()).collect();
    let known = dialect.classes.list.len();
    let extended = extended(dialect, &ids);
    let mut labels = extended.decode(places, spec, &Wanted::default())?;
    let (free, was_free) = (dialect.classes.free_index(), extended.classes.free_index());
    let index = |class: &u8| match *class {
        class if usize::from(class) < known => class,
        class if class == was_free => free,
        _ => IGNORED,
    };
    let semantics = labels.semantics.values().iter().map(index).collect();
    labels.semantics = VoxelGrid::from_values(spec, semantics);
    Ok(labels)
}

/// The dialect with a class for each id that it does not know.
fn extended(dialect: &Dialect, ids: &[u16]) -> Dialect {
    let class = |id: &u16| Class { id: *id, name: id.to_string(), ..Class::default() };
    let known = dialect.classes.list.iter().cloned();
    let list = known.chain(ids.iter().map(class)).take(253).collect();
    Dialect { classes: ClassTable { list, ..dialect.classes.clone() }, ..dialect.clone() }
}

fn odd_masks(dialect: &Dialect, places: Places<'_>) -> Result<BTreeMap<String, (u64, u64)>, Fault> {
    let masks = dialect.layout.arrays().iter();
    let masks = masks.filter(|a| matches!(a.holds, Holds::MaskLidar | Holds::MaskCamera));
    let mut odd = BTreeMap::new();
    for array in masks {
        let (count, all) = raw::odd_values(dialect, array, places)?;
        if count > 0 {
            odd.insert(array.name.clone(), (count, all));
        }
    }
    Ok(odd)
}
