//! Items of a cloud in groups, each of one place.
//!
//! Space is halved along the widest axis of what is in it until a group is small. The extent is
//! measured anew at every step, so nothing needs to be known of the size of a scene, and far
//! outliers, planes and lines cost no more than anything else.

use nalgebra::Point3;
use wide::f32x4;

/// Items below which one thread goes on alone.
pub(crate) const ITEMS_A_TASK: usize = 1 << 14;

/// Roughly where an item is, and its number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item(f32x4);

impl Item {
    /// The item of a number, at a position that is kept relative to `center`.
    #[inline]
    pub(crate) fn new(p: &Point3<f64>, center: &Point3<f64>, number: u32) -> Self {
        let [x, y, z] = relative(p, center);
        Self(f32x4::new([x, y, z, f32::from_bits(number)]))
    }

    /// The number that the item was given.
    #[inline]
    pub(crate) fn number(&self) -> u32 {
        self.0.as_array()[3].to_bits()
    }

    #[inline]
    fn along(&self, axis: usize) -> f32 {
        self.0.as_array()[axis]
    }
}

/// A position relative to a center, metres.
#[inline]
pub(crate) fn relative(p: &Point3<f64>, center: &Point3<f64>) -> [f32; 3] {
    [0, 1, 2].map(|axis| (p[axis] - center[axis]) as f32)
}

/// Orders the items by place and visits each group of at most `size`, in parallel. `position` tells
/// where the item of a number is. The groups are the same on any number of threads.
pub(crate) fn for_each_group(
    items: &mut [Item],
    size: usize,
    position: &(impl Fn(u32) -> Point3<f64> + Sync),
    visit: &(impl Fn(&mut [Item]) + Sync),
) {
    if items.len() <= size {
        return visit(items);
    }
    let Some(split) = halve(items, position) else {
        return items.chunks_mut(size).for_each(visit);
    };
    let (low, high) = items.split_at_mut(split);
    let visit_all = |part: &mut [Item]| for_each_group(part, size, position, visit);
    if low.len().min(high.len()) < ITEMS_A_TASK {
        visit_all(low);
        visit_all(high);
    } else {
        rayon::join(|| visit_all(low), || visit_all(high));
    }
}

/// Divides the items at the middle of their extent and tells where; `None` if all are at one place.
pub(crate) fn halve(items: &mut [Item], position: &impl Fn(u32) -> Point3<f64>) -> Option<usize> {
    let (axis, middle) = widest_axis(items).or_else(|| {
        recenter(items, position);
        widest_axis(items)
    })?;
    Some(partition(items, |item| item.along(axis) < middle))
}

/// The axis along which the items extend most, and a coordinate that some are below and some not.
fn widest_axis(items: &[Item]) -> Option<(usize, f32)> {
    let (mut low, mut high) = (f32x4::splat(f32::INFINITY), f32x4::splat(f32::NEG_INFINITY));
    for item in items {
        low = item.0.fast_min(low);
        high = item.0.fast_max(high);
    }
    let (low, high) = (low.to_array(), high.to_array());
    let extent_m = |axis: &usize| high[*axis] - low[*axis];
    let axis = (0..3).max_by(|a, b| extent_m(a).total_cmp(&extent_m(b)))?;
    let middle = 0.5 * low[axis] + 0.5 * high[axis];
    let above_low = if middle > low[axis] { middle } else { high[axis] };
    (low[axis] < high[axis]).then_some((axis, above_low))
}

/// Keeps the positions relative to one of them: far from the center before, they lost their
/// differences to rounding.
fn recenter(items: &mut [Item], position: &impl Fn(u32) -> Point3<f64>) {
    let Some(center) = items.first().map(|item| position(item.number())) else { return };
    for item in items {
        *item = Item::new(&position(item.number()), &center, item.number());
    }
}

/// Moves the items that are `first` to the front and tells how many they are.
///
/// Every item is swapped, needed or not: a branch that cannot be foreseen would cost more.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        let is_first = first(&items[i]);
        items.swap(i, count);
        count += usize::from(is_first);
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Bounds;
    use std::sync::Mutex;

    fn groups_of(points: &[Point3<f64>], size: usize) -> Vec<Vec<u32>> {
        let position = |number: u32| points[number as usize];
        let mut items: Vec<Item> =
            (0_u32..).zip(points).map(|(number, p)| Item::new(p, &points[0], number)).collect();
        let groups = Mutex::new(Vec::new());
        for_each_group(&mut items, size, &position, &|group| {
            groups.lock().unwrap().push(group.iter().map(Item::number).collect::<Vec<_>>());
        });
        groups.into_inner().unwrap()
    }

    /// The longest edge of a group.
    fn edge_m(points: &[Point3<f64>], group: &[u32]) -> f64 {
        let [low, high] = Bounds::of(group.iter().map(|i| &points[*i as usize])).corners();
        (high - low).amax()
    }

    #[test]
    fn every_item_is_in_one_small_group() {
        let points: Vec<_> =
            (0..50_000).map(|i| Point3::from([7, 11, 13].map(|m| f64::from(i % m)))).collect();
        let groups = groups_of(&points, 60);
        let mut all: Vec<u32> = groups.iter().flatten().copied().collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..50_000));
        assert!(groups.iter().all(|group| group.len() <= 60 && edge_m(&points, group) <= 1.0));
    }

    #[test]
    fn a_far_outlier_does_not_blur_the_rest() {
        let mut points: Vec<_> =
            (0..1_000).map(|i| Point3::new(0.01 * f64::from(i), 0.0, 0.0)).collect();
        points.insert(0, Point3::new(1e9, -1e9, 0.0));
        let groups = groups_of(&points, 10);
        assert!(groups.contains(&vec![0]), "the outlier stands alone");
        let widest_m = groups.iter().map(|group| edge_m(&points, group)).fold(0.0, f64::max);
        assert!(widest_m <= 0.1, "{widest_m} m");
    }

    #[test]
    fn repeats_of_one_point_are_divided_by_number() {
        let groups = groups_of(&[Point3::new(5.0, 5.0, 5.0); 95], 10);
        assert_eq!(groups.len(), 10);
    }
}
