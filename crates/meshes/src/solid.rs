//! The voxels that a solid reaches into (labels.md section 9a).

use nalgebra::Point3;
use occlabel_core::{GridSpec, Pose, TriangleMesh, VoxelIndex};
use parry3d_f64::math::Pose as ParryPose;
use parry3d_f64::query::details::intersection_test_cuboid_triangle;
use parry3d_f64::shape::{Cuboid, Triangle};

use crate::column::Columns;
use crate::surface::to_parry;

/// A surface that comes this near to a voxel's face only touches it, in edges of the voxel.
const TOUCH: f64 = 1e-6;

/// The places, in rising order, of the voxels that hold a piece of a mesh's surface, or whose centre
/// lies within it. Parts that overlap are all solid.
pub fn solid_voxels(mesh: &TriangleMesh, grid_from_mesh: &Pose, spec: &GridSpec) -> Vec<usize> {
    let triangles: Vec<_> = mesh.moved(grid_from_mesh).triangles().collect();
    let mut voxels = Columns::new(&triangles).inner(spec);
    triangles.iter().for_each(|triangle| cut(triangle, spec, &mut voxels));
    let mut places: Vec<usize> = voxels.into_iter().filter_map(|at| spec.flat(at)).collect();
    places.sort_unstable();
    places.dedup();
    places
}

/// Adds the voxels that a triangle passes through.
fn cut(triangle: &[Point3<f64>; 3], spec: &GridSpec, voxels: &mut Vec<VoxelIndex>) {
    let [a, b, c] = triangle;
    let [xs, ys, zs] = spec.voxels_between(&a.inf(b).inf(c), &a.sup(b).sup(c));
    let columns = xs.flat_map(|x| ys.clone().map(move |y| [x, y]));
    let near = columns.flat_map(|[x, y]| zs.clone().map(move |z| VoxelIndex([x, y, z])));
    voxels.extend(near.filter(|&voxel| passes(triangle, voxel, spec)));
}

/// Whether a triangle passes through a voxel, by more than a touch.
fn passes(triangle: &[Point3<f64>; 3], voxel: VoxelIndex, spec: &GridSpec) -> bool {
    let cuboid = Cuboid::new(to_parry(&Point3::from(spec.size_m() * (0.5 - TOUCH))));
    let centre = spec.centre(voxel).coords;
    let [a, b, c] = triangle.map(|corner| to_parry(&(corner - centre)));
    intersection_test_cuboid_triangle(&ParryPose::IDENTITY, &cuboid, &Triangle::new(a, b, c))
}
