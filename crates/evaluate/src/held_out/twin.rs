//! The floor: perfect labels of a flat ground, seen by the same rays.
//!
//! ```text
//!   sensor  o .                                error along the ray
//!             |   ` .                            = range * (top - ground) / (sensor - ground)
//!             |         ` .
//!   top ------+---------------x-----+---------  the voxel's top
//!             |               | ` . |
//!   ground ===+===============+=====o=========
//!             |               |     |
//! ```

use nalgebra::Point3;
use occlabel_core::{ClassId, GridSpec, VoxelGrid, VoxelIndex};

use super::{HeldOutRay, Source, Verdict};

/// A flat ground, its perfect labels, and rays that end on it.
#[derive(Clone, Debug)]
pub struct FlatTwin {
    /// Height of the ground, grid frame, metres.
    pub height_m: f64,
    /// Occupied where the ground passes, free above, unobserved below.
    pub verdicts: VoxelGrid<Verdict>,
    /// The rays that meet the ground within the grid.
    pub rays: Vec<HeldOutRay>,
}

/// The flat ground at the median height of returns, with the rays of these returns made longer or
/// shorter until they meet it; `None` if no return lies in the grid.
pub fn flat_twin(spec: &GridSpec, ground: &[&HeldOutRay]) -> Option<FlatTwin> {
    let mut heights: Vec<f64> = ground
        .iter()
        .filter(|ray| spec.flat_of(&ray.point).is_some())
        .map(|ray| ray.point.z)
        .collect();
    heights.sort_by(f64::total_cmp);
    let height_m = *heights.get(heights.len().checked_sub(1)? / 2)?;
    let rays = ground.iter().filter_map(|ray| meet(ray, height_m));
    let rays = rays.filter(|ray| spec.flat_of(&ray.point).is_some()).collect();
    Some(FlatTwin { height_m, verdicts: perfect_labels(spec, height_m), rays })
}

fn perfect_labels(spec: &GridSpec, height_m: f64) -> VoxelGrid<Verdict> {
    let layer = spec.to_voxel_units(&Point3::new(0.0, 0.0, height_m)).z.floor() as i64;
    let verdict = |VoxelIndex([_, _, z])| match z.cmp(&layer) {
        std::cmp::Ordering::Less => Verdict::Unobserved,
        std::cmp::Ordering::Equal => Verdict::Occupied(ClassId(0)),
        std::cmp::Ordering::Greater => Verdict::Free,
    };
    VoxelGrid::from_values(spec, spec.voxels().map(verdict).collect())
}

/// The ray to where it meets the ground, if it comes down on it.
fn meet(ray: &HeldOutRay, height_m: f64) -> Option<HeldOutRay> {
    let way = ray.point - ray.origin;
    let drop_m = height_m - ray.origin.z;
    let mut point = ray.origin + way * (drop_m / way.z);
    point.z = height_m;
    (way.z < 0.0 && drop_m < 0.0).then_some(HeldOutRay {
        origin: ray.origin,
        point,
        source: Source::Background(None),
        is_of_another_time: false,
    })
}
