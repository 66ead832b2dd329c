//! Where a voxel begins: the only place that knows.
//!
//! ```text
//!   min_m                                     max_m
//!     |  voxel 0  |  voxel 1  |    ...    |  n-1  |      u = (p - min) / size, voxel = floor(u)
//!     +-----.-----+-----.-----+           +---.---+      half-open cells: [i, i + 1)
//!           ^ centre of voxel i: u = i + 0.5
//! ```

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use crate::{BUNDLE, Fault, RigidMap};

/// Lattice units along one voxel edge (labels.md section 8).
pub const LATTICE: i64 = 2048;

/// Lattice coordinates from which 32 bits do not suffice: a quarter of a million voxels away.
pub const FAR_LANE: i32 = 1 << 29;

/// The grid's shape, checked: half-open cells, C order, z fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSpec {
    min_m: Point3<f64>,
    max_m: Point3<f64>,
    size_m: Vector3<f64>,
    shape: [usize; 3],
}

/// A voxel's integer coordinates. They may lie outside the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VoxelIndex(pub [i64; 3]);

/// A point of the lattice that rays live on: odd coordinates in units of 1/2048 voxel, so that no
/// end ever lies on a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatticePoint(pub [i64; 3]);

impl LatticePoint {
    /// The voxel it lies in.
    #[inline]
    pub fn voxel(&self) -> VoxelIndex {
        VoxelIndex(self.0.map(|q| q.div_euclid(LATTICE)))
    }
}

impl GridSpec {
    /// A grid from its lower corner, upper corner and voxel size, metres.
    ///
    /// # Errors
    /// If a number is not finite, a size is not above 0, a side is no whole number of voxels (to
    /// 1e-6), or there are more voxels than fit in 32 bits.
    pub fn new(min_m: [f64; 3], max_m: [f64; 3], size_m: [f64; 3]) -> Result<Self, Fault> {
        let mut shape = [0; 3];
        for axis in 0..3 {
            shape[axis] = voxels_along(axis, min_m[axis], max_m[axis], size_m[axis])?;
        }
        check_count(shape)?;
        Ok(Self {
            min_m: min_m.into(),
            max_m: max_m.into(),
            size_m: size_m.into(),
            shape: shape.map(|n| n as usize),
        })
    }

    /// Lower corner, metres.
    pub fn min_m(&self) -> Point3<f64> {
        self.min_m
    }

    /// Upper corner, metres.
    pub fn max_m(&self) -> Point3<f64> {
        self.max_m
    }

    /// Voxel size along each axis, metres.
    pub fn size_m(&self) -> Vector3<f64> {
        self.size_m
    }

    /// Voxels along x, y, z.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// How many voxels there are.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Never: a grid has at least one voxel.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Steps in the flat array for a step along x, y, z.
    #[inline]
    pub fn strides(&self) -> [usize; 3] {
        [self.shape[1] * self.shape[2], self.shape[2], 1]
    }

    /// A point of the grid frame in voxel units: one subtraction and one division per axis.
    #[inline]
    pub fn to_voxel_units(&self, p: &Point3<f64>) -> Vector3<f64> {
        (p - self.min_m).component_div(&self.size_m)
    }

    /// The point of the lattice that stands for a point of the grid frame, in the same voxel.
    #[inline]
    pub fn snap(&self, p: &Point3<f64>) -> LatticePoint {
        let u = self.to_voxel_units(p);
        LatticePoint([snap_axis(u.x), snap_axis(u.y), snap_axis(u.z)])
    }

    /// [`Self::snap`] of points that `place` brings into the grid frame, axis by axis, side by side.
    ///
    /// The same numbers, but that coordinates of [`FAR_LANE`] and more saturate there: points so far
    /// away have to be snapped one by one.
    #[inline(always)]
    pub fn snap_lanes<const N: usize>(
        &self,
        place: &RigidMap,
        points: &[Point3<f64>; N],
    ) -> [[i32; N]; 3] {
        let mut placed = [[0.0; N]; 3];
        for lane in 0..N {
            let p = place.apply(&points[lane]);
            (placed[0][lane], placed[1][lane], placed[2][lane]) = (p.x, p.y, p.z);
        }
        let mut snapped = [[0; N]; 3];
        let mut is_sure = true;
        for axis in 0..3 {
            let (min, per_m) = (self.min_m[axis], (LATTICE / 2) as f64 / self.size_m[axis]);
            for lane in 0..N {
                let half = (placed[axis][lane] - min) * per_m;
                snapped[axis][lane] = snap_lane(half);
                let beyond = half - f64::from((snapped[axis][lane] - 1) / 2);
                is_sure &= (beyond > UNSURE) & (beyond < 1.0 - UNSURE);
            }
        }
        if is_sure { snapped } else { self.snap_lanes_by_division(&placed) }
    }

