//! The ground under a sweep, and whether it lies where the poses say.

use nalgebra::{Point3, Vector3};
use occlabel_core::{Fault, SweepHeader};

use super::plane::{Plane, planes, scattered};
use super::rotation::ORDER_HINT;

/// The ground's normal is within this of up, degrees (docs/reliability.md 13).
const LARGEST_SLOPE_DEG: f64 = 15.0;
/// Of the points on the best plane at least this share lies on the best level one, if the ground is
/// level: a wall can hold more points than the ground, but not so many more.
const SMALLEST_SHARE: f64 = 0.4;
/// The ground is looked for between these distances from the sensor, metres: the vehicle is nearer,
/// and farther the ground bends.
const REACH_M: std::ops::Range<f64> = 2.5..20.0;
/// So many points are looked at.
const MAX_POINTS: usize = 1500;
/// Fewer tell nothing.
const MIN_POINTS: usize = 100;

/// What a sweep says about the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct GroundView {
    /// The best level plane, ego frame.
    pub(super) level: Option<Plane>,
    /// In the ego frame.
    ego: Evidence,
    /// In the world.
    world: Evidence,
}

/// How far off level the best plane is, and how good the best level one is, in one frame.
#[derive(Clone, Copy, Debug)]
struct Evidence {
    /// Of the best plane's normal from up.
    tilt_deg: f64,
    /// Points on the best level plane, as a share of those on the best one.
    share: f64,
}

impl GroundView {
    /// What points in the ego frame say; none if they are too few.
    pub(super) fn of(sweep: &SweepHeader, points: &[Point3<f64>]) -> Option<Self> {
        let eye = sweep.ego_from_lidar * Point3::origin();
        let near = |p: &&Point3<f64>| REACH_M.contains(&(*p - eye).norm());
        let near: Vec<_> = points.iter().filter(near).copied().collect();
        if near.len() < MIN_POINTS {
            return None;
        }
        let points = some_of(near);
        let tried: Vec<(Plane, usize)> = planes(&points, eye).collect();
        let world = sweep.world_from_ego.rotation;
        let (ego, level) = evidence(&tried, |normal| *normal)?;
        let (world, _) = evidence(&tried, |normal| world * normal)?;
        Some(Self { level, ego, world })
    }
}

/// As many points as are looked at, from all over the cloud. Every n-th of a cloud that is sorted by
/// beams would be of a few beams.
fn some_of(points: Vec<Point3<f64>>) -> Vec<Point3<f64>> {
    let count = points.len() as u64;
    match points.len() <= MAX_POINTS {
        true => points,
        false => (0..MAX_POINTS as u64).map(|i| points[(scattered(i) % count) as usize]).collect(),
    }
}

/// What planes say in a frame that normals are turned into; and the best level one.
fn evidence(
    tried: &[(Plane, usize)],
    turn: impl Fn(&Vector3<f64>) -> Vector3<f64>,
) -> Option<(Evidence, Option<Plane>)> {
    let tilt_deg = |plane: &Plane| libm::acos(turn(&plane.normal).z.clamp(-1.0, 1.0)).to_degrees();
    let (best, most) = tried.iter().max_by_key(|(_, count)| *count)?;
    let level = tried.iter().filter(|(plane, _)| tilt_deg(plane) <= LARGEST_SLOPE_DEG);
    let level = level.max_by_key(|(_, count)| *count);
    let share = level.map_or(0.0, |(_, count)| *count as f64 / *most as f64);
    Some((Evidence { tilt_deg: tilt_deg(best), share }, level.map(|(plane, _)| *plane)))
}

/// Whether the ground is level in most sweeps, in the ego frame and in the world.
pub(super) fn ground_normals(sweeps: &[SweepHeader], views: &[GroundView]) -> Option<Fault> {
    let place = &sweeps.first()?.file;
    let ego: Vec<Evidence> = views.iter().map(|view| view.ego).collect();
    let world: Vec<Evidence> = views.iter().map(|view| view.world).collect();
    not_level(place, "the ego frame", &ego).or_else(|| not_level(place, "the world", &world))
}

fn not_level(place: &str, frame: &str, views: &[Evidence]) -> Option<Fault> {
    let share = median(views.iter().map(|view| view.share))?;
    let tilt_deg = median(views.iter().map(|view| view.tilt_deg))?;
    let expected =
        format!("a ground whose normal is within {LARGEST_SLOPE_DEG} degrees of up in {frame}");
    let found = format!("{tilt_deg:.1} degrees (median of {} sweeps)", views.len());
    let fault = || Fault::new("ground-normal", place, expected, found).hint(ORDER_HINT);
    (share < SMALLEST_SHARE).then(fault)
}

fn median(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::test_drive::{pose, straight};

    /// Points of a street with a facade on its left, ego frame.
    fn street() -> Vec<Point3<f64>> {
        let ground = (0..1600).map(|i| (f64::from(i % 40) - 20.0, f64::from(i / 40) - 20.0));
        let facade =
            (0..800).map(|i| Point3::new(f64::from(i % 40) - 20.0, 7.0, f64::from(i / 40)));
        ground.map(|(x, y)| Point3::new(x, y, 0.0)).chain(facade).collect()
    }

    fn fault(bend: impl Fn(&mut SweepHeader)) -> Option<Fault> {
        let mut sweeps = straight(3, 10.0);
        sweeps.iter_mut().for_each(bend);
        let views = sweeps.iter().filter_map(|sweep| GroundView::of(sweep, &street()));
        ground_normals(&sweeps, &views.collect::<Vec<_>>())
    }

    #[test]
    fn fault_13_a_level_ground_is_fine_and_so_is_a_hill() {
        assert_eq!(fault(|_| ()), None);
        let hill = pose([0.0; 3], [0.0, 0.2, 2.0]).rotation;
        assert_eq!(fault(|sweep| sweep.world_from_ego.rotation = hill), None);
    }

    #[test]
    fn fault_13_a_ground_that_stands_up_in_the_world_is_told() {
        let mixed = pose([0.0; 3], [0.7, 0.0, 0.0]).rotation;
        let fault = fault(|sweep| sweep.world_from_ego.rotation = mixed).expect("a tilt");
        assert_eq!(fault.rule, "ground-normal");
        assert!(fault.expected.ends_with("in the world"), "{fault}");
        assert!(fault.found.starts_with("40.1 degrees"), "{fault}");
    }

    #[test]
    fn fault_13_a_ground_above_the_sensor_is_told() {
        let upside_down = pose([0.0; 3], [std::f64::consts::PI, 0.0, 0.0]).rotation;
        let fault = fault(|sweep| sweep.world_from_ego.rotation = upside_down);
        assert!(fault.expect("a tilt").found.starts_with("180.0 degrees"));
    }

    #[test]
    fn too_few_points_say_nothing() {
        assert!(GroundView::of(&straight(1, 1.0)[0], &street()[..99]).is_none());
    }
}
