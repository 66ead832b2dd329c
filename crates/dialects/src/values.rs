//! What numbers of a file mean, and back: classes, masks, objects, velocities.

use occlabel_labels::{NumberArray, NumberType};

use crate::class_table::UNKNOWN;
use crate::{ClassTable, IGNORED};

/// Why numbers have no meaning: what was expected, what was found.
pub(crate) type Refusal = (&'static str, String);

/// The index of each id.
pub(crate) fn classes(table: &ClassTable, array: &NumberArray) -> Result<Vec<u8>, Refusal> {
    let indices = table.indices();
    let known: Vec<u8> = match array.number {
        NumberType::U8 => {
            let indices = *indices.first_chunk::<256>().expect("an index of each id");
            array.bytes.iter().map(|&id| indices[usize::from(id)]).collect()
        }
        NumberType::U16 => {
            let ids = array.bytes.as_chunks().0.iter().map(|&id| u16::from_le_bytes(id));
            ids.map(|id| indices[usize::from(id)]).collect()
        }
        _ => {
            let ids = whole(array)?;
            let index = |id: &i64| usize::try_from(*id).ok().and_then(|id| indices.get(id));
            ids.iter().map(|id| index(id).copied().unwrap_or(UNKNOWN)).collect()
        }
    };
    match known.contains(&UNKNOWN) {
        true => Err(unknown(&known, &whole(array)?)),
        false => Ok(known),
    }
}

/// The lowest id that no class has, and how often it is there.
fn unknown(known: &[u8], ids: &[i64]) -> Refusal {
    let unknown = || ids.iter().zip(known).filter(|(_, index)| **index == UNKNOWN);
    let lowest = unknown().map(|(id, _)| *id).min().unwrap_or_default();
    let count = unknown().filter(|(id, _)| **id == lowest).count();
    ("ids of the dialect's classes", format!("id {lowest} in {count} voxels"))
}

/// The id of each index, free's where files have none for [`IGNORED`].
///
/// # Panics
/// If an index is that of no class, nor of free, nor [`IGNORED`].
pub(crate) fn ids(table: &ClassTable, indices: &[u8]) -> Vec<i64> {
    let is_known = |&index: &u8| index <= table.free_index() || index == IGNORED;
    assert!(indices.iter().all(is_known), "indices of the dialect's classes");
    let mut ids = [i64::from(table.free); 256];
    for index in (0..=table.free_index()).chain([IGNORED]) {
        ids[usize::from(index)] = i64::from(table.id_of(index).unwrap_or(table.free));
    }
    indices.iter().map(|&index| ids[usize::from(index)]).collect()
}

/// A mask of 0 and 1. Where there are -1, the numbers are states: -1 not observed, 0 free, 1
/// occupied (as `ccblublu/occ3d` writes its masks).
pub(crate) fn mask(array: NumberArray, inverted: bool) -> Result<Vec<u8>, Refusal> {
    let mut mask = match array.number {
        NumberType::Bool | NumberType::U8 => array.bytes,
        _ => {
            let numbers = whole(&array)?;
            let least = if numbers.contains(&-1) { 0 } else { 1 };
            let other = |number: &i64| !(-1..=1).contains(number);
            if let Some(other) = numbers.iter().find(|number| other(number)) {
                return Err(("0 and 1", other.to_string()));
            }
            numbers.iter().map(|&number| u8::from(number >= least)).collect()
        }
    };
    let highest = mask.iter().fold(0, |highest, &value| highest.max(value));
    if highest > 1 {
        return Err(("0 and 1", highest.to_string()));
    }
    mask.iter_mut().for_each(|value| *value ^= u8::from(inverted));
    Ok(mask)
}

/// The numbers of objects.
pub(crate) fn instances(array: &NumberArray) -> Result<Vec<u16>, Refusal> {
    let number = |&number: &i64| {
        u16::try_from(number).map_err(|_| ("numbers from 0 to 65535", number.to_string()))
    };
    whole(array)?.iter().map(number).collect()
}

/// Velocities of two or three components.
pub(crate) fn flow(array: &NumberArray, components: usize) -> Vec<[f32; 3]> {
    let vector = |vector: &[f64]| {
        let z = vector.get(2).copied().unwrap_or_default();
        [vector[0] as f32, vector[1] as f32, z as f32]
    };
    array.floats().chunks_exact(components).map(vector).collect()
}

pub(crate) fn whole(array: &NumberArray) -> Result<Vec<i64>, Refusal> {
    array.whole().ok_or_else(|| ("whole numbers", format!("'{}'", array.number.descr())))
}

/// Bits, eight in a byte, the first in the highest, as 0 and 1.
pub(crate) fn unpack(bytes: &[u8]) -> Vec<u8> {
    bytes.iter().flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1)).collect()
}

/// Numbers as bits: 1 for all that is not 0. The last byte is filled up with zeros.
pub(crate) fn pack(values: &[u8]) -> Vec<u8> {
    let byte = |bits: &[u8]| {
        let places = bits.iter().enumerate();
        places.fold(0, |byte, (at, &bit)| byte | u8::from(bit != 0) << (7 - at))
    };
    values.chunks(8).map(byte).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dialect;

    #[test]
    fn bits_begin_with_the_highest() {
        assert_eq!(pack(&[1, 0, 0, 0, 0, 0, 1, 0, 1]), [0b1000_0010, 0b1000_0000]);
        assert_eq!(unpack(&[0b1000_0010]), [1, 0, 0, 0, 0, 0, 1, 0]);
    }

    #[test]
    fn masks_are_zero_and_one_of_any_type_or_states() {
        let of = |values: &[i32]| mask(NumberArray::new(&[values.len()], values), false);
        assert_eq!(of(&[0, 1, 1]).unwrap(), [0, 1, 1]);
        assert_eq!(of(&[-1, 0, 1]).unwrap(), [0, 1, 1]);
        assert_eq!(of(&[0, 2]).unwrap_err().1, "2");
        assert_eq!(mask(NumberArray::new(&[2], &[0_u8, 3]), false).unwrap_err().1, "3");
        assert_eq!(mask(NumberArray::new(&[2], &[0_u8, 1]), true).unwrap(), [1, 0]);
    }

    #[test]
    fn an_id_of_no_class_is_told_with_its_count() {
        let table = Dialect::named("occ3d-nuscenes").unwrap().classes;
        let ids = [17_i32, 0, 18, 99, 18, 255];
        let refused = classes(&table, &NumberArray::new(&[6], &ids)).unwrap_err();
        assert_eq!(refused.1, "id 18 in 2 voxels");
        let bytes = NumberArray::new(&[3], &[17_u8, 16, 255]);
        assert_eq!(classes(&table, &bytes).unwrap(), [17, 16, 255]);
        assert_eq!(super::ids(&table, &[17, 16, 255]), [17, 16, 255]);
    }

    #[test]
    fn whatever_the_type_the_ids_mean_the_same() {
        let table = Dialect::named("semantickitti").unwrap().classes;
        let ids = [0_u16, 1, 10, 99, 252, 259];
        let expected = [33, 0, 1, 24, 25, 32];
        assert_eq!(classes(&table, &NumberArray::new(&[6], &ids)).unwrap(), expected);
        let wide = ids.map(i64::from);
        assert_eq!(classes(&table, &NumberArray::new(&[6], &wide)).unwrap(), expected);
        assert_eq!(super::ids(&table, &expected), wide);
    }
}
