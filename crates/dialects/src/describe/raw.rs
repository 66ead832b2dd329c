//! The numbers of a keyframe's files, before anything is made of them.

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::{NpzFile, NumberArray, NumberType, read_bounded, read_npy};

use crate::decode::Places;
use crate::describe::ids::{IdCounts, count_ids, count_runs};
use crate::{Array, Column, Dialect, Element, Holds, Layout, Rows};

/// Most bytes of numbers that are read of one array.
const MAX_BYTES: u64 = 1 << 31;

/// How often each id of classes stands in a keyframe's files; `None` if they are no whole numbers.
pub(crate) fn class_ids(dialect: &Dialect, places: Places<'_>) -> Result<Option<IdCounts>, Fault> {
    match &dialect.layout {
        Layout::Rows(rows) => Ok(ids_of_rows(rows, &read_npy(&places(""), MAX_BYTES)?)),
        layout => {
            let semantics = layout.arrays().iter().find(|a| a.holds == Holds::Semantics);
            let Some(array) = semantics else { return Ok(None) };
            let numbers = numbers(layout, array, places)?;
            let is_pairs = matches!(layout, Layout::Indices(_));
            Ok(numbers.and_then(|numbers| match is_pairs {
                true => ids_of_column(&numbers, 2, 1),
                false => count_ids(&numbers),
            }))
        }
    }
}

/// How many numbers of a mask are neither 0 nor 1, and of how many.
pub(crate) fn odd_values(
    dialect: &Dialect,
    array: &Array,
    places: Places<'_>,
) -> Result<(u64, u64), Fault> {
    let numbers = numbers(&dialect.layout, array, places)?;
    let counts = numbers.as_ref().and_then(count_ids).unwrap_or_default();
    let all = counts.values().sum();
    let odd = counts.iter().filter(|(value, _)| !(0..=1).contains(*value));
    Ok((odd.map(|(_, count)| count).sum(), all))
}

/// An array, if it is there.
fn numbers(
    layout: &Layout,
    array: &Array,
    places: Places<'_>,
) -> Result<Option<NumberArray>, Fault> {
    let place = places(&array.name);
    match (layout, array.element) {
        (Layout::Npz(_), _) => NpzFile::open(&place, MAX_BYTES)?.array(&array.name, MAX_BYTES),
        _ if !disk::exists(&place) => Ok(None),
        (Layout::VoxelFiles(_), Element::Number(number)) => {
            let bytes = read_bounded(&place, MAX_BYTES)?;
            Ok(Some(NumberArray { number, shape: vec![bytes.len() / number.size()], bytes }))
        }
        (Layout::VoxelFiles(_), Element::Bits(_)) => Ok(None),
        _ => read_npy(&place, MAX_BYTES).map(Some),
    }
}

fn ids_of_rows(rows: &Rows, numbers: &NumberArray) -> Option<IdCounts> {
    let [_, columns] = numbers.shape[..] else { return None };
    let table = rows.tables.iter().find(|table| table.columns.len() == columns)?;
    ids_of_column(numbers, columns, table.column(Column::Class)?)
}

fn ids_of_column(numbers: &NumberArray, columns: usize, at: usize) -> Option<IdCounts> {
    let ids: Vec<i64> = match numbers.number {
        NumberType::F16 | NumberType::F32 | NumberType::F64 => {
            numbers.floats().chunks_exact(columns).map(|row| row[at] as i64).collect()
        }
        _ => numbers.whole()?.chunks_exact(columns).map(|row| row[at]).collect(),
    };
    Some(count_runs(&ids))
}
