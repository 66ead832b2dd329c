//! Solids as they stand about a grid, in its frame.

use nalgebra::{Matrix3, Point3, Vector3};
use occlabel_core::{GridSpec, Pose, RigidMap};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::shape::Cuboid;

use crate::bodies::Body;
use crate::convert::to_parry;
use crate::nearest::Nearest;
use crate::truth::ground_patch::{GroundPatch, Window};
use crate::{Ground, Shape, What};

/// A cuboid along the grid's axes: a voxel, or a part of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) centre: Point3<f64>,
    pub(super) half: Vector3<f64>,
}

/// A solid and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Placed<'a> {
    form: Form<'a>,
    shape_from_grid: RigidMap,
    grid_from_shape: Matrix3<f64>,
    /// The same as `shape_from_grid`, as parry takes it.
    pose: ParryPose,
}

#[derive(Clone, Debug)]
enum Form<'a> {
    Body(&'a Shape, What),
    Ground(GroundPatch<'a>),
}

impl Cell {
    /// Half of its diagonal, metres.
    pub(super) fn radius_m(&self) -> f64 {
        self.half.norm()
    }

    /// One of its eight parts.
    pub(super) fn octant(&self, number: usize) -> Self {
        let half = self.half / 2.0;
        let side = |axis: usize| if number >> axis & 1 == 1 { half[axis] } else { -half[axis] };
        Self { centre: self.centre + Vector3::new(side(0), side(1), side(2)), half }
    }
}

impl<'a> Placed<'a> {
    /// A body of the world.
    pub(super) fn body(body: &'a Body, grid_from_world: &Pose) -> Self {
        let form = Form::Body(&body.shape, body.what);
        Self::new(form, &(grid_from_world * body.world_from_shape))
    }

    /// The ground, true up to `reach_m` around a grid.
    pub(super) fn ground(
        ground: &'a Ground,
        spec: &GridSpec,
        world_from_grid: &Pose,
        reach_m: f64,
    ) -> Self {
        let middle = world_from_grid * nalgebra::center(&spec.min_m(), &spec.max_m());
        let turn = world_from_grid.rotation.to_rotation_matrix().into_inner().abs();
        let half = turn * ((spec.max_m() - spec.min_m()) / 2.0) + Vector3::repeat(reach_m);
        let range = |axis: usize| middle[axis] - half[axis]..=middle[axis] + half[axis];
        let patch = GroundPatch::new(ground, &Window { x_m: range(0), y_m: range(1) });
        Self::new(Form::Ground(patch), &world_from_grid.inverse())
    }

    fn new(form: Form<'a>, grid_from_shape: &Pose) -> Self {
        let shape_from_grid = grid_from_shape.inverse();
        let q = shape_from_grid.rotation.coords;
        let offset = to_parry(&shape_from_grid.translation.vector.into());
        Self {
            form,
            shape_from_grid: RigidMap::from(&shape_from_grid),
            grid_from_shape: grid_from_shape.rotation.to_rotation_matrix().into_inner(),
            pose: ParryPose::from_parts(offset, Rotation::from_xyzw(q.x, q.y, q.z, q.w)),
        }
    }

    /// The nearest place of its surface to a point of the grid's frame, and whose surface it is.
    pub(super) fn nearest(&self, p: &Point3<f64>) -> (Nearest, What) {
        let local = self.shape_from_grid.apply(p);
        let (nearest, what) = match &self.form {
            Form::Body(shape, what) => (shape.nearest(&local), *what),
            Form::Ground(patch) => {
                let (nearest, band) = patch.nearest(&local);
                (nearest, What::Ground(band))
            }
        };
        (Nearest { normal: self.grid_from_shape * nearest.normal, ..nearest }, what)
    }

    pub(super) fn contains(&self, p: &Point3<f64>) -> bool {
        let local = self.shape_from_grid.apply(p);
        match &self.form {
            Form::Body(shape, _) => shape.contains(&local),
            Form::Ground(patch) => patch.contains(&local),
        }
    }

    /// Whether it reaches into a cell, farther than `touch_m`. `seen` is its nearest place to the
    /// cell's centre.
    pub(super) fn reaches(&self, cell: &Cell, seen: &Nearest, touch_m: f64) -> bool {
        let radius_m = cell.radius_m();
        if seen.distance_m < 0.0 || seen.distance_m >= radius_m {
            return seen.distance_m < 0.0;
        }
        if seen.flat_m >= seen.distance_m + radius_m {
            return seen.distance_m < seen.normal.abs().dot(&cell.half) - touch_m;
        }
        let inner = Cuboid::new(to_parry(&Point3::from(cell.half.add_scalar(-touch_m))));
        let pose = self.pose * ParryPose::from_translation(to_parry(&cell.centre));
        match &self.form {
            Form::Body(shape, _) => shape.overlaps(&inner, &pose),
            Form::Ground(patch) => patch.overlaps(&inner, &pose),
        }
    }

    /// Lower and upper corner, in the grid's frame, of what it fills; none for the ground.
    pub(super) fn bounds(&self) -> Option<[Point3<f64>; 2]> {
        let Form::Body(shape, _) = &self.form else { return None };
        let [low, high] = shape.bounds();
        let reach = self.grid_from_shape.abs() * ((high - low) / 2.0);
        let centre = nalgebra::center(&low, &high);
        let local = self.pose.inverse() * Vector::new(centre.x, centre.y, centre.z);
        let centre = Point3::new(local.x, local.y, local.z);
        Some([centre - reach, centre + reach])
    }
}
