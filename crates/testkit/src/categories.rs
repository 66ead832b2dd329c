//! The raw categories of nuScenes, in the order of their official lidarseg index.

/// Category names; the position is the lidarseg index.
pub const CATEGORIES: [&str; 32] = [
    "noise",
    "animal",
    "human.pedestrian.adult",
    "human.pedestrian.child",
    "human.pedestrian.construction_worker",
    "human.pedestrian.personal_mobility",
    "human.pedestrian.police_officer",
    "human.pedestrian.stroller",
    "human.pedestrian.wheelchair",
    "movable_object.barrier",
    "movable_object.debris",
    "movable_object.pushable_pullable",
    "movable_object.trafficcone",
    "static_object.bicycle_rack",
    "vehicle.bicycle",
    "vehicle.bus.bendy",
    "vehicle.bus.rigid",
    "vehicle.car",
    "vehicle.construction",
    "vehicle.emergency.ambulance",
    "vehicle.emergency.police",
    "vehicle.motorcycle",
    "vehicle.trailer",
    "vehicle.truck",
    "flat.driveable_surface",
    "flat.other",
    "flat.sidewalk",
    "flat.terrain",
    "static.manmade",
    "static.other",
    "static.vegetation",
    EGO,
];

/// The category of the recording car's own body.
pub const EGO: &str = "vehicle.ego";

pub(crate) const ADULT: &str = "human.pedestrian.adult";
pub(crate) const BARRIER: &str = "movable_object.barrier";
pub(crate) const CAR: &str = "vehicle.car";
pub(crate) const DRIVEABLE: &str = "flat.driveable_surface";
pub(crate) const MANMADE: &str = "static.manmade";
pub(crate) const SIDEWALK: &str = "flat.sidewalk";
pub(crate) const TERRAIN: &str = "flat.terrain";
pub(crate) const VEGETATION: &str = "static.vegetation";

/// The lidarseg index of a category; panics on a name that nuScenes does not have.
pub fn category_index(name: &str) -> usize {
    CATEGORIES
        .iter()
        .position(|known| *known == name)
        .unwrap_or_else(|| panic!("{name} is no nuScenes category"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_the_official_ones() {
        assert_eq!(category_index(CAR), 17);
        assert_eq!(category_index(DRIVEABLE), 24);
        assert_eq!(category_index(VEGETATION), 30);
        assert_eq!(category_index(EGO), 31);
    }
}
