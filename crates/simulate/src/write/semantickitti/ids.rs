//! SemanticKITTI's label ids (semantic-kitti-api, `config/semantic-kitti.yaml`).

const UNLABELED: u16 = 0;

/// Raw names of the shipped taxonomies, the id of what stands, and of what moves.
const IDS: &[(&[&str], u16, u16)] = &[
    (&["noise", "vehicle.ego"], 1, 1),
    (&["vehicle.car", "vehicle.emergency.police", "car", "CAR", "vehicle", "VEHICLE"], 10, 252),
    (&["vehicle.bicycle", "bicycle", "BICYCLE"], 11, 253),
    (&["vehicle.bus.bendy", "vehicle.bus.rigid", "bus", "BUS"], 13, 257),
    (&["vehicle.motorcycle", "motorcycle", "MOTORCYCLE"], 15, 255),
    (&["train"], 16, 256),
    (&["vehicle.truck", "truck", "TRUCK"], 18, 258),
    (&["vehicle.construction", "vehicle.emergency.ambulance", "vehicle.trailer"], 20, 259),
    (&["OTHER_VEHICLE"], 20, 259),
    (&["human.pedestrian.adult", "human.pedestrian.child", "pedestrian", "person"], 30, 254),
    (&["human.pedestrian.construction_worker", "human.pedestrian.police_officer"], 30, 254),
    (&["human.pedestrian.personal_mobility", "human.pedestrian.stroller", "PEDESTRIAN"], 30, 254),
    (&["human.pedestrian.wheelchair"], 30, 254),
    (&["rider", "cyclist", "CYCLIST", "BICYCLIST"], 31, 253),
    (&["MOTORCYCLIST"], 32, 255),
    (&["flat.driveable_surface", "driveable_surface", "road", "ROAD"], 40, 40),
    (&["flat.sidewalk", "sidewalk", "walkable", "SIDEWALK", "WALKABLE", "CURB"], 48, 48),
    (&["flat.other", "OTHER_GROUND"], 49, 49),
    (&["static.manmade", "building", "manmade", "BUILDING"], 50, 50),
    (&["movable_object.barrier", "barrier", "fence", "wall"], 51, 51),
    (&["static.other", "static_object.bicycle_rack"], 52, 52),
    (&["LANE_MARKER"], 60, 60),
    (&["static.vegetation", "vegetation", "VEGETATION"], 70, 70),
    (&["tree_trunk", "TREE_TRUNK"], 71, 71),
    (&["flat.terrain", "terrain"], 72, 72),
    (&["pole", "pillar", "POLE"], 80, 80),
    (&["sign", "traffic sign", "traffic light", "traffic_light", "SIGN", "TRAFFIC_LIGHT"], 81, 81),
    (&["animal", "movable_object.debris", "movable_object.pushable_pullable"], 99, 99),
    (&["movable_object.trafficcone", "construction_cone", "CONSTRUCTION_CONE"], 99, 99),
    (&["general_object"], 99, 99),
];

/// The id of a raw name; 0, unlabeled, if SemanticKITTI has nothing of the kind.
pub(super) fn id(name: &str, moving: bool) -> u16 {
    let known = IDS.iter().find(|(names, ..)| names.contains(&name));
    known.map_or(UNLABELED, |&(_, still, moves)| if moving { moves } else { still })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_stands_once_and_ids_are_those_of_the_benchmark() {
        let names: Vec<_> = IDS.iter().flat_map(|(names, ..)| *names).collect();
        assert!((1..names.len()).all(|at| !names[..at].contains(&names[at])), "{names:?}");
        assert_eq!((id("vehicle.car", false), id("vehicle.car", true)), (10, 252));
        assert_eq!((id("flat.sidewalk", false), id("jelly", true)), (48, 0));
    }
}
