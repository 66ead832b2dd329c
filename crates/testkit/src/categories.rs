//! The raw categories of nuScenes, in the order of their official lidarseg index.

/// A line each. Names are no code: the file is the simulator's too.
const NAMES: &str = include_str!("../../simulate/src/write/nuscenes/categories.txt");

/// Category names; the position is the lidarseg index.
pub(crate) fn categories() -> impl Iterator<Item = &'static str> {
    NAMES.lines()
}

/// The category of the recording car's own body.
pub(crate) const EGO: &str = "vehicle.ego";

pub(crate) const ADULT: &str = "human.pedestrian.adult";
pub(crate) const BARRIER: &str = "movable_object.barrier";
pub(crate) const CAR: &str = "vehicle.car";
pub(crate) const DRIVEABLE: &str = "flat.driveable_surface";
pub(crate) const MANMADE: &str = "static.manmade";
pub(crate) const SIDEWALK: &str = "flat.sidewalk";
pub(crate) const TERRAIN: &str = "flat.terrain";
pub(crate) const VEGETATION: &str = "static.vegetation";

/// The lidarseg index of a category; panics on a name that nuScenes does not have.
pub(crate) fn category_index(name: &str) -> usize {
    categories()
        .position(|known| known == name)
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
