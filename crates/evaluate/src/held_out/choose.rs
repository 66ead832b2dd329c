//! Which sweeps are held out, and which keyframe each is asked about.

use std::collections::BTreeMap;

use occlabel_core::{SweepHeader, Timestamp};

/// Whether each sweep is held out: of every lidar the N-th, the 2N-th and so on, in order of sweeps.
///
/// Key sweeps are no exception: where every sweep is one, nothing else could be held out.
///
/// # Panics
/// If `every` is 0.
pub fn held_out(sweeps: &[SweepHeader], every: usize) -> Vec<bool> {
    assert!(every > 0, "every 0-th sweep");
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let is_held_out = sweeps.iter().map(|sweep| {
        let count = counts.entry(sweep.lidar.as_str()).or_default();
        *count += 1;
        count.is_multiple_of(every)
    });
    is_held_out.collect()
}

/// The keyframe nearest in time, the earlier on ties; `None` if it is more than `within_s` away.
pub fn nearest_keyframe(keyframes: &[Timestamp], time: Timestamp, within_s: f64) -> Option<usize> {
    let apart = |at: &usize| keyframes[*at].0.abs_diff(time.0);
    let nearest = (0..keyframes.len()).min_by_key(|at| (apart(at), keyframes[*at]))?;
    (keyframes[nearest].seconds_apart(time) <= within_s).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use occlabel_core::{PointsOf, Pose};

    use super::*;

    fn sweep(lidar: &str) -> SweepHeader {
        SweepHeader {
            time: Timestamp(0),
            lidar: lidar.into(),
            source_id: String::new(),
            file: String::new(),
            world_from_ego: Pose::identity(),
            ego_from_lidar: Pose::identity(),
            labelled: false,
            points_of: PointsOf::Moment,
        }
    }

    #[test]
    fn every_nth_sweep_is_counted_by_lidar() {
        let sweeps = ["A", "B", "A", "A", "B", "A", "A", "B"].map(sweep);
        let held = held_out(&sweeps, 2);
        assert_eq!(held, [false, false, true, false, true, true, false, false]);
        assert_eq!(held_out(&sweeps, 1), [true; 8]);
        assert_eq!(held_out(&sweeps, 6), [false; 8], "no lidar has six");
    }

    #[test]
    fn a_sweep_is_asked_about_the_nearest_keyframe() {
        let keyframes = [0, 500_000_000, 1_000_000_000].map(Timestamp);
        let nearest = |ms: i64| nearest_keyframe(&keyframes, Timestamp(ms * 1_000_000), 0.3);
        assert_eq!(
            [0, 240, 250, 260, 1300].map(nearest),
            [Some(0), Some(0), Some(0), Some(1), Some(2)]
        );
        assert_eq!([1301, -301].map(nearest), [None, None], "too far");
        assert_eq!(nearest_keyframe(&[], Timestamp(0), 1.0), None);
    }
}
