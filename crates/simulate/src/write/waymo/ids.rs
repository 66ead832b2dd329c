//! Waymo's numbers of point classes (`Segmentation.Type`), of box types (`Label.Type`), and of
//! sensors (`LaserName.Name`, `CameraName.Name`).

/// Raw names of the shipped taxonomies, by point class.
const CLASSES: &[(i32, &[&str])] = &[
    (1, &["CAR", "car", "vehicle", "vehicle.car", "vehicle.emergency.police"]),
    (2, &["TRUCK", "truck", "vehicle.truck", "large_vehicle"]),
    (3, &["BUS", "bus", "vehicle.bus.bendy", "vehicle.bus.rigid"]),
    (4, &["OTHER_VEHICLE", "train", "vehicle.construction", "vehicle.emergency.ambulance"]),
    (4, &["vehicle.trailer", "wheeled_device", "other-vehicle"]),
    (5, &["MOTORCYCLIST", "motorcyclist"]),
    (6, &["BICYCLIST", "bicyclist", "cyclist", "rider"]),
    (
        7,
        &["PEDESTRIAN", "pedestrian", "person", "human.pedestrian.adult", "human.pedestrian.child"],
    ),
    (7, &["human.pedestrian.construction_worker", "human.pedestrian.personal_mobility"]),
    (7, &["human.pedestrian.police_officer", "human.pedestrian.stroller"]),
    (7, &["human.pedestrian.wheelchair"]),
    (8, &["SIGN", "sign", "traffic sign", "traffic-sign"]),
    (9, &["TRAFFIC_LIGHT", "traffic_light", "traffic light"]),
    (10, &["POLE", "pole", "pillar"]),
    (11, &["CONSTRUCTION_CONE", "construction_cone", "movable_object.trafficcone"]),
    (12, &["BICYCLE", "bicycle", "vehicle.bicycle"]),
    (13, &["MOTORCYCLE", "motorcycle", "vehicle.motorcycle"]),
    (14, &["BUILDING", "building", "manmade", "wall", "fence", "static.manmade"]),
    (15, &["VEGETATION", "vegetation", "static.vegetation"]),
    (16, &["TREE_TRUNK", "tree_trunk", "trunk"]),
    (17, &["CURB"]),
    (18, &["ROAD", "road", "parking", "driveable_surface", "flat.driveable_surface"]),
    (19, &["LANE_MARKER"]),
    (20, &["OTHER_GROUND"]),
    (21, &["WALKABLE", "walkable", "terrain", "other-ground", "flat.other", "flat.terrain"]),
    (22, &["SIDEWALK", "sidewalk", "flat.sidewalk"]),
];

/// The point class of a raw name, or of a number that stands for one; 0, undefined, if the format
/// has nothing of the kind.
pub(super) fn class(name: &str) -> i32 {
    let known = CLASSES.iter().find(|(_, names)| names.contains(&name));
    known.map(|(class, _)| *class).or_else(|| name.parse().ok()).unwrap_or(0)
}

/// The box type of a category, or of a number that stands for one; none if the format boxes nothing
/// of the kind.
pub(super) fn box_type(category: &str) -> Option<u64> {
    match (category, class(category)) {
        ("VEHICLE" | "1", _) => Some(1),
        ("2", _) => Some(2),
        ("3", _) => Some(3),
        ("CYCLIST" | "4", _) => Some(4),
        (_, 1..=4) => Some(1),
        (_, 7) => Some(2),
        (_, 8) => Some(3),
        // A cycle is boxed together with its rider.
        (_, 5 | 6 | 12 | 13) => Some(4),
        _ => None,
    }
}

/// The name of the lidar with a pose for each pixel, and with labels.
pub(super) const TOP: &str = "TOP";
/// Names of lidars by number, from 1.
pub(super) const LIDARS: &[&str] = &[TOP, "FRONT", "SIDE_LEFT", "SIDE_RIGHT", "REAR"];
/// Names of cameras by number, from 1.
pub(super) const CAMERAS: &[&str] = &[
    "FRONT",
    "FRONT_LEFT",
    "FRONT_RIGHT",
    "SIDE_LEFT",
    "SIDE_RIGHT",
    "REAR_LEFT",
    "REAR",
    "REAR_RIGHT",
];

/// A number for each sensor: that of its own name if the format knows it (CAM_BACK is REAR), else
/// the next that is free. None if there are more sensors than names.
pub(super) fn numbers(sensors: &[&str], names: &[&str]) -> Option<Vec<u64>> {
    let known = |sensor: &&str| {
        let bare = sensor.trim_start_matches("CAM_").trim_start_matches("LIDAR_");
        let name = bare.replace("BACK", "REAR");
        names.iter().position(|known| *known == name)
    };
    let mut taken: Vec<Option<usize>> = sensors.iter().map(known).collect();
    for at in 0..taken.len() {
        if taken[at].is_none() || taken[..at].contains(&taken[at]) {
            taken[at] = Some((0..names.len()).find(|free| !taken.contains(&Some(*free)))?);
        }
    }
    Some(taken.into_iter().flatten().map(|place| place as u64 + 1).collect())
}

#[cfg(test)]
mod tests {
    use occlabel_core::Meaning;
    use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};

    use super::*;

    #[test]
    fn every_name_stands_once_and_ids_are_those_of_the_format() {
        let names: Vec<_> = CLASSES.iter().flat_map(|(_, names)| *names).collect();
        assert!((1..names.len()).all(|at| !names[..at].contains(&names[at])), "{names:?}");
        assert_eq!(["CAR", "SIDEWALK", "17", "UNDEFINED", "jelly"].map(class), [1, 22, 17, 0, 0]);
        let boxed = ["vehicle.trailer", "person", "traffic sign", "vehicle.bicycle", "4", "POLE"];
        assert_eq!(boxed.map(box_type), [Some(1), Some(2), Some(3), Some(4), Some(4), None]);
    }

    #[test]
    fn ids_mean_what_the_names_that_they_stand_for_mean() {
        let text = shipped_taxonomy("occ3d-waymo").unwrap();
        let taxonomy = parse_taxonomy(text, "occ3d-waymo").unwrap();
        let points = taxonomy.points.iter().filter(|(_, meaning)| **meaning != Meaning::Ignore);
        for (name, meaning) in points.clone() {
            assert_eq!(taxonomy.points.get(&class(name).to_string()), Some(meaning), "{name}");
        }
        let boxed = taxonomy.boxes.iter().filter_map(|(name, meaning)| {
            box_type(name).map(|kind| (name, meaning, kind.to_string()))
        });
        for (name, meaning, kind) in boxed.clone() {
            assert_eq!(taxonomy.boxes.get(&kind), Some(meaning), "{name}");
        }
        assert!(points.count() > 80 && boxed.count() > 25);
    }

    #[test]
    fn sensors_keep_their_names_and_others_take_what_is_free() {
        let cameras = ["CAM_FRONT", "CAM_BACK_LEFT", "PANORAMA", "CAM_BACK", "FRONT"];
        assert_eq!(numbers(&cameras, CAMERAS), Some(vec![1, 6, 2, 7, 3]));
        assert_eq!(numbers(&["LIDAR_TOP", "REAR", "L3"], LIDARS), Some(vec![1, 5, 2]));
        assert_eq!(numbers(&["a", "b", "c", "d", "e", "f"], LIDARS), None);
    }
}