    /// The places in the flat array of the voxels that hold the points of a bundle, once `place` has
    /// brought them into the grid frame. Lanes without a point have none.
    ///
    /// # Panics
    /// If there are more points than in a bundle.
    #[inline(always)]
    pub fn flats_of(&self, place: &RigidMap, points: &[Point3<f64>]) -> [Option<usize>; BUNDLE] {
        let mut bundle = [Point3::origin(); BUNDLE];
        bundle[..points.len()].copy_from_slice(points);
        let snapped = self.snap_lanes(place, &bundle);
        let mut flats = [None; BUNDLE];
        for (lane, point) in points.iter().enumerate() {
            let q = [snapped[0][lane], snapped[1][lane], snapped[2][lane]].map(i64::from);
            let is_far = q.iter().any(|q| q.abs() >= i64::from(FAR_LANE));
            flats[lane] = match is_far {
                true => self.flat_of(&place.apply(point)),
                false => self.flat(LatticePoint(q).voxel()),
            };
        }
        flats
    }

    /// The few whose last digit decides are divided, as the rule says.
    #[cold]
    #[inline(never)]
    fn snap_lanes_by_division<const N: usize>(&self, placed: &[[f64; N]; 3]) -> [[i32; N]; 3] {
        let mut snapped = [[0; N]; 3];
        for axis in 0..3 {
            for lane in 0..N {
                let u = (placed[axis][lane] - self.min_m[axis]) / self.size_m[axis];
                snapped[axis][lane] = snap_lane(u * (LATTICE / 2) as f64);
            }
        }
        snapped
    }

    /// The centre of a voxel on the lattice, exactly.
    #[inline]
    pub fn lattice_centre(&self, voxel: VoxelIndex) -> LatticePoint {
        LatticePoint(voxel.0.map(|i| i * LATTICE + LATTICE / 2 + 1))
    }

    /// The centre of a voxel in the grid frame, metres.
    pub fn centre(&self, voxel: VoxelIndex) -> Point3<f64> {
        let u = Vector3::from(voxel.0.map(|i| i as f64 + 0.5));
        self.min_m + u.component_mul(&self.size_m)
    }

    /// The lower corner of a voxel in the grid frame, metres.
    pub fn corner(&self, voxel: VoxelIndex) -> Point3<f64> {
        self.min_m + Vector3::from(voxel.0.map(|i| i as f64)).component_mul(&self.size_m)
    }

    /// The place of a voxel in the flat array, if it is in the grid.
    #[inline]
    pub fn flat(&self, voxel: VoxelIndex) -> Option<usize> {
        let [nx, ny, nz] = self.shape;
        let [x, y, z] = voxel.0.map(|i| usize::try_from(i).unwrap_or(usize::MAX));
        (x < nx && y < ny && z < nz).then(|| (x * ny + y) * nz + z)
    }

    /// The place of the voxel that holds a point of the grid frame, if it is in the grid.
    #[inline]
    pub fn flat_of(&self, p: &Point3<f64>) -> Option<usize> {
        let u = self.to_voxel_units(p);
        self.flat(VoxelIndex([u.x, u.y, u.z].map(|u| u.floor() as i64)))
    }

    /// The voxel at a place of the flat array.
    #[inline]
    pub fn voxel_at(&self, flat: usize) -> VoxelIndex {
        let [_, ny, nz] = self.shape;
        VoxelIndex([flat / (ny * nz), flat / nz % ny, flat % nz].map(|i| i as i64))
    }

    /// All voxels in the order of the flat array.
    pub fn voxels(&self) -> impl Iterator<Item = VoxelIndex> + '_ {
        (0..self.len()).map(|flat| self.voxel_at(flat))
    }

    /// The voxels that reach into the box between two points of the grid frame, axis by axis, cut to the
    /// grid.
    pub fn voxels_between(&self, low: &Point3<f64>, high: &Point3<f64>) -> [Range<i64>; 3] {
        let (low, high) = (self.to_voxel_units(low), self.to_voxel_units(high));
        std::array::from_fn(|axis| {
            let n = self.shape[axis] as i64;
            let first = (low[axis].floor() as i64).clamp(0, n);
            first..(high[axis].floor() as i64).saturating_add(1).clamp(first, n)
        })
    }

    /// Voxels whose centres can lie within `radius_m` of a point: a box of indices, cut to the grid.
    pub fn voxels_near(
        &self,
        p: &Point3<f64>,
        radius_m: f64,
    ) -> impl Iterator<Item = VoxelIndex> + use<> {
        let reach = Vector3::repeat(radius_m);
        let [xs, ys, zs] = self.voxels_between(&(p - reach), &(p + reach));
        xs.flat_map(move |x| {
            let zs = zs.clone();
            ys.clone().flat_map(move |y| zs.clone().map(move |z| VoxelIndex([x, y, z])))
        })
    }
}

