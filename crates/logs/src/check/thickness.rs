//! How thick the ground comes out when all sweeps are laid over each other.

use std::collections::BTreeMap;

use nalgebra::Point3;
use occlabel_core::SweepHeader;

use super::plane::Plane;

/// Side of the cells in which heights are compared, metres.
const CELL_M: f64 = 1.0;
/// Points up to this far from the level plane are ground, metres: kerbs and bumps are.
const GROUND_M: f64 = 0.3;
/// Ground is looked at up to this distance from the sensor, metres.
const REACH_M: f64 = 20.0;

/// A cell of the world, by its place east and north.
type Cell = (i64, i64);

/// The ground's height in each cell that a sweep sees, world frame, metres.
pub(super) fn ground_heights(
    sweep: &SweepHeader,
    points: &[Point3<f64>],
    level: &Plane,
) -> BTreeMap<Cell, f32> {
    let eye = sweep.ego_from_lidar * Point3::origin();
    let mut sums: BTreeMap<Cell, (f64, u32)> = BTreeMap::new();
    let is_ground =
        |p: &&Point3<f64>| level.height_m(p).abs() <= GROUND_M && (*p - eye).norm() <= REACH_M;
    for p in points.iter().filter(is_ground) {
        let p = sweep.world_from_ego * p;
        let cell = ((p.x / CELL_M).floor() as i64, (p.y / CELL_M).floor() as i64);
        let (sum, count) = sums.entry(cell).or_default();
        (*sum, *count) = (*sum + p.z, *count + 1);
    }
    sums.into_iter().map(|(cell, (sum, count))| (cell, (sum / f64::from(count)) as f32)).collect()
}

/// The ground's heights by cell, sweep after sweep.
#[derive(Debug, Default)]
pub(super) struct Thickness {
    heights_m: BTreeMap<Cell, Vec<f32>>,
}

impl Thickness {
    /// Adds a sweep's.
    pub(super) fn add(&mut self, sweep: BTreeMap<Cell, f32>) {
        for (cell, height_m) in sweep {
            self.heights_m.entry(cell).or_default().push(height_m);
        }
    }

    /// How far the sweeps differ about the height of a cell: the median over the cells that several
    /// sweeps saw of the middle four fifths of their heights, metres.
    pub(super) fn median_m(&self) -> Option<f64> {
        let several = self.heights_m.values().filter(|heights| heights.len() > 1);
        let mut spreads: Vec<f32> = several.map(|heights| spread_m(heights)).collect();
        spreads.sort_by(f32::total_cmp);
        spreads.get(spreads.len() / 2).map(|spread| f64::from(*spread))
    }
}

fn spread_m(heights_m: &[f32]) -> f32 {
    let mut heights = heights_m.to_vec();
    heights.sort_by(f32::total_cmp);
    let cut = heights.len() / 10;
    heights[heights.len() - 1 - cut] - heights[cut]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::test_drive::{pose, straight};

    /// What a drive up a slope of 5 % leaves, with heights in its poses or without.
    fn thickness_m(slope: f64) -> f64 {
        let ground =
            (0..900).map(|i| Point3::new(f64::from(i % 30), f64::from(i / 30) - 15.0, 0.0));
        let ground: Vec<_> = ground.collect();
        let mut thickness = Thickness::default();
        for mut sweep in straight(20, 10.0) {
            let x_m = sweep.world_from_ego.translation.x;
            sweep.world_from_ego = pose([x_m, 0.0, slope * x_m], [0.0; 3]);
            thickness.add(ground_heights(&sweep, &ground, &Plane::LEVEL));
        }
        thickness.median_m().expect("cells that several sweeps saw")
    }

    #[test]
    fn fault_20_sweeps_that_do_not_fit_make_the_ground_thick() {
        assert!(thickness_m(0.0) < 1e-6, "a flat road");
        // Half of the cells are seen over 10 of the 19 m: at 5 % that is 0.5 m, four fifths of it 0.4.
        let thick_m = thickness_m(0.05);
        assert!((0.35..0.45).contains(&thick_m), "{thick_m}");
    }

    #[test]
    fn one_sweep_tells_no_thickness_and_a_tenth_may_be_wrong() {
        let mut thickness = Thickness::default();
        thickness.add(BTreeMap::from([((0, 0), 1.0)]));
        assert_eq!(thickness.median_m(), None);
        assert_eq!(spread_m(&[0.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 9.0]), 0.0);
        assert_eq!(spread_m(&[2.0, 5.0, 3.0]), 3.0);
    }
}
