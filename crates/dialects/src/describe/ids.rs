//! What the ids in a file tell, before they are taken for classes.

use std::collections::BTreeMap;

use occlabel_labels::{NumberArray, NumberType};

use crate::ClassTable;
use crate::describe::Suspicion;

/// How often each id stands in files.
pub type IdCounts = BTreeMap<i64, u64>;

/// How often each number stands in an array; `None` if they are not whole.
pub(crate) fn count_ids(array: &NumberArray) -> Option<IdCounts> {
    match array.number {
        NumberType::U8 => Some(count(array.bytes.iter().map(|id| usize::from(*id)), 256)),
        NumberType::U16 => {
            let ids = array.bytes.as_chunks().0.iter().map(|id| u16::from_le_bytes(*id));
            Some(count(ids.map(usize::from), 1 << 16))
        }
        _ => Some(count_runs(&array.whole()?)),
    }
}

fn count(ids: impl Iterator<Item = usize>, below: usize) -> IdCounts {
    let mut counts = vec![0; below];
    ids.for_each(|id| counts[id] += 1);
    let seen = counts.iter().enumerate().filter(|(_, count)| **count > 0);
    seen.map(|(id, count)| (id as i64, *count)).collect()
}

/// How often each number stands in a list, run by run.
pub(crate) fn count_runs(ids: &[i64]) -> IdCounts {
    let mut counts = IdCounts::new();
    for run in ids.chunk_by(|a, b| a == b) {
        *counts.entry(run[0]).or_default() += run.len() as u64;
    }
    counts
}

/// How many of the ids are none of a table's.
pub(crate) fn unknown(ids: &IdCounts, classes: &ClassTable) -> IdCounts {
    let is_unknown = |id: &i64| !is_known(*id, classes);
    ids.iter().filter(|(id, _)| is_unknown(id)).map(|(id, count)| (*id, *count)).collect()
}

fn is_known(id: i64, classes: &ClassTable) -> bool {
    let Ok(id) = u16::try_from(id) else { return false };
    classes.index_of(id).is_some()
}

/// The id that more than half of the voxels have, if there is one.
pub(crate) fn most(ids: &IdCounts) -> Option<i64> {
    let all: u64 = ids.values().sum();
    ids.iter().find(|(_, count)| **count * 2 > all).map(|(id, _)| *id)
}

/// Ids that are no class.
pub(crate) fn outside_classes(ids: &IdCounts, classes: &ClassTable) -> Option<Suspicion> {
    let unknown = unknown(ids, classes);
    let (count, all) = (unknown.values().sum(), ids.values().sum());
    let each: Vec<_> = unknown.iter().take(5).map(|(id, n)| format!("{id} ({n})")).collect();
    let more = if unknown.len() > 5 { ", and more" } else { "" };
    let text = format!("{count} of {all} ids are no class: {}{more}", each.join(", "));
    Suspicion::of("ids-outside-classes", count, all, text)
}

/// Most voxels have the id that is free elsewhere, and not here.
pub(crate) fn free_of_another(
    ids: &IdCounts,
    classes: &ClassTable,
    others: &[(&str, u16)],
) -> Option<Suspicion> {
    let most = most(ids).filter(|id| *id != i64::from(classes.free))?;
    let is_free = |other: &&(&str, u16)| i64::from(other.1) == most;
    let names: Vec<_> = others.iter().filter(is_free).map(|(name, _)| *name).collect();
    let (count, all) = (ids[&most], ids.values().sum());
    let free = classes.free;
    let names = names.join(", ");
    let text = format!("{count} of {all} voxels are {most}, free in {names}; here {free} is free");
    (!names.is_empty()).then(|| Suspicion::of("free-id-of-another-dialect", count, all, text))?
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Class;

    fn classes() -> ClassTable {
        let class = |id| Class { id, name: format!("c{id}"), ..Class::default() };
        ClassTable { free: 3, no_label: Some(255), list: (0..3).map(class).collect() }
    }

    #[test]
    fn ids_are_counted() {
        let counts = IdCounts::from([(0, 1), (1, 3)]);
        assert_eq!(count_ids(&NumberArray::new(&[4], &[1_u8, 1, 0, 1])), Some(counts.clone()));
        assert_eq!(count_ids(&NumberArray::new(&[4], &[1_u16, 1, 0, 1])), Some(counts.clone()));
        assert_eq!(count_ids(&NumberArray::new(&[4], &[1_i64, 1, 0, 1])), Some(counts));
        assert_eq!(count_ids(&NumberArray::new(&[1], &[1.0_f32])), None);
        assert!(count_runs(&[]).is_empty());
    }

    #[test]
    fn ids_that_are_no_class_are_told_with_their_counts() {
        let ids = count_runs(&[0, 1, 2, 3, 255, 9, 9, -1]);
        let told = outside_classes(&ids, &classes()).unwrap();
        assert_eq!((told.count, told.of), (3, 8));
        assert_eq!(told.text, "3 of 8 ids are no class: -1 (1), 9 (2)");
        assert_eq!(outside_classes(&count_runs(&[0, 3, 255]), &classes()), None);
    }

    #[test]
    fn the_free_id_of_another_dialect_is_known_by_filling_the_grid() {
        let others = [("here", 3), ("elsewhere", 17), ("there", 17)];
        let told = free_of_another(&count_runs(&[17, 17, 17, 0]), &classes(), &others).unwrap();
        let text = "3 of 4 voxels are 17, free in elsewhere, there; here 3 is free";
        assert_eq!((told.rule, told.text.as_str()), ("free-id-of-another-dialect", text));
        assert_eq!(free_of_another(&count_runs(&[3, 3, 3, 17]), &classes(), &others), None);
        assert_eq!(free_of_another(&count_runs(&[17, 3]), &classes(), &others), None);
        assert_eq!(free_of_another(&count_runs(&[2, 2]), &classes(), &others), None);
    }
}
