//! What colour a class is painted in.

use crate::noise::mix;

/// Classes of Occ3D-nuScenes in the colours of the nuScenes devkit's colour map; those of other
/// taxonomies that mean the same.
const KNOWN: [(&str, [u8; 3]); 18] = [
    ("others", [96, 96, 96]),
    ("barrier", [112, 128, 144]),
    ("bicycle", [220, 20, 60]),
    ("bus", [255, 127, 80]),
    ("car", [255, 158, 0]),
    ("construction_vehicle", [233, 150, 70]),
    ("motorcycle", [255, 61, 99]),
    ("pedestrian", [0, 0, 230]),
    ("traffic_cone", [47, 79, 79]),
    ("trailer", [255, 140, 0]),
    ("truck", [255, 99, 71]),
    ("driveable_surface", [0, 207, 191]),
    ("other_flat", [175, 0, 75]),
    ("sidewalk", [75, 0, 75]),
    ("terrain", [112, 180, 60]),
    ("manmade", [222, 184, 135]),
    ("building", [222, 184, 135]),
    ("vegetation", [0, 175, 0]),
];

/// The colour of a class, red, green, blue: the usual one of nuScenes' names, for any other name
/// one that follows from the name alone.
pub fn class_colour(name: &str) -> [u8; 3] {
    let known = KNOWN.iter().find(|(known, _)| *known == name);
    known.map_or_else(|| drawn(name), |(_, colour)| *colour)
}

/// Neither near black nor near white.
fn drawn(name: &str) -> [u8; 3] {
    let hash = name.bytes().fold(0, |hash, byte| mix(hash ^ u64::from(byte)));
    [0, 16, 32].map(|shift| 48 + ((hash >> shift) & 0xffff).wrapping_rem(176) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_classes_have_their_colours_and_others_one_of_their_own() {
        assert_eq!(class_colour("car"), [255, 158, 0]);
        let drawn = ["trunk", "pole", "cyclist", "rider"].map(class_colour);
        assert!((1..4).all(|at| !drawn[..at].contains(&drawn[at])), "{drawn:?}");
        assert_eq!(class_colour("pole"), drawn[1]);
    }
}
