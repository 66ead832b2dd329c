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

/// A solid that reaches less far into a cell only touches it, metres.
pub(super) const TOUCH_M: f64 = 1e-6;
/// A distance that is rounding, metres.
const NO_GAP_M: f64 = 1e-9;

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
    Ground(Box<GroundPatch<'a>>),
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
        Self::new(Form::Ground(patch.into()), &world_from_grid.inverse())
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

    /// Whether it reaches into a cell, by more than a touch. `seen` is its nearest place to the
    /// cell's centre.
    pub(super) fn reaches(&self, cell: &Cell, seen: &Nearest) -> bool {
        let inner = Cell { half: cell.half.add_scalar(-TOUCH_M), ..*cell };
        let is_near = seen.distance_m < cell.radius_m();
        seen.distance_m < 0.0 || (is_near && self.gap_m(&inner, seen) < NO_GAP_M)
    }

    /// From a cell to the solid. `seen` is its nearest place to the cell's centre.
    pub(super) fn gap_m(&self, cell: &Cell, seen: &Nearest) -> f64 {
        if seen.flat_m >= seen.distance_m.abs() + cell.radius_m() {
            return (seen.distance_m - seen.normal.abs().dot(&cell.half)).max(0.0);
        }
        let cuboid = Cuboid::new(to_parry(&Point3::from(cell.half)));
        let pose = self.pose * ParryPose::from_translation(to_parry(&cell.centre));
        match &self.form {
            Form::Body(shape, _) => shape.gap_m(&cuboid, &pose),
            Form::Ground(patch) => patch.gap_m(&cuboid, &pose),
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

#[cfg(test)]
mod tests {
    use nalgebra::{Translation3, UnitQuaternion};
    use parry3d_f64::query::details::intersection_test_cuboid_cuboid;

    use super::*;
    use crate::ShapeFile;

    /// Stances along the cell's axes or turned, a little or much; flush with it, or a hair off, at
    /// steps of a quarter of its edge.
    fn stances() -> impl Iterator<Item = Pose> {
        let turns = [0.0, 1e-9, 1e-6, 1e-4, 0.3, std::f64::consts::FRAC_PI_4];
        let hairs = [0.0, 1e-5, -1e-5, 1e-3];
        let ways = turns.into_iter().flat_map(move |turn| hairs.map(|hair_m| (turn, hair_m)));
        let at = |k: i32| [k % 9, k / 9 % 9, k / 81].map(|step| f64::from(step - 4) * 0.1);
        ways.flat_map(move |(turn, hair_m)| {
            (0..729).map(move |k| {
                let step = Translation3::from(Vector3::from(at(k)).add_scalar(hair_m));
                step * UnitQuaternion::from_euler_angles(turn, 0.0, 2.0 * turn)
            })
        })
    }

    #[test]
    fn a_box_reaches_into_a_cell_where_no_axis_separates_them() {
        let shape = Shape::try_from(ShapeFile::Box { size_m: [0.4, 0.2, 0.8] }).unwrap();
        let cell = Cell { centre: Point3::origin(), half: Vector3::repeat(0.2) };
        let (form, inner) = (Vector::new(0.2, 0.1, 0.4), Vector::splat(0.2 - TOUCH_M));
        let (mut reached, mut touched, mut apart) = (0, 0, 0);
        for stance in stances() {
            let solid = Placed::new(Form::Body(&shape, What::Static(0)), &stance);
            let seen = solid.nearest(&cell.centre).0;
            let overlap = intersection_test_cuboid_cuboid(
                &solid.pose,
                &Cuboid::new(form),
                &Cuboid::new(inner),
            );
            assert_eq!(solid.reaches(&cell, &seen), overlap, "{stance:?}");
            let gap_m = solid.gap_m(&cell, &seen);
            reached += usize::from(overlap);
            touched += usize::from(!overlap && gap_m < NO_GAP_M);
            apart += usize::from(gap_m > NO_GAP_M);
        }
        assert!(reached > 500 && touched > 100 && apart > 500, "{reached} {touched} {apart}");
    }

    #[test]
    fn the_gap_to_every_form_is_what_its_nearest_sample_shows() {
        let pyramid = vec![[0.4, 0.0, 0.0], [0.0, 0.4, 0.0], [-0.4, -0.4, 0.0], [0.0, 0.0, 0.5]];
        let faces = vec![[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]];
        let forms = [
            ShapeFile::Box { size_m: [0.4, 0.2, 0.8] },
            ShapeFile::Cylinder { radius_m: 0.3, height_m: 0.5 },
            ShapeFile::Capsule { from_m: [0.0; 3], to_m: [0.3, 0.0, 0.2], radius_m: 0.2 },
            ShapeFile::Hull { points_m: pyramid.clone() },
            ShapeFile::Mesh { vertices_m: pyramid, faces },
        ];
        let cell = Cell { centre: Point3::origin(), half: Vector3::repeat(0.2) };
        let side = |k: i32, axis: u32| f64::from(k / 21_i32.pow(axis) % 21) * 0.02 - 0.2;
        let mut apart = 0;
        for shape in forms.map(|form| Shape::try_from(form).unwrap()) {
            for stance in stances().step_by(401) {
                let solid = Placed::new(Form::Body(&shape, What::Static(0)), &stance);
                let sample = |k| Point3::new(side(k, 0), side(k, 1), side(k, 2));
                let distances = (0..9261).map(|k| solid.nearest(&sample(k)).0.distance_m);
                let sampled_m = distances.fold(f64::INFINITY, f64::min).max(0.0);
                let gap_m = solid.gap_m(&cell, &solid.nearest(&cell.centre).0);
                // No place of the cell is farther than half a step's diagonal from a sample; parry's
                // iteration may stop some micrometres from its goal.
                assert!((-2e-5..0.0174).contains(&(sampled_m - gap_m)), "{sampled_m} {gap_m}");
                apart += usize::from(gap_m > NO_GAP_M);
            }
        }
        assert!(apart > 50, "{apart}");
    }
}
