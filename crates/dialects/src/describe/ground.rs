//! Where the ground lies: under what stands on it, and how far below the origin.

use std::ops::AddAssign;

use occlabel_core::{GridSpec, VoxelGrid, VoxelIndex};

use crate::ClassTable;

/// In how many columns with ground and something else the ground is at the bottom, or at the top.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ColumnCounts {
    /// All ground is below all else.
    pub ground_below: u64,
    /// All ground is above all else.
    pub ground_above: u64,
}

/// So few columns do not tell.
const TELLING_COLUMNS: u64 = 20;

impl ColumnCounts {
    /// The columns of one grid.
    pub(crate) fn of(semantics: &VoxelGrid<u8>, classes: &ClassTable, flat: &[bool; 256]) -> Self {
        let [_, _, height] = semantics.shape();
        let mut counts = Self::default();
        for column in semantics.values().chunks_exact(height) {
            let is_ground = |class: u8| flat[usize::from(class)];
            let stands = |class: u8| class < classes.free_index() && !is_ground(class);
            if let (Some(ground), Some(rest)) = (span(column, is_ground), span(column, stands)) {
                counts.ground_below += u64::from(ground.1 < rest.0);
                counts.ground_above += u64::from(ground.0 > rest.1);
            }
        }
        counts
    }

    /// Whether the grid stands on its head.
    pub(crate) fn is_upside_down(&self) -> bool {
        self.ground_above >= TELLING_COLUMNS && self.ground_above > self.ground_below
    }
}

impl AddAssign for ColumnCounts {
    fn add_assign(&mut self, other: Self) {
        self.ground_below += other.ground_below;
        self.ground_above += other.ground_above;
    }
}

/// The lowest and the highest voxel of a column that is so.
fn span(column: &[u8], is: impl Fn(u8) -> bool) -> Option<(usize, usize)> {
    let first = column.iter().position(|class| is(*class))?;
    let last = column.iter().rposition(|class| is(*class))?;
    Some((first, last))
}

/// How much ground lies at each level near the grid frame's origin.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GroundLevels(Vec<u64>);

/// So far from the origin the ground counts, metres.
const NEAR_M: f64 = 10.0;

impl GroundLevels {
    pub(crate) fn of(spec: &GridSpec, semantics: &VoxelGrid<u8>, flat: &[bool; 256]) -> Self {
        let [_, sides, height] = semantics.shape();
        let mut levels = vec![0; height];
        for (at, column) in semantics.values().chunks_exact(height).enumerate() {
            let foot = spec.centre(VoxelIndex([(at / sides) as i64, (at % sides) as i64, 0]));
            if foot.x * foot.x + foot.y * foot.y <= NEAR_M * NEAR_M {
                let classes = levels.iter_mut().zip(column);
                classes.for_each(|(level, class)| *level += u64::from(flat[usize::from(*class)]));
            }
        }
        Self(levels)
    }

    /// The height of the level with most ground, metres; the lower of two.
    pub(crate) fn height_m(&self, spec: &GridSpec) -> Option<f64> {
        let most = self.0.iter().max().filter(|most| **most > 0)?;
        let level = self.0.iter().position(|count| count == most)?;
        Some(spec.centre(VoxelIndex([0, 0, level as i64])).z)
    }
}

impl AddAssign for GroundLevels {
    fn add_assign(&mut self, other: Self) {
        if self.0.len() < other.0.len() {
            self.0.resize(other.0.len(), 0);
        }
        self.0.iter_mut().zip(other.0).for_each(|(sum, more)| *sum += more);
    }
}
