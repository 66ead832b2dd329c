//! The boxes of a sweep, and which of them claims a point.

use nalgebra::Point3;
use occlabel_core::{
    Box3, BoxGrowth, ClassId, GrownBox, ObjectSweep, PointCloud, RigidMap, Timestamp, TrackId,
};

use crate::TrackBox;

/// Columns of the map on a side.
const SIDE: usize = 64;

/// All boxes of a sweep's time, each with the points put into it so far.
pub(crate) struct Cabinet<'a> {
    /// The one that claims a point before others first: the smallest, then the lower id.
    drawers: Vec<Drawer<'a>>,
    map: Map,
    /// By the column of the map: the drawers that may claim a point there, in their order.
    columns: Vec<Vec<u32>>,
}

impl<'a> Cabinet<'a> {
    pub(crate) fn new(boxes: &'a [TrackBox], growth: &BoxGrowth) -> Self {
        let mut drawers: Vec<_> = boxes.iter().map(|boxed| Drawer::new(boxed, growth)).collect();
        drawers.sort_by(|a, b| {
            a.boxed.volume().total_cmp(&b.boxed.volume()).then(a.track.cmp(&b.track))
        });
        let map = Map::around(&drawers);
        let mut columns = vec![Vec::new(); SIDE * SIDE];
        for (number, drawer) in (0..).zip(&drawers) {
            let [low, high] = drawer.reach().map(|corner| map.place(&corner));
            for x in low[0]..=high[0] {
                (low[1]..=high[1]).for_each(|y| columns[x * SIDE + y].push(number));
            }
        }
        Self { drawers, map, columns }
    }

    /// The box that claims a point in world, and the point in that box's coordinates.
    #[inline]
    pub(crate) fn claim(
        &mut self,
        position: &Point3<f64>,
    ) -> Option<(Point3<f64>, &mut Drawer<'a>)> {
        let [x, y] = self.map.place(position);
        let near = self.columns[x * SIDE + y].iter().map(|number| *number as usize);
        let (in_box, number) = near
            .filter_map(|number| Some((self.drawers[number].claim(position)?, number)))
            .next()?;
        Some((in_box, &mut self.drawers[number]))
    }

    /// What was put into the boxes, one entry for each that holds any.
    pub(crate) fn close(self, time: Timestamp) -> Vec<ObjectSweep> {
        self.drawers.into_iter().filter_map(|drawer| drawer.close(time)).collect()
    }
}

/// Squares over the ground. What lies outside belongs to the nearest one: a place never goes down
/// when a coordinate goes up, so a point between two corners stands between their places.
struct Map {
    low: [f64; 2],
    per_m: [f64; 2],
}

impl Map {
    /// Over all that the drawers reach.
    fn around(drawers: &[Drawer]) -> Self {
        let ends = |axis: usize| {
            let reaches = drawers.iter().map(|drawer| drawer.reach().map(|corner| corner[axis]));
            reaches.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or_default()
        };
        let [x, y] = [ends(0), ends(1)];
        let per_m = |[low, high]: [f64; 2]| SIDE as f64 / (high - low).max(1.0);
        Self { low: [x[0], y[0]], per_m: [per_m(x), per_m(y)] }
    }

    #[inline]
    fn place(&self, position: &Point3<f64>) -> [usize; 2] {
        let place = |metres: f64, axis: usize| {
            let place = (metres - self.low[axis]) * self.per_m[axis];
            (place as usize).min(SIDE - 1)
        };
        [place(position.x, 0), place(position.y, 1)]
    }
}

/// A track's box and the points put into it so far.
pub(crate) struct Drawer<'a> {
    track: TrackId,
    class: Option<ClassId>,
    boxed: &'a Box3,
    grown: GrownBox,
    centre: Point3<f64>,
    reach_m: f64,
    box_from_world: RigidMap,
    cloud: PointCloud<ClassId>,
    /// The sweep's own number of the origin pushed last.
    last_origin: Option<u32>,
}

impl<'a> Drawer<'a> {
    fn new(boxed: &'a TrackBox, growth: &BoxGrowth) -> Self {
        let grown = GrownBox::new(&boxed.boxed.size_m, growth);
        let world_from_box = &boxed.boxed.world_from_box;
        Self {
            track: boxed.track,
            class: boxed.class,
            boxed: &boxed.boxed,
            grown,
            centre: world_from_box.translation.vector.into(),
            reach_m: grown.radius() + 1e-6,
            box_from_world: RigidMap::from(&world_from_box.inverse()),
            cloud: PointCloud::with_origins(Vec::new()),
            last_origin: None,
        }
    }

