//! Which classes are things, move, or are left out.

use occlabel_core::{ClassId, ClassSet, Fault};
use occlabel_dialects::ClassTable;

/// What moves by itself, as label sets name it: the eight classes of the CVPR 2024 challenge, and
/// their like in other sets.
const MOVERS: [&str; 21] = [
    "car",
    "truck",
    "trailer",
    "bus",
    "construction_vehicle",
    "bicycle",
    "motorcycle",
    "pedestrian",
    "vehicle",
    "cyclist",
    "person",
    "rider",
    "train",
    "bicyclist",
    "motorcyclist",
    "other-vehicle",
    "other_vehicle",
    "on-rails",
    "human",
    "animal",
    "caravan",
];

/// The classes that are named, or those that move by themselves.
///
/// # Errors
/// If a name is not in the table.
pub(crate) fn named(table: &ClassTable, names: Option<&[String]>) -> Result<ClassSet, Fault> {
    let known = table.names();
    let Some(names) = names else {
        let movers = known.iter().enumerate().filter(|(_, name)| MOVERS.contains(&name.as_str()));
        return Ok(movers.map(|(at, _)| ClassId(at as u8)).collect());
    };
    let id = |name: &String| {
        known.iter().position(|known| known == name).map(|at| ClassId(at as u8)).ok_or_else(|| {
            let expected = format!("classes of {}", known.join(", "));
            Fault::new("evaluate-class", "command line", expected, format!("`{name}`"))
        })
    };
    names.iter().map(id).collect()
}

/// The classes that scores leave out.
pub(crate) fn ignored(table: &ClassTable) -> ClassSet {
    let ignored = table.list.iter().enumerate().filter(|(_, class)| class.is_ignored);
    ignored.map(|(at, _)| ClassId(at as u8)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use occlabel_dialects::Class;

    fn table(names: &[&str]) -> ClassTable {
        let class = |(id, name): (u16, &&str)| Class {
            id,
            name: (*name).into(),
            is_ignored: *name == "noise",
            ..Class::default()
        };
        ClassTable { free: 99, no_label: None, list: (0..).zip(names).map(class).collect() }
    }

    #[test]
    fn classes_go_by_name() {
        let table = table(&["noise", "car", "road", "pedestrian"]);
        let set = |ids: &[u8]| ids.iter().map(|&id| ClassId(id)).collect();
        assert_eq!(named(&table, None), Ok(set(&[1, 3])));
        assert_eq!(named(&table, Some(&["road".into()])), Ok(set(&[2])));
        assert!(named(&table, Some(&["moon".into()])).unwrap_err().to_string().contains("moon"));
        assert_eq!(ignored(&table), set(&[0]));
    }
}
