//! The first voxel along a line of sight.
//!
//! Amanatides & Woo 1987, in f64. The exact walk of `occlabel_core` asks for two ends on a lattice,
//! because labels rest on it; a line of sight has no end, and a picture forgives a rounding.

use nalgebra::Vector3;

/// A line of sight in voxel units: `origin + along * t`.
pub(crate) struct Sight {
    pub(crate) origin: Vector3<f64>,
    pub(crate) along: Vector3<f64>,
}

/// What a line of sight meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// The voxel; one below the grid's lowest if the line left through the bottom.
    pub(crate) voxel: [i64; 3],
    /// Its place in the flat array; none below the grid.
    pub(crate) flat: Option<usize>,
    /// Across which axis the face lies that was met.
    pub(crate) axis: usize,
    /// Which way along that axis the face looks.
    pub(crate) normal: i64,
    /// How far along the line.
    pub(crate) t: f64,
}

/// The first solid voxel along a line of sight, or the floor under the grid.
pub(crate) fn cast(shape: [usize; 3], sight: &Sight, solid: impl Fn(usize) -> bool) -> Option<Hit> {
    let mut walk = Walk::enter(shape, sight)?;
    loop {
        if solid(walk.flat) {
            return Some(walk.hit(Some(walk.flat)));
        }
        if !walk.step() {
            let is_floor = walk.axis == 2 && walk.step[2] < 0;
            return is_floor.then(|| walk.hit(None));
        }
    }
}

/// A walk through the grid, voxel by voxel.
struct Walk {
    shape: [i64; 3],
    step: [i64; 3],
    /// The voxel's place in the flat array, and how that changes by a step.
    flat: usize,
    stride: [isize; 3],
    /// How many voxels are ahead along each axis; -1 outside.
    ahead: [i64; 3],
    /// At which t the next face of each axis is met, and how much later the one after it.
    next: [f64; 3],
    pace: [f64; 3],
    /// The axis whose face was met last, and when.
    axis: usize,
    t: f64,
}

impl Walk {
    /// The walk's first voxel, if the line meets the grid.
    fn enter(shape: [usize; 3], sight: &Sight) -> Option<Self> {
        let strides = [shape[1] * shape[2], shape[2], 1];
        let shape = shape.map(|n| n as i64);
        let (axis, t) = entry(shape, sight)?;
        let at = sight.origin + sight.along * t;
        let voxel = [0, 1, 2].map(|axis| (at[axis].floor() as i64).clamp(0, shape[axis] - 1));
        let step = [0, 1, 2].map(|axis| if sight.along[axis] < 0.0 { -1 } else { 1 });
        let next = [0, 1, 2].map(|axis| {
            let face = voxel[axis] + i64::from(step[axis] > 0);
            let way = (face as f64 - sight.origin[axis]) / sight.along[axis];
            if sight.along[axis] == 0.0 { f64::INFINITY } else { way }
        });
        let ahead = |a: usize| if step[a] > 0 { shape[a] - 1 - voxel[a] } else { voxel[a] };
        Some(Self {
            shape,
            step,
            flat: (0..3).map(|a| voxel[a] as usize * strides[a]).sum(),
            stride: [0, 1, 2].map(|a| step[a] as isize * strides[a] as isize),
            ahead: [0, 1, 2].map(ahead),
            next,
            pace: [0, 1, 2].map(|axis| 1.0 / sight.along[axis].abs()),
            axis,
            t,
        })
    }

    /// Goes on to the next voxel; whether that is in the grid.
    #[inline]
    fn step(&mut self) -> bool {
        let [x, y, z] = self.next;
        let axis = if x <= y && x <= z { 0 } else { 1 + usize::from(z < y) };
        (self.axis, self.t) = (axis, self.next[axis]);
        self.next[axis] += self.pace[axis];
        self.flat = self.flat.wrapping_add_signed(self.stride[axis]);
        self.ahead[axis] -= 1;
        self.ahead[axis] >= 0
    }

    fn hit(&self, flat: Option<usize>) -> Hit {
        let (axis, normal) = (self.axis, -self.step[self.axis]);
        let voxel = [0, 1, 2].map(|a| match self.step[a] > 0 {
            true => self.shape[a] - 1 - self.ahead[a],
            false => self.ahead[a],
        });
        Hit { voxel, flat, axis, normal, t: self.t }
    }
}