/// `2 * floor(u * 1024) + 1`. Coordinates too large for the lattice saturate far outside the grid.
#[inline]
fn snap_axis(u: f64) -> i64 {
    const FAR: f64 = (1_i64 << 60) as f64;
    let half = (u * (LATTICE / 2) as f64).clamp(-FAR, FAR);
    let cut = half as i64;
    2 * (cut - i64::from(cut as f64 > half)) + 1
}

/// How near to a lattice point's limit a product may be taken for a quotient: for coordinates below
/// [`FAR_LANE`] the two differ by less than 2e-7.
const UNSURE: f64 = 1e-6;

/// `2 * floor(half) + 1` in 32 bits, in operations that every vector unit has: the sum with
/// [`WHOLE`] holds the nearest whole number in its last bits.
#[inline(always)]
fn snap_lane(half: f64) -> i32 {
    const FAR: f64 = (FAR_LANE / 2) as f64;
    const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;
    let half = if half < FAR { half } else { FAR };
    let half = if half > -FAR - 1.0 { half } else { -FAR - 1.0 };
    let nearest = (half + WHOLE).to_bits() as i32;
    2 * (nearest - i32::from(f64::from(nearest) > half)) + 1
}

fn voxels_along(axis: usize, min: f64, max: f64, size: f64) -> Result<u64, Fault> {
    let name = ["x", "y", "z"][axis];
    if !(min.is_finite() && max.is_finite() && size.is_finite() && size > 0.0) {
        let found = format!("min {min} m, max {max} m, voxel {size} m along {name}");
        return Err(grid_fault("finite limits and a voxel size above 0", found));
    }
    let exact = (max - min) / size;
    let whole = exact.round();
    if whole < 1.0 || (exact - whole).abs() > 1e-6 {
        let found = format!("{exact} voxels of {size} m from {min} m to {max} m along {name}");
        return Err(grid_fault("a whole number of voxels, at least 1, on each side", found));
    }
    Ok(whole as u64)
}

fn check_count(shape: [u64; 3]) -> Result<(), Fault> {
    let [x, y, z] = shape.map(u128::from);
    let voxels = x.saturating_mul(y).saturating_mul(z);
    if voxels > u128::from(u32::MAX) {
        let bytes = voxels.saturating_mul(3);
        let found = format!("{x} x {y} x {z} = {voxels} voxels, {bytes} bytes in labels.npz alone");
        return Err(grid_fault("at most 4294967295 voxels", found));
    }
    Ok(())
}

fn grid_fault(expected: &str, found: String) -> Fault {
    Fault::new("grid", "[grid] min_m, max_m, voxel_size_m", expected, found)
}

/// A value for every voxel, `[x][y][z]` in C order.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelGrid<T> {
    shape: [usize; 3],
    values: Vec<T>,
}

impl<T> VoxelGrid<T> {
    /// The same value everywhere.
    pub fn filled(spec: &GridSpec, value: T) -> Self
    where
        T: Clone,
    {
        Self { shape: spec.shape(), values: vec![value; spec.len()] }
    }

    /// A grid of values in flat order.
    ///
    /// # Panics
    /// If there is not one value per voxel.
    pub fn from_values(spec: &GridSpec, values: Vec<T>) -> Self {
        assert_eq!(values.len(), spec.len(), "one value per voxel");
        Self { shape: spec.shape(), values }
    }

    /// Voxels along x, y, z.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// All values in flat order.
    #[inline]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// All values in flat order, to change.
    #[inline]
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The values themselves, in flat order.
    pub fn into_values(self) -> Vec<T> {
        self.values
    }

