//! What the pixels of masks mean: the key `paint.classes`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{ClassId, Fault, Meaning, Taxonomy};

/// The id of a pixel that shows nothing, where ids are the taxonomy's own.
const NO_CLASS: u8 = u8::MAX;

/// The word for pixels that show nothing.
const NONE: &str = "none";

/// What the pixels of masks mean: `"taxonomy"`, or a class's name for each id (`"7"`) or colour
/// (`"#804080"`). A table may be a file's: it is read before anything else is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged, expecting = "neither \"taxonomy\", a file, nor names of classes by id or colour")]
pub enum MaskClasses {
    /// `"taxonomy"`: ids are the taxonomy's own, 255 is none. Any other word: the file of a table.
    Word(String),
    /// Names of the taxonomy's classes or of its raw point labels, or `"none"`.
    Table(BTreeMap<String, String>),
}

/// The class of each id and colour that is known; `None`: it shows nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MaskTable {
    /// By the pixel's number.
    pub ids: BTreeMap<u16, Option<ClassId>>,
    /// By red, green and blue.
    pub colours: BTreeMap<[u8; 3], Option<ClassId>>,
}

impl MaskClasses {
    /// The table by a taxonomy.
    ///
    /// # Errors
    /// If a key is neither an id nor a colour, or a name is no class's.
    pub fn table(&self, taxonomy: &Taxonomy) -> Result<MaskTable, Fault> {
        match self {
            Self::Word(_) => Ok(own_ids(taxonomy)),
            Self::Table(names) => named(names, taxonomy),
        }
    }
}

/// The taxonomy's own ids.
fn own_ids(taxonomy: &Taxonomy) -> MaskTable {
    let classes = (0..taxonomy.names.len() as u8).map(|id| (id.into(), Some(ClassId(id))));
    MaskTable { ids: classes.chain([(NO_CLASS.into(), None)]).collect(), ..MaskTable::default() }
}

fn named(names: &BTreeMap<String, String>, taxonomy: &Taxonomy) -> Result<MaskTable, Fault> {
    let mut table = MaskTable::default();
    for (key, name) in names {
        let class = class_of(name, taxonomy).ok_or_else(|| {
            let expected = format!("`none`, or one of {}", taxonomy.names.join(", "));
            Fault::new("config", format!("paint.classes.{key}"), expected, format!("`{name}`"))
        })?;
        match (key.parse(), colour(key)) {
            (Ok(id), _) => drop(table.ids.insert(id, class)),
            (_, Some(colour)) => drop(table.colours.insert(colour, class)),
            _ => {
                let expected = "an id of 0 to 65535, or a colour such as \"#804080\"";
                return Err(Fault::new("config", "paint.classes", expected, format!("`{key}`")));
            }
        }
    }
    Ok(table)
}

/// A class by its own name, else by that of a raw point label.
fn class_of(name: &str, taxonomy: &Taxonomy) -> Option<Option<ClassId>> {
    let by_label = || match taxonomy.points.get(name)? {
        Meaning::Class(class) => Some(Some(*class)),
        Meaning::Ignore => Some(None),
    };
    match taxonomy.class_named(name) {
        _ if name == NONE => Some(None),
        Some(class) => Some(Some(class)),
        None => by_label(),
    }
}

/// Red, green and blue of `#rrggbb`.
fn colour(key: &str) -> Option<[u8; 3]> {
    let is_digit = |byte: u8| byte.is_ascii_hexdigit();
    let digits = key.strip_prefix('#').filter(|digits| digits.bytes().all(is_digit))?;
    let number = u32::from_str_radix(digits, 16).ok().filter(|_| digits.len() == 6)?;
    let [_, red, green, blue] = number.to_be_bytes();
    Some([red, green, blue])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ClassSet;

    fn taxonomy() -> Taxonomy {
        let car = [ClassId(1)].into_iter().collect();
        let (class, ignore) = (Meaning::Class(ClassId(1)), Meaning::Ignore);
        Taxonomy {
            names: vec!["road".into(), "car".into()],
            free: 9,
            unknown: None,
            things: car,
            movers: car,
            deformable: ClassSet::default(),
            flat: [ClassId(0)].into_iter().collect(),
            rank: vec![1, 0],
            points: [("vehicle.car".into(), class), ("noise".into(), ignore)].into(),
            boxes: BTreeMap::new(),
        }
    }

    fn table(names: &[(&str, &str)]) -> Result<MaskTable, Fault> {
        let own = |(key, name): &(&str, &str)| (key.to_string(), name.to_string());
        MaskClasses::Table(names.iter().map(own).collect()).table(&taxonomy())
    }

    #[test]
    fn a_table_goes_by_ids_and_colours_to_classes_raw_names_or_none() {
        let names = [("7", "road"), ("26", "vehicle.car"), ("0", "none"), ("#0A00ff", "noise")];
        let table = table(&names).unwrap();
        let ids = [(0, None), (7, Some(ClassId(0))), (26, Some(ClassId(1)))];
        assert_eq!(table.ids, ids.into());
        assert_eq!(table.colours, [([10, 0, 255], None)].into());
    }

    #[test]
    fn own_ids_are_the_taxonomys_and_255_is_none() {
        let table = MaskClasses::Word("taxonomy".into()).table(&taxonomy()).unwrap();
        let ids = [(0, Some(ClassId(0))), (1, Some(ClassId(1))), (255, None)];
        assert_eq!(table.ids, ids.into());
    }

    #[test]
    fn fault_26_a_class_that_no_taxonomy_has_is_refused_by_its_key() {
        let fault = table(&[("7", "sea")]).unwrap_err().to_string();
        assert!(fault.contains("paint.classes.7") && fault.contains("`sea`"), "{fault}");
        for key in ["-1", "65536", "#12345", "#1234567", "red", "#zzzzzz", "#+00000"] {
            assert!(table(&[(key, "road")]).is_err(), "{key}");
        }
    }
}
