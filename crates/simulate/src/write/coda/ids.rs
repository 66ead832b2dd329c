//! CODa's terrain and categories (its data report, "Annotation File Format").

/// What stands on the terrain.
const NO_TERRAIN: u8 = 0;
/// What annotators could not tell.
const UNKNOWN: u8 = 24;
/// A category for what has none.
const OTHER: &str = "Other";

/// Raw names of the shipped taxonomies that are terrain, and its number.
const TERRAIN: &[(&[&str], u8)] = &[
    // Concrete, Grass, Road Pavement, Short Vegetation, Metal Floor
    (&["flat.sidewalk", "sidewalk", "walkable", "SIDEWALK", "WALKABLE", "CURB"], 1),
    (&["flat.terrain", "terrain"], 2),
    (&["flat.driveable_surface", "driveable_surface", "road", "ROAD", "LANE_MARKER"], 10),
    (&["flat.other", "OTHER_GROUND"], 23),
    // Nothing of the world, or nothing that is known of it.
    (&["", "noise", "vehicle.ego"], UNKNOWN),
];

/// Raw names of the shipped taxonomies, and what a box of it is called.
const CATEGORIES: &[(&[&str], &str)] = &[
    (&["vehicle.car", "vehicle.emergency.police", "car", "CAR", "vehicle", "VEHICLE"], "Car"),
    (&["vehicle.truck", "vehicle.construction", "vehicle.emergency.ambulance"], "Truck"),
    (&["vehicle.trailer", "truck", "TRUCK", "OTHER_VEHICLE"], "Truck"),
    (&["vehicle.bus.bendy", "vehicle.bus.rigid", "bus", "BUS"], "Bus"),
    (&["vehicle.motorcycle", "motorcycle", "MOTORCYCLE", "MOTORCYCLIST"], "Motorcycle"),
    (&["vehicle.bicycle", "bicycle", "BICYCLE", "BICYCLIST"], "Bike"),
    (&["rider", "cyclist", "CYCLIST"], "Bike"),
    (&["human.pedestrian.adult", "human.pedestrian.child", "pedestrian", "person"], "Pedestrian"),
    (&["human.pedestrian.construction_worker", "human.pedestrian.police_officer"], "Pedestrian"),
    (&["human.pedestrian.personal_mobility", "human.pedestrian.stroller"], "Pedestrian"),
    (&["human.pedestrian.wheelchair", "PEDESTRIAN"], "Pedestrian"),
    (&["animal"], "Horse"),
    (&["movable_object.barrier", "barrier"], "Construction Barrier"),
    (&["movable_object.trafficcone", "construction_cone", "CONSTRUCTION_CONE"], "Cone"),
    (&["static_object.bicycle_rack"], "Bike Rack"),
    (&["fence", "wall"], "Fence"),
    (&["pole", "pillar", "POLE"], "Pole"),
    (&["sign", "traffic sign", "SIGN"], "Traffic Sign"),
    (&["traffic light", "traffic_light", "TRAFFIC_LIGHT"], "Traffic Light"),
];

/// The number of a point's raw name, which is empty if it has none.
pub(super) fn terrain(name: &str) -> u8 {
    let known = TERRAIN.iter().find(|(names, _)| names.contains(&name));
    known.map_or(NO_TERRAIN, |(_, number)| *number)
}

/// What a box of a raw name is called.
pub(super) fn category(name: &str) -> &'static str {
    let known = CATEGORIES.iter().find(|(names, _)| names.contains(&name));
    known.map_or(OTHER, |(_, category)| category)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_stands_once() {
        let terrain: Vec<_> = TERRAIN.iter().flat_map(|(names, _)| *names).collect();
        let boxed: Vec<_> = CATEGORIES.iter().flat_map(|(names, _)| *names).collect();
        for names in [&terrain, &boxed] {
            assert!((1..names.len()).all(|at| !names[..at].contains(&names[at])), "{names:?}");
        }
        assert_eq!(
            [super::terrain("road"), super::terrain("building"), super::terrain("")],
            [10, 0, 24]
        );
        assert_eq!([category("vehicle.car"), category("jelly")], ["Car", "Other"]);
    }
}
