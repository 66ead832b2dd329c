//! The rays of a keyframe in truth and prediction.

use nalgebra::Point3;
use occlabel_core::Fault;

use super::fan::{Fan, NO_HITS, ones};
use super::grid::RayGrid;
use super::hit::{RayEnd, RayHit, leaves_grid_m};
use super::set::RaySet;

/// What a ray hits in the truth, and in the prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayPair {
    /// In the truth.
    pub truth: RayHit,
    /// In the prediction; `None` if nothing is in the way there.
    pub prediction: Option<RayHit>,
}

impl RayPair {
    /// How far the depths are apart, metres, if both hit something.
    #[inline]
    pub fn error_m(&self) -> Option<f64> {
        self.prediction.map(|hit| (hit.depth_m - self.truth.depth_m).abs())
    }
}

/// All rays of a keyframe that hit something in the truth, origin by origin.
///
/// Origins are points of the grid frame, metres. The prediction is asked only where the truth stops a
/// ray, as RayIoU leaves all others out.
///
/// # Errors
/// If the grids differ in place or shape, or an origin is not finite.
pub fn ray_pairs(
    truth: &RayGrid,
    prediction: &RayGrid,
    origins: &[Point3<f64>],
    rays: &RaySet,
) -> Result<Vec<RayPair>, Fault> {
    if truth.spec != prediction.spec {
        let [expected, found] = [truth.spec, prediction.spec].map(|spec| format!("{spec:?}"));
        return Err(Fault::new("ray-grid", "prediction", expected, found));
    }
    let mut pairs = vec![];
    for origin in origins {
        check(origin)?;
        add_pairs([truth, prediction], origin, rays, &mut pairs);
    }
    Ok(pairs)
}

fn add_pairs(
    [truth, prediction]: [&RayGrid; 2],
    origin: &Point3<f64>,
    rays: &RaySet,
    pairs: &mut Vec<RayPair>,
) {
    let mut fan = Fan::new(truth, rays, origin);
    let (mut true_hits, mut predicted) = (NO_HITS, NO_HITS);
    for azimuth in 0..rays.azimuths().len() {
        fan.turn(azimuth);
        let hit = fan.cast(truth, all(rays), &mut true_hits);
        let both = fan.cast(prediction, hit, &mut predicted);
        pairs.extend(ones(hit).map(|pitch| RayPair {
            truth: true_hits[pitch],
            prediction: (both >> pitch & 1 == 1).then(|| predicted[pitch]),
        }));
    }
}

/// Where all rays from an origin end, in the order of [`RaySet::directions`].
///
/// # Errors
/// If the origin is not finite.
pub fn cast_rays(
    grid: &RayGrid,
    origin: &Point3<f64>,
    rays: &RaySet,
) -> Result<Vec<RayEnd>, Fault> {
    check(origin)?;
    let azimuths = rays.azimuths().len();
    let free = |direction| RayEnd::Free { depth_m: leaves_grid_m(grid.spec, origin, &direction) };
    let mut ends: Vec<RayEnd> = rays.directions().map(free).collect();
    let (mut fan, mut hits) = (Fan::new(grid, rays, origin), NO_HITS);
    for azimuth in 0..azimuths {
        fan.turn(azimuth);
        for pitch in ones(fan.cast(grid, all(rays), &mut hits)) {
            ends[pitch * azimuths + azimuth] = RayEnd::Hit(hits[pitch]);
        }
    }
    Ok(ends)
}

/// A bit for every pitch.
fn all(rays: &RaySet) -> u64 {
    (0..rays.pitches().len()).fold(0, |all, pitch| all | 1 << pitch)
}

fn check(origin: &Point3<f64>) -> Result<(), Fault> {
    match origin.iter().all(|c| c.is_finite()) {
        true => Ok(()),
        false => {
            Err(Fault::new("ray-origin", "origins", "finite coordinates", format!("{origin}")))
        }
    }
}
