//! Rays side by side, in 32 bits.
//!
//! ```text
//!   end                                                        origin
//!    o----|---------|---------|---------|---------|---------|----o      along one axis
//!    |face|  2048   |                                        full
//! ```
//!
//! Both ends are odd, so that no end lies on a face and the way along each axis is even. Cross
//! products of half ways stay below 2^31 as long as no way is [`LONGEST`]: see [`crate::walkers`].

use occlabel_core::{FAR_LANE, LATTICE, LatticePoint};

/// How many rays are cast at a time.
pub(crate) const LANES: usize = 16;

/// One number of each ray.
pub(crate) type Lane = [i32; LANES];

/// Bits of the lattice within a voxel.
const BITS: u32 = LATTICE.trailing_zeros();

/// Ways this long along an axis are walked one by one: 1024 voxels.
const LONGEST: i64 = 1 << (10 + BITS);

/// A walk can begin at any of so many places along a ray, none farther than 8 voxels from the next:
/// what was met until then is the shift of a product, exactly.
pub(crate) const PARTS: i32 = 128;

/// Where a way stands that leads nowhere: far from any grid.
const NOWHERE: i32 = 1 - 2 * FAR_LANE;

/// The straight ways of rays from their ends to their origins.
pub(crate) struct Ways {
    /// The voxel of the end.
    pub(crate) start: [Lane; 3],
    /// 0 along axes that lead up, -1 along those that lead down.
    pub(crate) back: [Lane; 3],
    /// The way along each axis, lattice units.
    pub(crate) full: [Lane; 3],
    /// From the end to the first face.
    pub(crate) face: [Lane; 3],
    /// How many faces there are on the way.
    pub(crate) faces: [Lane; 3],
}

/// Ends and origins on the lattice.
pub(crate) struct Batch {
    pub(crate) end: [Lane; 3],
    pub(crate) origin: [Lane; 3],
    /// -1 for rays that end on a flat class, else 0.
    pub(crate) flat: Lane,
}

impl Batch {
    /// No rays.
    pub(crate) fn empty() -> Self {
        Self { end: [[NOWHERE; LANES]; 3], origin: [[NOWHERE; LANES]; 3], flat: [0; LANES] }
    }

    /// Takes a ray out.
    #[inline(always)]
    pub(crate) fn remove(&mut self, lane: usize) {
        for axis in 0..3 {
            self.end[axis][lane] = NOWHERE;
            self.origin[axis][lane] = NOWHERE;
        }
    }

    /// Puts a ray in, which must fit.
    #[inline(always)]
    pub(crate) fn put(&mut self, lane: usize, end: LatticePoint, origin: LatticePoint) {
        for axis in 0..3 {
            self.end[axis][lane] = end.0[axis] as i32;
            self.origin[axis][lane] = origin.0[axis] as i32;
        }
    }

    /// Puts a ray of another batch in.
    #[inline(always)]
    pub(crate) fn copy(&mut self, to: usize, other: &Self, from: usize) {
        for axis in 0..3 {
            self.end[axis][to] = other.end[axis][from];
            self.origin[axis][to] = other.origin[axis][from];
        }
        self.flat[to] = other.flat[from];
    }

    /// Which rays end in the grid: -1 where they do, else 0.
    #[inline(always)]
    pub(crate) fn ends_inside(&self, shape: [i32; 3]) -> Lane {
        let mut inside = [-1; LANES];
        for axis in 0..3 {
            for lane in 0..LANES {
                let voxel = self.end[axis][lane] >> BITS;
                inside[lane] &= -i32::from(0 <= voxel) & -i32::from(voxel < shape[axis]);
            }
        }
        inside
    }

    /// Which rays may pass through the grid, as no side of it parts them from it: -1, else 0.
    #[inline(always)]
    pub(crate) fn may_pass(&self, shape: [i32; 3]) -> Lane {
        let mut may = [-1; LANES];
        for axis in 0..3 {
            for lane in 0..LANES {
                let (end, origin) = (self.end[axis][lane] >> BITS, self.origin[axis][lane] >> BITS);
                may[lane] &= -i32::from(end.max(origin) >= 0);
                may[lane] &= -i32::from(end.min(origin) < shape[axis]);
            }
        }
        may
    }

    /// The place in the flat array of the voxel that a ray ends in, if it is in the grid.
    #[inline(always)]
    pub(crate) fn end_flat(&self, lane: usize, strides: [i32; 3]) -> usize {
        let place = |axis: usize| (self.end[axis][lane] >> BITS) * strides[axis];
        (place(0) + place(1) + place(2)) as usize
    }

