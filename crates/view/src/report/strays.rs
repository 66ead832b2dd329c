//! What strays from the rest, told by median and median absolute deviation: one bad keyframe moves
//! neither.

use super::totals::VoxelTotals;

/// Farther than this from the median, in deviations, strays. Source: Iglewicz and Hoaglin, "How to
/// Detect and Handle Outliers", 1993.
const LIMIT: f64 = 3.5;
/// The standard deviation of a normal distribution in median absolute deviations.
const DEVIATIONS: f64 = 1.4826;
/// With fewer, there is no rest to stray from.
pub(crate) const FEWEST: usize = 5;
/// Where the rest agrees this well, nothing less is told as straying: a share of the median, and for
/// states and for classes a share of the voxels.
const LEAST_OF_MEDIAN: f64 = 0.05;
const LEAST_OF_VOXELS: f64 = 1e-4;
const LEAST_OF_OCCUPIED: f64 = 0.01;

/// What may stray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Share {
    /// Of all voxels.
    Occupied,
    Free,
    Unobserved,
    SeenByCameras,
    /// Of the occupied ones, those of a class.
    Class(usize),
}

/// One share of one keyframe or scene that strays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stray {
    pub(crate) share: Share,
    pub(crate) value: f64,
    /// The median of the rest.
    pub(crate) usual: f64,
    /// How many times as far as the rest.
    pub(crate) times: f64,
}

/// For each of some totals the shares in which it strays from all of them, the farthest first.
pub(crate) fn strays(all: &[&VoxelTotals]) -> Vec<Vec<Stray>> {
    let mut found = vec![Vec::new(); all.len()];
    if all.len() < FEWEST {
        return found;
    }
    let classes = all.iter().map(|totals| totals.by_class.len()).max().unwrap_or(0);
    let states = [Share::Occupied, Share::Free, Share::Unobserved, Share::SeenByCameras];
    for share in states.into_iter().chain((0..classes).map(Share::Class)) {
        for (place, stray) in strays_in(share, all) {
            found[place].push(stray);
        }
    }
    found.iter_mut().for_each(|strays| strays.sort_by(|a, b| b.times.total_cmp(&a.times)));
    found
}

fn strays_in(share: Share, all: &[&VoxelTotals]) -> Vec<(usize, Stray)> {
    let told = all.iter().enumerate().filter_map(|(i, totals)| Some((i, share.of(totals)?)));
    let told: Vec<(usize, f64)> = told.collect();
    let usual = median(told.iter().map(|(_, value)| *value));
    let spread = DEVIATIONS * median(told.iter().map(|(_, value)| (value - usual).abs()));
    let scale = spread.max(LEAST_OF_MEDIAN * usual).max(share.least());
    let stray = |(place, value): (usize, f64)| {
        let times = (value - usual).abs() / scale;
        (times > LIMIT).then_some((place, Stray { share, value, usual, times }))
    };
    if told.len() < FEWEST { Vec::new() } else { told.into_iter().filter_map(stray).collect() }
}

impl Share {
    /// What it is of some totals, 0 to 1; `None` if they do not tell.
    pub(crate) fn of(self, totals: &VoxelTotals) -> Option<f64> {
        let (voxels, occupied) = (totals.voxels(), totals.occupied());
        let of = |count: u64, all: u64| (all > 0).then(|| count as f64 / all as f64);
        match self {
            Self::Occupied => of(occupied, voxels),
            Self::Free => of(totals.free, voxels),
            Self::Unobserved => of(totals.unobserved, voxels),
            Self::SeenByCameras => of(totals.seen_by_cameras?, voxels),
            Self::Class(class) => of(totals.by_class.get(class).copied().unwrap_or(0), occupied),
        }
    }

    fn least(self) -> f64 {
        match self {
            Self::Class(_) => LEAST_OF_OCCUPIED,
            _ => LEAST_OF_VOXELS,
        }
    }
}

/// The middle value, or the mean of the two; 0 of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    match (sorted.len() / 2, sorted.len() % 2) {
        (0, 0) => 0.0,
        (half, 0) => (sorted[half - 1] + sorted[half]) / 2.0,
        (half, _) => sorted[half],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn totals(by_class: [u64; 2], free: u64) -> VoxelTotals {
        let unobserved = 100_000 - by_class.iter().sum::<u64>() - free;
        VoxelTotals { by_class: by_class.to_vec(), free, unobserved, seen_by_cameras: None }
    }

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median([3.0, 1.0, 2.0].into_iter()), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0].into_iter()), 2.5);
        assert_eq!(median([].into_iter()), 0.0);
    }

    #[test]
    fn what_is_unlike_the_rest_strays_and_the_rest_does_not() {
        let mut all: Vec<_> = (0..9).map(|i| totals([1000 + i, 1000 - i], 10_000 + i)).collect();
        all.push(totals([1000, 1000], 3_000));
        all.push(totals([1900, 100], 10_000));
        let found = strays(&all.iter().collect::<Vec<_>>());
        assert!(found[..9].iter().all(Vec::is_empty), "{found:?}");
        let shares = |place: usize| found[place].iter().map(|s| s.share).collect::<Vec<_>>();
        assert_eq!(
            shares(9),
            [Share::Free],
            "unobserved is 97 % instead of 88 %: not 3.5 times 5 %"
        );
        assert!(shares(10).contains(&Share::Class(0)) && shares(10).contains(&Share::Class(1)));
        assert_eq!(shares(10).len(), 2);
        assert!((found[9][0].times - 0.07 / 0.005).abs() < 0.1, "{:?}", found[9]);
    }

    #[test]
    fn a_few_have_no_rest() {
        let all = [totals([1, 1], 10), totals([1, 1], 10), totals([1, 1], 10), totals([9, 9], 99)];
        assert!(strays(&all.iter().collect::<Vec<_>>()).iter().all(Vec::is_empty));
    }
}