/// Across which axis and when the line enters the grid; at once if it begins inside.
fn entry(shape: [i64; 3], sight: &Sight) -> Option<(usize, f64)> {
    let (mut enters, mut leaves) = ((2, 0.0), f64::INFINITY);
    for axis in 0..3 {
        let [low, high] = [0.0, shape[axis] as f64];
        if sight.along[axis] == 0.0 {
            (low..high).contains(&sight.origin[axis]).then_some(())?;
            continue;
        }
        let [a, b] = [low, high].map(|face| (face - sight.origin[axis]) / sight.along[axis]);
        if a.is_nan() {
            return None;
        }
        if a.min(b) > enters.1 {
            enters = (axis, a.min(b));
        }
        leaves = leaves.min(a.max(b));
    }
    (enters.1 < leaves && leaves.is_finite()).then_some(enters)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use proptest::prelude::*;

    use super::*;

    const SHAPE: [usize; 3] = [5, 4, 3];

    fn toward(origin: [f64; 3], end: [f64; 3]) -> Sight {
        let origin = Vector3::from(origin);
        Sight { origin, along: Vector3::from(end) - origin }
    }

    #[test]
    fn a_line_meets_the_near_face_of_the_first_solid_voxel() {
        let sight = toward([-2.0, 1.5, 1.5], [8.0, 1.5, 1.5]);
        let solid = |flat: usize| flat == (3 * 4 + 1) * 3 + 1 || flat == (4 * 4 + 1) * 3 + 1;
        let hit = cast(SHAPE, &sight, solid).unwrap();
        assert_eq!((hit.voxel, hit.axis, hit.normal, hit.t), ([3, 1, 1], 0, -1, 0.5));
        assert_eq!(cast(SHAPE, &sight, |_| false), None);
    }

    #[test]
    fn a_line_down_through_an_empty_grid_meets_the_floor() {
        let hit = cast(SHAPE, &toward([2.5, 2.5, 9.0], [2.5, 2.5, 0.0]), |_| false).unwrap();
        assert_eq!(
            (hit.voxel, hit.flat, hit.axis, hit.normal, hit.t),
            ([2, 2, -1], None, 2, 1, 1.0)
        );
        assert_eq!(cast(SHAPE, &toward([2.5, 2.5, -9.0], [2.5, 2.5, 0.0]), |_| false), None);
    }

    #[test]
    fn lines_that_miss_or_lead_nowhere_end() {
        let nan = f64::NAN;
        for along in [[0.0; 3], [nan; 3], [1.0, nan, 0.0], [0.0, 0.0, 1.0]] {
            let sight = Sight { origin: Vector3::new(-1.0, 1.0, 1.0), along: along.into() };
            assert_eq!(cast(SHAPE, &sight, |_| true), None, "{along:?}");
        }
    }

    /// When the line enters a voxel's box, by the slabs of that box alone.
    fn slabs(sight: &Sight, voxel: [i64; 3]) -> Option<f64> {
        let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let face = |i: i64| (i as f64 - sight.origin[axis]) / sight.along[axis];
            let (a, b) = (face(voxel[axis]), face(voxel[axis] + 1));
            (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
        }
        (enters < leaves - 1e-9).then_some(enters)
    }

    #[test]
    fn the_first_voxel_is_the_nearest_of_all() {
        let (hits, misses) = (Cell::new(0), Cell::new(0));
        let away = || [-9.0..9.0, -9.0..9.0, -9.0..9.0_f64];
        let within = || [0.0..5.0, 0.0..4.0, 0.0..3.0];
        let solids = prop::collection::vec(prop::bool::weighted(0.1), 60);
        let config = ProptestConfig::with_cases(2_000);
        proptest!(config, |(from in away(), to in within(), solids in solids)| {
            let sight = toward(from, to);
            let found = cast(SHAPE, &sight, |flat| solids[flat]).filter(|hit| hit.flat.is_some());
            let all = (0..60).filter(|&flat| solids[flat]);
            let times = all.filter_map(|flat| {
                slabs(&sight, [flat / 12, flat / 3 % 4, flat % 3].map(|i| i as i64))
            });
            let first = times.min_by(f64::total_cmp);
            let counted = if first.is_some() { &hits } else { &misses };
            counted.set(counted.get() + 1);
            match (found, first) {
                (Some(hit), Some(t)) => prop_assert!((hit.t - t).abs() < 1e-9, "{hit:?}, {t}"),
                (found, first) => prop_assert_eq!(found.map(|hit| hit.t), first),
            }
        });
        assert!(
            hits.get() > 300 && misses.get() > 300,
            "{} hits, {} misses",
            hits.get(),
            misses.get()
        );
    }
}
