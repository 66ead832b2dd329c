//! A grid of larger voxels, each a block of a finer grid's.

use crate::{Fault, GridSpec, VoxelGrid, VoxelIndex};

/// A grid of larger voxels over the same space as a finer grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    fine: GridSpec,
    coarse: GridSpec,
    /// Voxels of the fine grid along each edge of a block.
    edges: [usize; 3],
}

impl Blocks {
    /// The blocks of a grid that are voxels of this size, metres.
    ///
    /// # Errors
    /// If an edge is no whole number of voxels (to 1e-6), is one voxel along all axes, or does not
    /// divide the grid.
    pub fn of(fine: &GridSpec, size_m: [f64; 3]) -> Result<Self, Fault> {
        let mut edges = [0; 3];
        for axis in 0..3 {
            let exact = size_m[axis] / fine.size_m()[axis];
            let whole = exact.round();
            let divides = whole >= 1.0 && fine.shape()[axis].is_multiple_of(whole as usize);
            if !divides || (exact - whole).abs() > 1e-6 {
                return Err(no_blocks(fine, size_m));
            }
            edges[axis] = whole as usize;
        }
        if edges == [1; 3] {
            return Err(no_blocks(fine, size_m));
        }
        let coarse = GridSpec::new(fine.min_m().into(), fine.max_m().into(), size_m)?;
        Ok(Self { fine: fine.clone(), coarse, edges })
    }

    /// The grid of the blocks.
    pub fn coarse(&self) -> &GridSpec {
        &self.coarse
    }

    /// A grid of what `f` makes of each block: of the places in the fine grid's flat array of its
    /// voxels, in order.
    pub fn map<T>(&self, f: impl FnMut(&[usize]) -> T) -> VoxelGrid<T> {
        let mut f = f;
        let mut places = Vec::with_capacity(self.edges.iter().product());
        let values = self.coarse.voxels().map(|block| {
            places.clear();
            places.extend(self.places(block));
            f(&places)
        });
        VoxelGrid::from_values(&self.coarse, values.collect())
    }

    fn places(&self, block: VoxelIndex) -> impl Iterator<Item = usize> + '_ {
        let span = |axis: usize| {
            let first = block.0[axis] as usize * self.edges[axis];
            first..first + self.edges[axis]
        };
        let [_, ny, nz] = self.fine.shape();
        let (xs, ys, zs) = (span(0), span(1), span(2));
        xs.flat_map(move |x| {
            let zs = zs.clone();
            ys.clone().flat_map(move |y| zs.clone().map(move |z| (x * ny + y) * nz + z))
        })
    }
}

fn no_blocks(fine: &GridSpec, size_m: [f64; 3]) -> Fault {
    let ([nx, ny, nz], size) = (fine.shape(), fine.size_m());
    let expected = format!(
        "a whole multiple of {} x {} x {} m that divides {nx} x {ny} x {nz} voxels",
        size.x, size.y, size.z
    );
    let [x, y, z] = size_m;
    Fault::new("pooled-grid", "voxel size", expected, format!("{x} x {y} x {z} m"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fine() -> GridSpec {
        GridSpec::new([-2.0, 0.0, -1.0], [2.0, 6.0, 3.0], [1.0, 1.0, 2.0]).unwrap()
    }

    #[test]
    fn every_voxel_is_in_the_block_that_holds_its_centre_and_in_no_other() {
        let blocks = Blocks::of(&fine(), [2.0, 3.0, 4.0]).unwrap();
        assert_eq!(blocks.coarse().shape(), [2, 2, 1]);
        let held = blocks.map(|places| places.to_vec());
        let mut seen = 0;
        for (block, places) in held.values().iter().enumerate() {
            assert!(places.is_sorted());
            for &place in places {
                let centre = fine().centre(fine().voxel_at(place));
                assert_eq!(blocks.coarse().flat_of(&centre), Some(block));
                seen += 1;
            }
        }
        assert_eq!(seen, fine().len());
    }

    #[test]
    fn a_size_that_makes_no_whole_blocks_is_refused() {
        let tiny = [[1.0, 1.0, 2.0], [0.5, 1.0, 2.0], [3.0, 1.0, 2.0], [1.5, 1.0, 2.0], [0.0; 3]];
        for size_m in tiny {
            assert_eq!(Blocks::of(&fine(), size_m).unwrap_err().rule, "pooled-grid", "{size_m:?}");
        }
        assert!(Blocks::of(&fine(), [4.0, 6.0, 4.0]).is_ok());
    }
}
