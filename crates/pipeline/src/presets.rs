//! The presets and taxonomies that ship with the program.

use occlabel_core::{Fault, Taxonomy};

macro_rules! shipped {
    ($folder:literal: $($name:literal)*) => {
        &[$(($name, include_str!(concat!("../../../configs/", $folder, $name, ".toml")))),*]
    };
}

/// Presets by name, the default first.
pub const PRESETS: &[(&str, &str)] = shipped!(
    "": "precise" "paper" "occ3d-nuscenes" "occ3d-waymo" "occ3d-waymo-text" "panommocc" "mobileocc"
        "gs-occ3d"
);

/// Taxonomies by name.
pub const TAXONOMIES: &[(&str, &str)] = shipped!(
    "taxonomies/": "occ3d-nuscenes" "occ3d-waymo" "panommocc" "mobileocc" "semantickitti" "argoverse2"
        "occupancy" "coda"
);

/// What the pixels of masks mean in label sets that many segmenters speak, by name.
pub const MASK_TABLES: &[(&str, &str)] = shipped!("masks/": "cityscapes" "mapillary-vistas");

/// The text of a preset.
pub fn preset(name: &str) -> Option<&'static str> {
    find(PRESETS, name)
}

/// The text of a shipped taxonomy.
pub fn shipped_taxonomy(name: &str) -> Option<&'static str> {
    find(TAXONOMIES, name)
}

/// The text of a shipped table of masks.
pub fn shipped_masks(name: &str) -> Option<&'static str> {
    find(MASK_TABLES, name)
}

/// A taxonomy from the text of its file.
///
/// # Errors
/// If the text is no TOML, or the taxonomy contradicts itself.
pub fn parse_taxonomy(text: &str, place: &str) -> Result<Taxonomy, Fault> {
    toml::from_str(text).map_err(|error: toml::de::Error| {
        Fault::new("taxonomy", place, "a taxonomy file", error.message())
    })
}

fn find(list: &[(&str, &'static str)], name: &str) -> Option<&'static str> {
    list.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;
    use occlabel_core::MaskClasses;

    #[test]
    fn section_13_every_preset_states_every_key() {
        for (name, text) in PRESETS {
            Config::parse(text, name).unwrap_or_else(|fault| panic!("{fault}"));
        }
        assert_eq!(PRESETS[0].0, "precise");
    }

    #[test]
    fn section_5_shipped_masks_speak_of_known_classes() {
        let taxonomy = parse_taxonomy(shipped_taxonomy("mobileocc").unwrap(), "mobileocc").unwrap();
        let tables = MASK_TABLES.iter().map(|(name, text)| {
            let classes = MaskClasses::Table(toml::from_str(text).unwrap());
            let table = classes.table(&taxonomy).unwrap_or_else(|fault| panic!("{name}: {fault}"));
            (table.ids.len(), table.colours.len())
        });
        assert_eq!(tables.collect::<Vec<_>>(), [(34, 20), (66, 0)]);
    }

    #[test]
    fn section_7_the_taxonomies_are_as_listed_by_id() {
        let lists = |name: &str| {
            let taxonomy = parse_taxonomy(shipped_taxonomy(name).unwrap(), name).unwrap();
            let ids = |set: &occlabel_core::ClassSet| -> Vec<u8> {
                (0..=254).filter(|&id| set.contains(occlabel_core::ClassId(id))).collect()
            };
            let mut priority: Vec<u8> = (0..taxonomy.names.len() as u8).collect();
            priority.sort_by_key(|&id| taxonomy.rank[usize::from(id)]);
            let sets = [&taxonomy.things, &taxonomy.movers, &taxonomy.deformable, &taxonomy.flat];
            (sets.map(ids), priority, taxonomy.unknown.map(|class| class.0), taxonomy.free)
        };
        let (sets, priority, unknown, free) = lists("occ3d-nuscenes");
        assert_eq!(sets[0], [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
        assert_eq!(sets[1..], [vec![2, 3, 4, 5, 6, 7, 9, 10], vec![2, 6, 7], vec![11, 12, 13, 14]]);
        assert_eq!(priority, [7, 2, 6, 8, 1, 4, 10, 9, 3, 5, 15, 16, 11, 13, 12, 14, 0]);
        assert_eq!((unknown, free), (Some(0), 17));

        let (sets, priority, unknown, free) = lists("occ3d-waymo");
        assert_eq!(sets[0], [1, 2, 3, 4, 5, 6, 7, 8, 9]);
        assert_eq!(sets[1..], [vec![1, 2, 4], vec![2, 4], vec![13, 14]]);
        assert_eq!(priority, [2, 4, 8, 9, 7, 3, 5, 6, 1, 12, 10, 11, 13, 14, 0]);
        assert_eq!((unknown, free), (Some(0), 23));

        let (sets, priority, unknown, free) = lists("panommocc");
        assert_eq!(sets, [vec![0, 1, 2, 3], vec![0, 1, 2, 3], vec![1, 2, 3], vec![4, 5, 6]]);
        assert_eq!(priority, [3, 2, 1, 0, 11, 9, 8, 10, 7, 4, 5, 6]);
        assert_eq!((unknown, free), (None, 12));

        let (sets, priority, unknown, free) = lists("mobileocc");
        let riders: Vec<u8> = (11..=18).collect();
        assert_eq!(sets, [riders.clone(), riders, vec![11, 12, 17, 18], vec![0, 1, 9]]);
        assert_eq!(priority, [11, 12, 18, 17, 13, 14, 15, 16, 6, 7, 5, 4, 3, 2, 8, 9, 1, 0, 10]);
        assert_eq!((unknown, free), (None, 255));

        let (sets, priority, unknown, free) = lists("semantickitti");
        let riders = vec![2, 3, 6, 7, 8];
        assert_eq!(sets[0], [1, 2, 3, 4, 5, 6, 7, 8, 19]);
        assert_eq!(sets[1..], [(1..=8).collect(), riders, vec![9, 10, 11, 12, 17]]);
        let first = [6, 7, 8, 2, 3, 19, 18, 1, 4, 5, 16, 14, 13, 15, 9, 10, 11, 12, 17, 0];
        assert_eq!(priority, first);
        assert_eq!((unknown, free), (Some(0), 20));
    }
}