    /// Sets the origin of a ray; one too far away stays so.
    #[inline(always)]
    pub(crate) fn put_origin(&mut self, lane: usize, origin: LatticePoint) {
        for axis in 0..3 {
            let far = i64::from(FAR_LANE);
            self.origin[axis][lane] = origin.0[axis].clamp(-far, far) as i32;
        }
    }

    /// Sets the origin of all rays.
    #[inline(always)]
    pub(crate) fn share_origin(&mut self, origin: LatticePoint) {
        self.put_origin(0, origin);
        for axis in 0..3 {
            self.origin[axis] = [self.origin[axis][0]; LANES];
        }
    }

    /// Which rays are too far or too long for 32 bits: -1, else 0.
    #[inline(always)]
    pub(crate) fn misfits(&self) -> Lane {
        let mut misfit = [0; LANES];
        for axis in 0..3 {
            for lane in 0..LANES {
                let (end, origin) = (self.end[axis][lane], self.origin[axis][lane]);
                let is_far = (end.abs() >= FAR_LANE) | (origin.abs() >= FAR_LANE);
                let is_long = (origin - end).abs() >= LONGEST as i32;
                misfit[lane] |= -i32::from((is_far | is_long) & (end != NOWHERE));
            }
        }
        misfit
    }
}

/// Whether the lattice points of a ray fit into 32 bits, and its way too.
pub(crate) fn fits(end: LatticePoint, origin: LatticePoint) -> bool {
    let is_near = |q: i64| q.abs() < i64::from(FAR_LANE);
    (0..3).all(|axis| {
        let (end, origin) = (end.0[axis], origin.0[axis]);
        is_near(end) && is_near(origin) && (origin - end).abs() < LONGEST
    })
}

/// Whether any lane is not 0.
#[inline(always)]
pub(crate) fn any(lane: &Lane) -> bool {
    lane.iter().fold(0, |any, value| any | value) != 0
}

/// Whether all lanes are -1.
#[inline(always)]
pub(crate) fn all(lane: &Lane) -> bool {
    lane.iter().fold(-1, |all, value| all & value) == -1
}

impl Ways {
    #[inline(always)]
    pub(crate) fn new(batch: &Batch) -> Self {
        let zero = [[0; LANES]; 3];
        let mut ways = Self { start: zero, back: zero, full: zero, face: zero, faces: zero };
        for axis in 0..3 {
            for lane in 0..LANES {
                let end = batch.end[axis][lane];
                let way = batch.origin[axis][lane] - end;
                let back = way >> 31;
                let within = end & (LATTICE as i32 - 1);
                let voxels = (batch.origin[axis][lane] >> BITS) - (end >> BITS);
                ways.start[axis][lane] = end >> BITS;
                ways.faces[axis][lane] = (voxels ^ back) - back;
                ways.back[axis][lane] = back;
                ways.full[axis][lane] = (way ^ back) - back;
                ways.face[axis][lane] = (within & back) | ((LATTICE as i32 - within) & !back);
            }
        }
        ways
    }

    /// How many faces each ray meets before it has gone so many of [`PARTS`] equal parts of its way.
    /// A face at that very place is not met yet.
    #[inline(always)]
    pub(crate) fn faces_before(&self, part: &Lane) -> [Lane; 3] {
        // An axis at a time: of loops in one another the compiler makes gathers.
        [0, 1, 2].map(|axis| {
            let (full, face) = (self.full[axis], self.face[axis]);
            let mut faces = [0; LANES];
            for lane in 0..LANES {
                let past = full[lane] * part[lane] - face[lane] * PARTS - 1;
                faces[lane] = (past >> (PARTS.trailing_zeros() + BITS)) + 1;
            }
            faces
        })
    }

    /// The last of [`PARTS`] places at which each ray surely has not entered the grid yet; the end
    /// of its way if it never does. Reckoned in `f32`, with a voxel and a part to spare.
    #[inline(always)]
    pub(crate) fn part_before_grid(&self, shape: [i32; 3]) -> Lane {
        let (mut enter, mut leave) = ([0.0_f32; LANES], [1.0_f32; LANES]);
        for axis in 0..3 {
            for lane in 0..LANES {
                let back = self.back[axis][lane];
                let at = (self.start[axis][lane] ^ back) - back + (back & (shape[axis] - 1));
                let per_voxel = LATTICE as f32 / self.full[axis][lane].max(1) as f32;
                enter[lane] = enter[lane].max((-at - 2) as f32 * per_voxel);
                leave[lane] = leave[lane].min((shape[axis] - at + 1) as f32 * per_voxel);
            }
        }
        let mut part = [0; LANES];
        for lane in 0..LANES {
            let before = ((enter[lane] * PARTS as f32) as i32 - 1).max(0);
            part[lane] = if enter[lane] <= leave[lane] { before } else { PARTS };
        }
        part
    }
}
