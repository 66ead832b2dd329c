//! The rays to many voxels of one column, walked as one.
//!
//! Seen from above they are one line, so they pass the same columns at the same moments, and differ
//! in height alone. In most columns all that they can meet is seen already and lets them pass; only
//! in the others each ray is asked for the voxels that it enters.
//!
//! ```text
//!        camera                       column of the targets
//!   z      *--__                           |3|  ray 3
//!   |        \  ---___---___               |2|  ray 2
//!   +-- way   ---___       ---___          |1|
//! ```

use occlabel_core::LATTICE;

use crate::look::Look;

/// A voxel's edge in the fixed point of a fan's heights.
const ONE: i64 = 1 << 40;

/// By how much those heights are taken as unsure: 1e-6 voxel. A step's rounding is 2^-40 voxel, and
/// there are at most 2^19.
const UNSURE: i64 = 1 << 20;

/// Up to 64 targets of one column: bit k stands for height `bottom + k`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Targets {
    pub(crate) column: usize,
    pub(crate) bottom: usize,
    pub(crate) bits: u64,
}

/// Marks all that is seen by rays to the centres of the targets.
pub(crate) fn cast_fan(look: &mut Look, targets: Targets) {
    if targets.bits == 0 {
        return;
    }
    if look.is_bundled() {
        look.open_eye();
        Fan::new(look, targets).cast(look);
    } else {
        cast_one_by_one(look, targets);
    }
}

fn cast_one_by_one(look: &mut Look, targets: Targets) {
    for k in (0..64).filter(|k| targets.bits >> k & 1 == 1) {
        let voxel = look.voxel(targets.column, targets.bottom + k);
        look.along(look.spec.lattice_centre(voxel));
    }
}

/// A moment of a fan's way: `part / whole` of it is done. The start is 0 / 1, the end 1 / 1.
#[derive(Clone, Copy)]
struct Moment {
    part: i64,
    whole: i64,
}

/// A fan's way seen from above, and its rays that still run.
struct Fan {
    /// Height of the start, lattice units.
    start_z: i64,
    /// Height of target 0.
    bottom: usize,
    /// Rays that still run.
    alive: u64,
    column: usize,
    /// What a step along x, y adds to the column.
    step: [isize; 2],
    /// Lengths along x, y.
    length: [i64; 2],
    /// How far along x, y the next face lies from the start.
    to_face: [i64; 2],
    /// Steps still to take.
    left: i64,
}

impl Fan {
    fn new(look: &Look, targets: Targets) -> Self {
        let (own, end) = (look.start.voxel().0, look.voxel(targets.column, targets.bottom));
        let (from, to) = (look.start.0, look.spec.lattice_centre(end).0);
        let columns_per_x = look.spec.shape()[1] as isize;
        let way = [0, 1].map(|axis| to[axis] - from[axis]);
        Self {
            start_z: from[2],
            bottom: targets.bottom,
            alive: targets.bits,
            column: (own[0] as usize) * look.spec.shape()[1] + own[1] as usize,
            step: [way[0].signum() as isize * columns_per_x, way[1].signum() as isize],
            length: way.map(i64::abs),
            to_face: [0, 1].map(|axis| {
                let within = from[axis] & (LATTICE - 1);
                if way[axis] > 0 { LATTICE - within } else { within }
            }),
            left: (0..2).map(|axis| (end.0[axis] - own[axis]).abs()).sum(),
        }
    }

    /// Walks from column to column; x goes before y where both faces are met at once.
    fn cast(mut self, look: &mut Look) {
        let [per_x, per_y] = self.length.map(|length| length * LATTICE);
        let mut x_y = self.to_face[0] * self.length[1] - self.to_face[1] * self.length[0];
        let mut enter = Moment { part: 0, whole: 1 };
        let mut span = Span::new(&self);
        while self.left > 0 {
            let axis = usize::from(x_y > 0);
            let (low, high) = span.until(span.at_face[axis]);
            let leave = Moment { part: self.to_face[axis], whole: self.length[axis] };
            if !look.open.has_all(self.column, low, high) {
                self.meet(look, enter, leave);
                if self.alive == 0 {
                    return;
                }
                span.narrow(&self);
            }
            x_y += if axis == 0 { per_y } else { -per_x };
            span.step(axis);
            self.to_face[axis] += LATTICE;
            self.column = self.column.wrapping_add_signed(self.step[axis]);
            self.left -= 1;
            enter = leave;
        }
        self.meet(look, enter, Moment { part: 1, whole: 1 });
    }