    /// A grid of what `f` makes of each value.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> VoxelGrid<U> {
        VoxelGrid { shape: self.shape, values: self.values.iter().map(f).collect() }
    }

    /// A grid of what `f` makes of each value and the other grid's value there.
    ///
    /// # Panics
    /// If the grids differ in shape.
    pub fn zip_map<U, V>(
        &self,
        other: &VoxelGrid<U>,
        mut f: impl FnMut(&T, &U) -> V,
    ) -> VoxelGrid<V> {
        assert_eq!(self.shape, other.shape, "grids of one shape");
        let pairs = self.values.iter().zip(&other.values);
        VoxelGrid { shape: self.shape, values: pairs.map(|(a, b)| f(a, b)).collect() }
    }

    /// The value of a voxel in the grid, by its indices.
    pub fn at(&self, [x, y, z]: [usize; 3]) -> &T {
        &self.values[(x * self.shape[1] + y) * self.shape[2] + z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn occ3d() -> GridSpec {
        GridSpec::new([-40.0, -40.0, -1.0], [40.0, 40.0, 5.4], [0.4; 3]).unwrap()
    }

    #[test]
    fn section_1_the_shape_is_whole_to_a_millionth() {
        assert_eq!(occ3d().shape(), [200, 200, 16]);
        let uneven = GridSpec::new([0.0; 3], [1.0, 1.0, 1.0], [0.3; 3]);
        assert!(uneven.unwrap_err().to_string().contains("3.33"));
    }

    #[test]
    fn section_1_cells_are_half_open() {
        let spec = GridSpec::new([0.0; 3], [4.0; 3], [1.0; 3]).unwrap();
        let voxel = |x: f64| spec.snap(&Point3::new(x, 0.5, 0.5)).voxel().0[0];
        assert_eq!([0.0, 0.999_999, 1.0, 3.999_999, 4.0, -1e-12].map(voxel), [0, 0, 1, 3, 4, -1]);
        assert_eq!(spec.flat(VoxelIndex([4, 0, 0])), None);
        assert_eq!(spec.flat(VoxelIndex([-1, 0, 0])), None);
    }

    #[test]
    fn section_8_a_snapped_end_keeps_its_voxel_and_never_lies_on_a_face() {
        let spec = occ3d();
        let mut tried = 0;
        for step in -4000..4000 {
            let p = Point3::from(Vector3::repeat(f64::from(step) * 0.0137));
            let (snapped, u) = (spec.snap(&p), spec.to_voxel_units(&p));
            assert!(snapped.0.iter().all(|q| q % 2 != 0));
            assert_eq!(snapped.voxel().0, [u.x, u.y, u.z].map(|u| u.floor() as i64));
            assert_eq!(spec.flat(snapped.voxel()), spec.flat_of(&p));
            tried += 1;
        }
        assert_eq!(tried, 8000);
    }

    #[test]
    fn section_8_the_centre_of_a_voxel_is_exact() {
        let centre = occ3d().lattice_centre(VoxelIndex([0, 1, -2]));
        assert_eq!(centre, LatticePoint([1025, 3073, -3071]));
        assert_eq!(centre.voxel(), VoxelIndex([0, 1, -2]));
    }

    #[test]
    fn flat_places_and_voxels_are_the_same_thing() {
        let spec = GridSpec::new([0.0; 3], [3.0, 4.0, 5.0], [1.0; 3]).unwrap();
        for (flat, voxel) in spec.voxels().enumerate() {
            assert_eq!(spec.flat(voxel), Some(flat));
        }
        let [sx, sy, sz] = spec.strides();
        assert_eq!(spec.flat(VoxelIndex([1, 1, 1])), Some(sx + sy + sz));
    }

    #[test]
    fn fault_32_impossible_grids_are_refused_with_their_numbers() {
        for size in [0.0, -0.4, f64::NAN, f64::INFINITY, 0.3, 1e6] {
            assert!(GridSpec::new([-40.0; 3], [40.0; 3], [size; 3]).is_err(), "{size}");
        }
        let tiny = GridSpec::new([-40.0; 3], [40.0; 3], [1e-6; 3]).unwrap_err().to_string();
        assert!(tiny.contains("80000000 x 80000000 x 80000000"), "{tiny}");
        assert!(tiny.contains("bytes"), "{tiny}");
    }

    #[test]
    fn fault_07_far_points_saturate_outside_the_grid() {
        let spec = occ3d();
        for far in [1e7, 1e300, -1e300, f64::MAX] {
            let snapped = spec.snap(&Point3::new(far, 0.0, 0.0));
            assert_eq!(spec.flat(snapped.voxel()), None, "{far}");
        }
    }

    #[test]
    fn voxels_near_holds_every_centre_in_reach() {
        let spec = GridSpec::new([0.0; 3], [4.0; 3], [0.5; 3]).unwrap();
        let (p, reach) = (Point3::new(1.3, 3.9, -0.2), 1.1);
        let near: Vec<_> = spec.voxels_near(&p, reach).collect();
        let within: Vec<_> =
            spec.voxels().filter(|v| (spec.centre(*v) - p).norm() <= reach).collect();
        assert!(within.len() > 5);
        assert!(within.iter().all(|v| near.contains(v)));
    }
}
