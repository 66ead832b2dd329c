//! What lies within a surface, column by column: by how often the surface winds around it.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use occlabel_core::{GridSpec, VoxelIndex};

/// The triangles of a surface in the grid frame.
pub(crate) struct Columns<'a>(&'a [[Point3<f64>; 3]]);

/// Where the surface meets the vertical line through the middle of a column.
#[derive(Clone, Copy)]
struct Crossing {
    /// Metres, grid frame.
    z_m: f64,
    /// What the way up adds to the winding number: 1 where it goes in, -1 where it comes out.
    step: i32,
}

impl<'a> Columns<'a> {
    pub(crate) fn new(triangles: &'a [[Point3<f64>; 3]]) -> Self {
        Self(triangles)
    }

    /// The voxels of the grid whose centres lie within: around which the surface winds at least once,
    /// so that parts which overlap are solid. A column in which the surface does not close has none.
    pub(crate) fn inner(&self, spec: &GridSpec) -> Vec<VoxelIndex> {
        let mut inner = Vec::new();
        for (column, mut crossings) in self.crossings(spec) {
            crossings.sort_by(|a, b| a.z_m.total_cmp(&b.z_m));
            if crossings.iter().map(|crossing| crossing.step).sum::<i32>() == 0 {
                fill(column, &crossings, spec, &mut inner);
            }
        }
        inner
    }

    /// By columns along x and y.
    fn crossings(&self, spec: &GridSpec) -> BTreeMap<[i64; 2], Vec<Crossing>> {
        let mut crossings: BTreeMap<_, Vec<Crossing>> = BTreeMap::new();
        for triangle in self.0 {
            let [a, b, c] = triangle;
            let [xs, ys, _] = spec.voxels_between(&a.inf(b).inf(c), &a.sup(b).sup(c));
            for column in xs.flat_map(|x| ys.clone().map(move |y| [x, y])) {
                let middle = spec.centre(VoxelIndex([column[0], column[1], 0]));
                if let Some(crossing) = crossing(triangle, &middle) {
                    crossings.entry(column).or_default().push(crossing);
                }
            }
        }
        crossings
    }
}

/// The voxels of a column between crossings that go in and come out.
fn fill([x, y]: [i64; 2], crossings: &[Crossing], spec: &GridSpec, inner: &mut Vec<VoxelIndex>) {
    let mut winding = 0;
    for pair in crossings.windows(2) {
        winding += pair[0].step;
        if winding != 0 {
            let at = spec.centre(VoxelIndex([x, y, 0]));
            let ends = [pair[0].z_m, pair[1].z_m].map(|z| Point3::new(at.x, at.y, z));
            let [_, _, zs] = spec.voxels_between(&ends[0], &ends[1]);
            let is_within = |voxel: &VoxelIndex| {
                let z_m = spec.centre(*voxel).z;
                pair[0].z_m <= z_m && z_m < pair[1].z_m
            };
            inner.extend(zs.map(|z| VoxelIndex([x, y, z])).filter(is_within));
        }
    }
}

/// Where a triangle meets the vertical line through a point.
fn crossing([a, b, c]: &[Point3<f64>; 3], p: &Point3<f64>) -> Option<Crossing> {
    let sides = [is_left(a, b, p), is_left(b, c, p), is_left(c, a, p)];
    let looks_up = sides[0];
    if sides != [looks_up; 3] {
        return None;
    }
    let normal: Vector3<f64> = (b - a).cross(&(c - a));
    let level_m = (normal.x * (a.x - p.x) + normal.y * (a.y - p.y)) / normal.z;
    level_m
        .is_finite()
        .then(|| Crossing { z_m: a.z + level_m, step: if looks_up { -1 } else { 1 } })
}

/// Whether a point lies to the left of the way from `a` to `b`, seen from above. What lies on it lies to
/// the left of one of its two directions, always the same one: each line crosses one of two neighbours.
fn is_left(a: &Point3<f64>, b: &Point3<f64>, p: &Point3<f64>) -> bool {
    let is_turned = (b.x, b.y) < (a.x, a.y);
    let (a, b) = if is_turned { (b, a) } else { (a, b) };
    let across = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    (across >= 0.0) != is_turned
}
