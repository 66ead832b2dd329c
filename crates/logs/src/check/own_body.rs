//! Returns that stand still in the ego frame while the vehicle drives: its own body
//! (docs/labels.md section 13).

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use occlabel_core::{Fault, SweepHeader};

use super::plane::Plane;

/// Where a body can be, ego frame, metres: half lengths and half widths of a lorry; nothing else
/// stays there for a whole drive.
const BODY_HALF_M: [f64; 2] = [5.0, 1.5];
/// Between these heights above the ground, metres.
const BODY_HEIGHT_M: std::ops::Range<f64> = 0.3..4.0;
/// Side of the voxels in which returns are counted, metres.
const VOXEL_M: f64 = 0.2;
/// Sweeps count if the vehicle moved so far since the last that did, metres.
const APART_M: f64 = 1.0;
/// Fewer sweeps tell nothing.
const MIN_SWEEPS: usize = 5;
/// What returns in four of five sweeps stands still.
const SHARE: (usize, usize) = (4, 5);

/// A voxel of the ego frame.
type Voxel = [i64; 3];

/// Corners of a box, ego frame, metres.
pub(super) type Corners = (Point3<f64>, Point3<f64>);

/// A sweep's returns where the body can be and no box covers it, by voxel.
pub(super) fn near_returns(
    points: &[Point3<f64>],
    level: &Plane,
    ego_box: Option<&Corners>,
) -> BTreeMap<Voxel, usize> {
    let is_covered = |p: &Point3<f64>| {
        ego_box.is_some_and(|(min, max)| (0..3).all(|a| (min[a]..=max[a]).contains(&p[a])))
    };
    let is_near = |p: &&Point3<f64>| {
        p.x.abs() <= BODY_HALF_M[0]
            && p.y.abs() <= BODY_HALF_M[1]
            && BODY_HEIGHT_M.contains(&level.height_m(p))
    };
    let mut returns = BTreeMap::new();
    for p in points.iter().filter(is_near).filter(|p| !is_covered(p)) {
        let voxel = [p.x, p.y, p.z].map(|metres| (metres / VOXEL_M).floor() as i64);
        *returns.entry(voxel).or_default() += 1;
    }
    returns
}

/// Returns by lidar and voxel, over the sweeps of a drive.
#[derive(Debug, Default)]
pub(super) struct OwnBody {
    lidars: BTreeMap<String, Lidar>,
}

#[derive(Debug, Default)]
struct Lidar {
    last: Option<Vector3<f64>>,
    sweeps: usize,
    /// By voxel: in how many sweeps it returned, and how many points.
    returns: BTreeMap<Voxel, (usize, usize)>,
}

impl OwnBody {
    /// Adds a sweep's, if the vehicle has moved. Sweeps come in order of time.
    pub(super) fn add(&mut self, sweep: &SweepHeader, returns: BTreeMap<Voxel, usize>) {
        let lidar = self.lidars.entry(sweep.lidar.clone()).or_default();
        let place = sweep.world_from_ego.translation.vector;
        if lidar.last.is_some_and(|last| (place - last).norm() < APART_M) {
            return;
        }
        lidar.last = Some(place);
        lidar.sweeps += 1;
        for (voxel, points) in returns {
            let (sweeps, all) = lidar.returns.entry(voxel).or_default();
            (*sweeps, *all) = (*sweeps + 1, *all + points);
        }
    }

    /// What stands still, one fault a lidar; the hint names a box that covers it and `ego_box`.
    pub(super) fn faults(&self, ego_box: Option<&Corners>) -> Vec<Fault> {
        self.lidars.iter().filter_map(|(name, lidar)| lidar.fault(name, ego_box)).collect()
    }
}