    /// Marks what each ray meets in a column; rays that meet an end are alive no more.
    #[inline(never)]
    fn meet(&mut self, look: &mut Look, enter: Moment, leave: Moment) {
        let (mut first, mut last) = (self.levels(enter), self.levels(leave));
        for k in self.alive.trailing_zeros()..64 - self.alive.leading_zeros() {
            let (from, to) = (first.next_level(), last.next_level());
            if self.alive >> k & 1 == 1 && look.meet_between(self.column, from, to) {
                self.alive &= !(1 << k);
            }
        }
    }

    /// Height of a target, lattice units.
    fn target_z(&self, k: u32) -> i64 {
        (self.bottom as i64 + i64::from(k)) * LATTICE + LATTICE / 2 + 1
    }

    /// The heights of the rays at a moment, from the lowest that is alive upwards.
    fn levels(&self, at: Moment) -> Levels {
        let rise = self.target_z(self.alive.trailing_zeros()) - self.start_z;
        let (height, face) = (self.start_z * at.whole + rise * at.part, LATTICE * at.whole);
        Levels { level: height / face, above: height % face, step: LATTICE * at.part, face, rise }
    }
}

/// The voxels' heights that rays to successive targets are at, all at one moment.
///
/// A ray that comes to a face of z and of x or y at once is still on this side of z's.
struct Levels {
    level: i64,
    above: i64,
    step: i64,
    face: i64,
    /// From the start to the target, lattice units.
    rise: i64,
}

impl Levels {
    #[inline]
    fn next_level(&mut self) -> usize {
        let level = self.level - i64::from(self.rise > 0 && self.above == 0);
        self.rise += LATTICE;
        self.above += self.step;
        if self.above >= self.face {
            self.above -= self.face;
            self.level += 1;
        }
        level as usize
    }
}

/// Between which heights the rays of a fan are, fixed point: never too narrow.
struct Span {
    /// Heights of the lowest and highest ray where they entered the column.
    at: [i64; 2],
    /// The same at the next faces of x and y.
    at_face: [[i64; 2]; 2],
    /// What a step along x, y adds.
    per_step: [[i64; 2]; 2],
}

impl Span {
    fn new(fan: &Fan) -> Self {
        let start = fan.start_z * (ONE / LATTICE);
        let mut span = Self { at: [start; 2], at_face: [[0; 2]; 2], per_step: [[0; 2]; 2] };
        span.narrow(fan);
        span.at = [start; 2];
        span
    }

    /// Takes in which rays are still alive.
    fn narrow(&mut self, fan: &Fan) {
        let ends = [fan.alive.trailing_zeros(), 63 - fan.alive.leading_zeros()];
        let start = fan.start_z as f64;
        let rise = ends.map(|k| fan.target_z(k) as f64 - start);
        const FINE: f64 = (ONE / LATTICE) as f64;
        for axis in 0..2 {
            let share = |part: i64| part as f64 / fan.length[axis] as f64;
            let (next, step) = (share(fan.to_face[axis]), share(LATTICE));
            self.at_face[axis] = rise.map(|rise| ((start + rise * next) * FINE) as i64);
            self.per_step[axis] = rise.map(|rise| (rise * step * FINE) as i64);
        }
    }

    /// The heights of voxels that rays may be in from where they entered to those heights.
    #[inline]
    fn until(&self, leave: [i64; 2]) -> (usize, usize) {
        let low = self.at[0].min(leave[0]) - UNSURE;
        let high = self.at[1].max(leave[1]) + UNSURE;
        ((low / ONE) as usize, (high / ONE) as usize)
    }

    #[inline]
    fn step(&mut self, axis: usize) {
        self.at = self.at_face[axis];
        self.at_face[axis][0] += self.per_step[axis][0];
        self.at_face[axis][1] += self.per_step[axis][1];
    }
}
