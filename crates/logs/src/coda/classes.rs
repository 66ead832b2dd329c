//! Names of terrain.

/// Names by number (CODa's data report, "3D Semantic Segmentation Annotations"). 24, "Unknown", is a point
/// that its annotators could not tell, and as good as unlabelled.
const NAMES: [&str; 24] = [
    NO_TERRAIN,
    "Concrete",
    "Grass",
    "Rocks",
    "Speedway Bricks",
    "Red Bricks",
    "Pebble Pavement",
    "Light Marble Tiling",
    "Dark Marble Tiling",
    "Dirt Paths",
    "Road Pavement",
    "Short Vegetation",
    "Porcelain Tile",
    "Metal Grates",
    "Blond Marble Tiling",
    "Wood Panel",
    "Patterned Tile",
    "Carpet",
    "Crosswalk",
    "Dome Mat",
    "Stairs",
    "Door Mat",
    "Threshold",
    "Metal Floor",
];
/// The number of a point that nobody could tell.
const UNKNOWN: i64 = 24;
/// What stands on the terrain: everything that the format labels no further.
pub(super) const NO_TERRAIN: &str = "Unlabeled";

/// What a label is called, its number if it has no name; none where it says nothing of the point.
///
/// `Unlabeled` says that a point is no terrain, which is something where the taxonomy has a class for
/// it, and nothing else.
pub(super) fn label_name(raw: i64, names_no_terrain: bool) -> Option<String> {
    let name = usize::try_from(raw).ok().and_then(|raw| NAMES.get(raw).copied());
    let says_nothing = raw == UNKNOWN || (name == Some(NO_TERRAIN) && !names_no_terrain);
    (!says_nothing).then(|| name.map_or_else(|| raw.to_string(), str::to_owned))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_goes_by_its_name_or_its_number() {
        let named = |raw| label_name(raw, true);
        assert_eq!(named(10).as_deref(), Some("Road Pavement"));
        assert_eq!(named(23).as_deref(), Some("Metal Floor"));
        assert_eq!(named(25).as_deref(), Some("25"));
        assert_eq!(named(24), None);
        assert_eq!(named(0).as_deref(), Some("Unlabeled"));
        assert_eq!(label_name(0, false), None);
    }
}