impl Lidar {
    fn fault(&self, name: &str, ego_box: Option<&Corners>) -> Option<Fault> {
        let is_still = |sweeps: usize| SHARE.1 * sweeps >= SHARE.0 * self.sweeps;
        let still = self.returns.iter().filter(|(_, (sweeps, _))| is_still(*sweeps));
        let (voxels, points): (Vec<Voxel>, Vec<usize>) =
            still.map(|(voxel, (_, points))| (*voxel, *points)).unzip();
        if self.sweeps < MIN_SWEEPS {
            return None;
        }
        let (min, max) = around(&voxels)?;
        let points: usize = points.iter().sum();
        let expected = "returns that move in the ego frame while the vehicle drives";
        let found = format!(
            "{points} points of {} sweeps that stand still, from ({}) to ({}) m",
            self.sweeps,
            told(&min),
            told(&max)
        );
        let (min, max) = ego_box.map_or((min, max), |(low, high)| (min.inf(low), max.sup(high)));
        let corners = format!("{{min=[{}],max=[{}]}}", told(&min), told(&max));
        let hint = format!("--set 'aggregate.ego_box_m={corners}' drops them");
        Some(Fault::new("ego-returns", name, expected, found).hint(hint))
    }
}

/// The corners of all these voxels; none without a voxel.
fn around(voxels: &[Voxel]) -> Option<Corners> {
    let outermost = |pick: fn(i64, i64) -> i64| {
        let all = voxels.iter().copied();
        all.reduce(|a, b| [0, 1, 2].map(|axis| pick(a[axis], b[axis])))
    };
    let [min, max] = [outermost(i64::min)?, outermost(i64::max)?.map(|at| at + 1)];
    let corner = |voxel: Voxel| Point3::from(voxel.map(|at| at as f64 * VOXEL_M));
    Some((corner(min), corner(max)))
}

fn told(corner: &Point3<f64>) -> String {
    corner.iter().map(|metres| format!("{metres:.1}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::test_drive::straight;

    /// Faults of a drive with a bonnet in view and a lamp post every 7 m.
    fn faults(sweeps: usize, speed_mps: f64, ego_box: Option<&Corners>) -> Vec<Fault> {
        let bonnet = (0..40).map(|i| Point3::new(1.45 + f64::from(i % 10) * 0.1, 0.1, 0.9));
        let bonnet: Vec<_> = bonnet.collect();
        let mut body = OwnBody::default();
        for sweep in straight(sweeps, speed_mps) {
            let x_m = sweep.world_from_ego.translation.x;
            let post = Point3::new(-(x_m % 7.0), 1.4, 1.0);
            let road = Point3::new(2.0, 1.0, 0.05);
            let points: Vec<_> = bonnet.iter().copied().chain([post, road]).collect();
            body.add(&sweep, near_returns(&points, &Plane::LEVEL, ego_box));
        }
        body.faults(ego_box)
    }

    #[test]
    fn section_13_what_stands_still_in_the_ego_frame_is_told_with_its_box() {
        let told = faults(30, 10.0, None);
        assert_eq!((told.len(), told[0].rule), (1, "ego-returns"));
        assert!(told[0].found.starts_with("1200 points of 30 sweeps"), "{}", told[0]);
        assert!(
            told[0].found.ends_with("from (1.4, 0.0, 0.8) to (2.4, 0.2, 1.0) m"),
            "{}",
            told[0]
        );
    }

    #[test]
    fn section_13_the_hinted_box_covers_the_old_one_too() {
        let old = (Point3::new(-1.0, -1.0, 0.0), Point3::new(1.5, 1.0, 2.0));
        let told = faults(30, 10.0, Some(&old));
        let hint = told[0].hint.as_deref().unwrap_or_default();
        assert!(hint.contains("{min=[-1.0, -1.0, 0.0],max=[2.4, 1.0, 2.0]}"), "{hint}");
    }

    #[test]
    fn section_13_a_box_that_covers_it_a_standing_vehicle_and_short_drives_tell_nothing() {
        let covered = (Point3::new(-1.0, -1.0, 0.0), Point3::new(4.0, 1.0, 2.0));
        assert!(faults(30, 10.0, Some(&covered)).is_empty());
        assert!(faults(30, 0.1, None).is_empty());
        assert!(faults(4, 10.0, None).is_empty());
    }
}
