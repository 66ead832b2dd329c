//! Which classes are things, move, or are left out.

use occlabel_core::{ClassId, ClassSet, Fault};
use occlabel_dialects::{Class, ClassTable, Concepts};

/// What moves by itself, with all that is narrower: in nuScenes the eight classes whose velocity the
/// challenge of 2024 asks for.
const MOVERS: [&str; 4] = ["vehicle", "two_wheeler", "person", "animal"];

/// The classes that are named, or those that move by themselves.
///
/// # Errors
/// If a name is not in the table.
pub(crate) fn named(table: &ClassTable, names: Option<&[String]>) -> Result<ClassSet, Fault> {
    let known = table.names();
    let Some(names) = names else {
        let movers = table.list.iter().enumerate().filter(|(_, class)| moves(class));
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

fn moves(class: &Class) -> bool {
    let above = |concept| std::iter::once(concept).chain(Concepts::shipped().above(concept));
    let mut meanings = class.concept().into_iter().flat_map(above);
    meanings.any(|meaning| MOVERS.contains(&meaning))
}

/// The classes that scores leave out.
pub(crate) fn ignored(table: &ClassTable) -> ClassSet {
    let ignored = table.list.iter().enumerate().filter(|(_, class)| class.is_ignored);
    ignored.map(|(at, _)| ClassId(at as u8)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use occlabel_dialects::Dialect;

    fn table(names: &[&str]) -> ClassTable {
        let class = |(id, name): (u16, &&str)| Class {
            id,
            name: (*name).into(),
            concept: None,
            is_ignored: *name == "noise",
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

    #[test]
    fn what_moves_in_nuscenes_is_what_the_challenge_asks_for() {
        let table = Dialect::named("occ3d-nuscenes").unwrap().classes;
        let movers = named(&table, None).unwrap();
        let names = table.names();
        let found = (0..names.len()).filter(|&at| movers.contains(ClassId(at as u8)));
        let found: Vec<&str> = found.map(|at| names[at].as_str()).collect();
        let asked = [
            "bicycle",
            "bus",
            "car",
            "construction_vehicle",
            "motorcycle",
            "pedestrian",
            "trailer",
            "truck",
        ];
        assert_eq!(found, asked);
    }
}
