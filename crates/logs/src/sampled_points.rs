//! How many points a scene holds, told by some of its sweeps.

use std::collections::BTreeMap;

use occlabel_core::{Scene, SweepHeader};

use crate::SceneSource;

/// So many sweeps of each lidar are looked at, first and last among them.
const LOOKED_AT: usize = 5;

/// The points of a scene whose files do not tell how many there are before they are unpacked: as if
/// every sweep of a lidar held as many as the largest that was looked at, and a quarter more.
pub(crate) fn sampled_points(source: &dyn SceneSource, scene: &Scene) -> u64 {
    let mut lidars: BTreeMap<&str, Vec<&SweepHeader>> = BTreeMap::new();
    for sweep in &scene.sweeps {
        lidars.entry(&sweep.lidar).or_default().push(sweep);
    }
    let points = |sweep: &&SweepHeader| source.read_sweep(sweep).map_or(0, |read| read.cloud.len());
    let of_lidar = |sweeps: Vec<&SweepHeader>| {
        let largest = spread(&sweeps, LOOKED_AT).map(points).max().unwrap_or(0);
        sweeps.len() as u64 * (largest + largest / 4) as u64
    };
    lidars.into_values().map(of_lidar).sum()
}

/// At most so many of a list, evenly spread from the first to the last.
fn spread<T>(list: &[T], count: usize) -> impl Iterator<Item = &T> {
    let taken = count.min(list.len());
    (0..taken).map(move |i| &list[i * (list.len() - 1) / (taken - 1).max(1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_begins_with_the_first_and_ends_with_the_last() {
        let list: Vec<usize> = (0..198).collect();
        let of = |list: &[usize]| spread(list, LOOKED_AT).copied().collect::<Vec<_>>();
        assert_eq!(of(&list), [0, 49, 98, 147, 197]);
        assert_eq!(of(&list[..3]), [0, 1, 2]);
        assert_eq!((of(&list[7..8]), of(&[])), (vec![7], vec![]));
    }
}