    /// The point in box coordinates, if it is inside.
    #[inline]
    fn claim(&self, position: &Point3<f64>) -> Option<Point3<f64>> {
        if (position - self.centre).norm_squared() > self.reach_m * self.reach_m {
            return None;
        }
        let in_box = self.box_from_world.apply(position);
        self.grown.contains(&in_box).then_some(in_box)
    }

    /// Whether its track's category means `ignore`.
    pub(crate) fn is_ignored(&self) -> bool {
        self.class.is_none()
    }

    /// Two corners between which all that it claims lies, in world.
    fn reach(&self) -> [Point3<f64>; 2] {
        let reach = nalgebra::Vector3::repeat(self.reach_m);
        [self.centre - reach, self.centre + reach]
    }

    /// Adds a point whose ray comes from the sweep's `origin`.
    pub(crate) fn put(&mut self, in_box: Point3<f64>, world_origins: &[Point3<f64>], origin: u32) {
        let Some(class) = self.class else { return };
        if self.last_origin != Some(origin) {
            self.last_origin = Some(origin);
            let in_world = &world_origins[origin as usize];
            self.cloud.origins.push(self.box_from_world.apply(in_world));
        }
        self.cloud.push(in_box, class, self.cloud.origins.len() as u32 - 1);
    }

    fn close(self, time: Timestamp) -> Option<ObjectSweep> {
        (!self.cloud.is_empty()).then(|| ObjectSweep {
            track: self.track,
            time: Some(time),
            boxed: self.boxed.clone(),
            cloud: self.cloud,
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};
    use occlabel_core::Pose;

    use super::*;

    /// Numbers in 0..1, the same in every run.
    struct Dice(u64);

    impl Dice {
        fn roll(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn point(&mut self, spread_m: f64) -> Point3<f64> {
            Point3::from([spread_m, spread_m, 4.0].map(|spread_m| (self.roll() - 0.5) * spread_m))
        }

        fn track_box(&mut self, track: u16, spread_m: f64) -> TrackBox {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.roll() * 7.0);
            let world_from_box = Pose::from_parts(self.point(spread_m).into(), turn);
            let size_m = Vector3::from([8.0, 3.0, 3.0].map(|most| 0.5 + self.roll() * most));
            TrackBox {
                track: TrackId(track),
                class: Some(ClassId(4)),
                boxed: Box3 { world_from_box, size_m },
            }
        }
    }

    /// Every box, one after the other.
    fn slow(cabinet: &Cabinet, position: &Point3<f64>) -> Option<(Point3<f64>, TrackId)> {
        cabinet.drawers.iter().find_map(|drawer| Some((drawer.claim(position)?, drawer.track)))
    }

    #[test]
    fn fault_24_the_map_finds_the_box_that_asking_all_of_them_finds() {
        let (mut dice, mut claimed, mut free) = (Dice(7), 0, 0);
        let growth = BoxGrowth { scale: 1.1, margin_m: 0.1 };
        for (count, spread_m) in [(0, 1.0), (1, 1.0), (40, 30.0), (200, 100.0), (60, 1e5)] {
            let boxes: Vec<_> = (0..count).map(|track| dice.track_box(track, spread_m)).collect();
            let mut cabinet = Cabinet::new(&boxes, &growth);
            for turn in 0..4000 {
                let beside = dice.point(9.0).coords;
                let near = boxes.get(turn % 7).map(|boxed| boxed.boxed.world_from_box.translation);
                let place = near.map_or(dice.point(1.5 * spread_m), |near| near.vector.into());
                let position =
                    if turn % 2 == 0 { place + beside } else { dice.point(1.5 * spread_m) };
                let expected = slow(&cabinet, &position);
                let found = cabinet.claim(&position).map(|(in_box, drawer)| (in_box, drawer.track));
                assert_eq!(found, expected, "{position}");
                *if found.is_some() { &mut claimed } else { &mut free } += 1;
            }
        }
        assert!(claimed > 2000 && free > 2000, "{claimed} claimed, {free} free");
    }
}
