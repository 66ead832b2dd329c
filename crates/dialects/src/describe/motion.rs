//! Whether an axis is reversed, by what two keyframes of a drive have in common.
//!
//! What stands still stands in the world: what is occupied at one keyframe is occupied at the next, in the
//! voxel where the poses put it. Where an axis is reversed, that holds of the mirrored grid, and not of
//! the grid as it is. A straight drive along x says nothing of y; one that turns does.

use std::ops::AddAssign;

use nalgebra::{Matrix4, Point3, Rotation3, Translation3, UnitQuaternion};
use occlabel_core::{GridSpec, Pose};
use occlabel_labels::NumberArray;

use crate::{ClassTable, Dialect, Holds, KeyframeLabels};

/// How many occupied voxels of keyframes are occupied in others where the poses put them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MotionCounts {
    /// Voxels that were asked.
    pub asked: u64,
    /// Occupied in the other keyframe, the grids as they are.
    pub as_it_is: u64,
    /// Occupied in the other keyframe, both grids mirrored along x, or along y.
    pub mirrored: [u64; 2],
}

/// So few voxels do not tell.
const TELLING_VOXELS: u64 = 1000;

/// What the mirrored grids have to have more of.
const TELLING_RATIO: f64 = 1.2;

impl MotionCounts {
    /// The counts of two keyframes; the pose takes points of the one's grid into the other's.
    pub(crate) fn of(
        [one, other]: [&KeyframeLabels; 2],
        other_from_one: &Pose,
        classes: &ClassTable,
    ) -> Self {
        let (spec, free) = (&one.spec, classes.free_index());
        let is_occupied = |at: usize| other.semantics.values()[at] < free;
        let finds = |p: &Point3<f64>, axis: Option<usize>| {
            let moved = mirror(&(other_from_one * mirror(p, spec, axis)), spec, axis);
            other.spec.flat_of(&moved).is_some_and(is_occupied)
        };
        let mut counts = Self::default();
        let voxels = spec.voxels().zip(one.semantics.values());
        for (voxel, _) in voxels.filter(|(_, class)| **class < free) {
            let centre = spec.centre(voxel);
            counts.asked += 1;
            counts.as_it_is += u64::from(finds(&centre, None));
            for axis in 0..2 {
                counts.mirrored[axis] += u64::from(finds(&centre, Some(axis)));
            }
        }
        counts
    }

    /// The axis along which the grids fit better when mirrored, 0 for x and 1 for y.
    pub(crate) fn reversed_axis(&self) -> Option<usize> {
        let axis = usize::from(self.mirrored[1] > self.mirrored[0]);
        let more = self.mirrored[axis] as f64 > TELLING_RATIO * self.as_it_is as f64;
        (self.asked >= TELLING_VOXELS && more).then_some(axis)
    }
}

impl AddAssign for MotionCounts {
    fn add_assign(&mut self, other: Self) {
        self.asked += other.asked;
        self.as_it_is += other.as_it_is;
        self.mirrored[0] += other.mirrored[0];
        self.mirrored[1] += other.mirrored[1];
    }
}

/// A point where it is if an axis of the grid is counted from the other end.
fn mirror(p: &Point3<f64>, spec: &GridSpec, axis: Option<usize>) -> Point3<f64> {
    let mut p = *p;
    if let Some(axis) = axis {
        p[axis] = spec.min_m()[axis] + spec.max_m()[axis] - p[axis];
    }
    p
}

/// Arrays of 4 x 4 numbers that take points of the ego's grid into the world.
const POSE_ARRAYS: [&str; 2] = ["ego2global", "ego_to_world_transformation"];

/// Whether the files of a dialect tell poses.
pub(crate) fn tells_poses(dialect: &Dialect) -> bool {
    POSE_ARRAYS.iter().any(|name| dialect.can_say(&Holds::Extra((*name).to_owned())))
}

/// The pose of a keyframe's grid that its own files tell.
pub(crate) fn world_from_grid(labels: &KeyframeLabels) -> Option<Pose> {
    POSE_ARRAYS.iter().find_map(|name| pose(labels.extras.get(*name)?))
}

