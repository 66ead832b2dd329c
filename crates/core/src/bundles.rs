//! Neighbouring points taken together, so that far ones are passed over together.

use nalgebra::{Point3, Vector3};

use crate::{GridSpec, PointCloud, RigidMap};

/// How many points are taken together.
pub const BUNDLE: usize = 16;

/// By how much boxes are taken too large, against rounding, voxels.
const SPARE_VOXELS: f64 = 1e-3;

/// Boxes around each [`BUNDLE`] points of a cloud, in their order, and around all of it. The last
/// may hold fewer.
#[derive(Clone, Debug, PartialEq)]
pub struct Bundles {
    each: Vec<Bounds>,
    all: Bounds,
}

/// A box around points, rounded outwards to `f32`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bounds {
    low: [f32; 3],
    high: [f32; 3],
}

/// A box of the grid frame, voxel units, somewhat too large.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Bundles {
    /// Of a cloud's points; those without finite coordinates are in no box.
    pub fn of<L>(cloud: &PointCloud<L>) -> Self {
        let each: Vec<Bounds> = cloud.positions.chunks(BUNDLE).map(Bounds::of).collect();
        let all = each.iter().fold(Bounds::of(&cloud.origins), Bounds::and);
        Self { each, all }
    }

    /// The box around all points and origins, where `place` brings it.
    pub fn whole_reach(&self, spec: &GridSpec, place: &RigidMap) -> Reach {
        self.all.reach(spec, place)
    }

    /// The box around the bundle that begins at point `start`, where `place` brings it.
    #[inline]
    pub fn reach(&self, start: usize, spec: &GridSpec, place: &RigidMap) -> Reach {
        self.each[start / BUNDLE].reach(spec, place)
    }
}

impl Bounds {
    const NONE: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

    #[inline]
    fn reach(&self, spec: &GridSpec, place: &RigidMap) -> Reach {
        let (low, high) = (self.low.map(f64::from), self.high.map(f64::from));
        Reach::of_box(&low.into(), &high.into(), spec, place)
    }

    fn and(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            self.low[axis] = self.low[axis].min(other.low[axis]);
            self.high[axis] = self.high[axis].max(other.high[axis]);
        }
        self
    }

    fn of(points: &[Point3<f64>]) -> Self {
        let mut bounds = Self::NONE;
        for point in points {
            for axis in 0..3 {
                bounds.low[axis] = bounds.low[axis].min((point[axis] as f32).next_down());
                bounds.high[axis] = bounds.high[axis].max((point[axis] as f32).next_up());
            }
        }
        bounds
    }
}

impl Reach {
    /// Of a box by its corners, where `place` brings it.
    #[inline]
    pub fn of_box(
        low: &Point3<f64>,
        high: &Point3<f64>,
        spec: &GridSpec,
        place: &RigidMap,
    ) -> Self {
        let middle = Point3::from((low.coords + high.coords) * 0.5);
        let centre = spec.to_voxel_units(&place.apply(&middle));
        let half = place.spread(&((high - low) * 0.5)).component_div(&spec.size_m());
        let half = half + Vector3::repeat(SPARE_VOXELS);
        Self { low: centre - half, high: centre + half }
    }

    /// Grown to hold a point of the grid frame too.
    #[inline]
    pub fn with(self, point: &Point3<f64>, spec: &GridSpec) -> Self {
        let (point, spare) = (spec.to_voxel_units(point), Vector3::repeat(SPARE_VOXELS));
        Self { low: self.low.inf(&(point - spare)), high: self.high.sup(&(point + spare)) }
    }

    /// Whether some of it may lie in the grid.
    #[inline]
    pub fn meets(&self, spec: &GridSpec) -> bool {
        let shape = spec.shape();
        (0..3).all(|axis| self.high[axis] >= 0.0 && self.low[axis] <= shape[axis] as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pose;
    use nalgebra::UnitQuaternion;

    #[test]
    fn a_bundle_that_is_passed_over_has_no_point_in_the_grid() {
        let spec = GridSpec::new([-4.0, -4.0, -1.0], [4.0, 4.0, 1.0], [0.5; 3]).unwrap();
        let (mut passed, mut kept) = (0, 0);
        for turn in 0..200 {
            let turned = UnitQuaternion::from_euler_angles(0.02, -0.01, f64::from(turn) * 0.37);
            let offset = Vector3::new(f64::from(turn % 17) - 8.0, f64::from(turn % 11) - 5.0, 0.3);
            let place = RigidMap::from(&Pose::from_parts(offset.into(), turned));
            let at = |i: i32| Point3::new(f64::from(i * 7 % 13), f64::from(i * 5 % 9), 0.1) * 0.4;
            let points: Vec<_> = (0..40).map(|i| at(i + turn)).collect();
            let cloud = PointCloud::from_one_origin(Point3::origin(), points.clone(), vec![(); 40]);
            let bundles = Bundles::of(&cloud);
            for (start, bundle) in (0..40).step_by(BUNDLE).zip(points.chunks(BUNDLE)) {
                let meets = bundles.reach(start, &spec, &place).meets(&spec);
                let is_in = |p: &Point3<f64>| spec.flat_of(&place.apply(p)).is_some();
                assert!(meets || !bundle.iter().any(is_in));
                (passed, kept) = (passed + usize::from(!meets), kept + usize::from(meets));
            }
        }
        assert!(passed > 100 && kept > 200, "{passed} passed over, {kept} kept");
    }
}