fn pose(array: &NumberArray) -> Option<Pose> {
    let numbers = array.floats();
    let is_one = array.shape == [4, 4] && numbers.iter().all(|number| number.is_finite());
    let matrix = is_one.then(|| Matrix4::from_row_slice(&numbers))?;
    let rotation = Rotation3::from_matrix(&matrix.fixed_view::<3, 3>(0, 0).into_owned());
    let translation = Translation3::new(matrix[(0, 3)], matrix[(1, 3)], matrix[(2, 3)]);
    Some(Pose::from_parts(translation, UnitQuaternion::from_rotation_matrix(&rotation)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Class;
    use occlabel_core::{VoxelGrid, VoxelIndex};

    fn classes() -> ClassTable {
        let class = Class { name: "building".to_owned(), ..Class::default() };
        ClassTable { free: 1, no_label: None, list: vec![class] }
    }

    fn spec() -> GridSpec {
        GridSpec::new([-20.0, -20.0, 0.0], [20.0, 20.0, 4.0], [0.5, 0.5, 1.0]).unwrap()
    }

    /// A world of walls that no mirror leaves as it is, seen from a pose; y counted from the other end
    /// if so told.
    fn seen(world_from_grid: &Pose, is_reversed: bool) -> KeyframeLabels {
        let spec = spec();
        let class = |voxel: VoxelIndex| {
            let axis = is_reversed.then_some(1);
            let p = world_from_grid * mirror(&spec.centre(voxel), &spec, axis);
            let is_wall = (p.y - 7.0).abs() < 1.0 || (p.x - 0.5 * p.y - 12.0).abs() < 1.0;
            u8::from(!is_wall)
        };
        let semantics = spec.voxels().map(class).collect();
        KeyframeLabels::of_semantics(spec.clone(), VoxelGrid::from_values(&spec, semantics))
    }

    fn drive() -> [Pose; 2] {
        let turn = |yaw: f64| UnitQuaternion::from_euler_angles(0.0, 0.0, yaw);
        [
            Pose::from_parts(Translation3::new(0.0, 0.0, 0.0), turn(0.0)),
            Pose::from_parts(Translation3::new(6.0, 2.0, 0.0), turn(0.4)),
        ]
    }

    fn counts(is_reversed: bool) -> MotionCounts {
        let poses = drive();
        let [one, other] = [0, 1].map(|at| seen(&poses[at], is_reversed));
        MotionCounts::of([&one, &other], &(poses[1].inverse() * poses[0]), &classes())
    }

    #[test]
    fn a_turn_tells_a_reversed_y_from_a_right_one() {
        let (right, reversed) = (counts(false), counts(true));
        assert!(
            right.asked > TELLING_VOXELS && right.as_it_is > 2 * right.mirrored[1],
            "{right:?}"
        );
        assert_eq!(right.reversed_axis(), None);
        assert_eq!(reversed.reversed_axis(), Some(1), "{reversed:?}");
    }

    #[test]
    fn two_looks_from_one_place_tell_nothing() {
        let here = seen(&drive()[0], true);
        let counts = MotionCounts::of([&here, &here], &Pose::identity(), &classes());
        assert_eq!((counts.as_it_is, counts.mirrored), (counts.asked, [counts.asked; 2]));
        assert_eq!(counts.reversed_axis(), None);
    }

    #[test]
    fn a_pose_is_read_from_four_rows() {
        let spec = spec();
        let free = VoxelGrid::filled(&spec, 1);
        let mut labels = KeyframeLabels::of_semantics(spec, free);
        assert_eq!(world_from_grid(&labels), None);
        let rows =
            [0.0, -1.0, 0.0, 5.0, 1.0, 0.0, 0.0, 6.0, 0.0, 0.0, 1.0, 7.0, 0.0, 0.0, 0.0, 1.0];
        let array = NumberArray::new(&[4, 4], &rows);
        labels.extras.insert("ego2global".to_owned(), array);
        let p = world_from_grid(&labels).unwrap() * Point3::new(1.0, 0.0, 0.0);
        assert!((p - Point3::new(5.0, 7.0, 7.0)).norm() < 1e-9, "{p}");
    }
}
