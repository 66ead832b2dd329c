//! Range rings of a grid's columns.

use occlabel_core::{GridSpec, VoxelIndex};

/// The ring of each column of voxels, by its centre's horizontal distance from the grid frame's
/// origin. Rings are half-open: an outer radius belongs to the next; the last reaches to the end.
#[derive(Clone, Debug)]
pub(crate) struct Rings {
    of_column: Vec<usize>,
    count: usize,
}

impl Rings {
    pub(crate) fn new(spec: &GridSpec, outer_m: &[f64]) -> Self {
        let [nx, ny, _] = spec.shape();
        let ring = |column: usize| {
            let (x, y) = (column / ny, column % ny);
            let centre = spec.centre(VoxelIndex([x as i64, y as i64, 0]));
            let distance_m = (centre.x * centre.x + centre.y * centre.y).sqrt();
            outer_m.iter().filter(|&&outer_m| distance_m >= outer_m).count()
        };
        Self { of_column: (0..nx * ny).map(ring).collect(), count: outer_m.len() + 1 }
    }

    /// How many rings there are: one without radii.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Runs of columns of one ring, in flat order: the ring, and the columns.
    pub(crate) fn runs(&self) -> impl Iterator<Item = (usize, std::ops::Range<usize>)> + '_ {
        let mut start = 0;
        self.of_column.chunk_by(|a, b| a == b).map(move |run| {
            let columns = start..start + run.len();
            start = columns.end;
            (run[0], columns)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_begins_at_its_inner_radius() {
        let spec = GridSpec::new([0.0, -0.5, 0.0], [12.0, 0.5, 1.0], [1.0; 3]).unwrap();
        let rings = Rings::new(&spec, &[1.5, 10.0]);
        // Centres stand at 0.5, 1.5, ... 11.5 m on the x axis.
        assert_eq!(rings.runs().collect::<Vec<_>>(), [(0, 0..1), (1, 1..10), (2, 10..12)]);
        assert_eq!((rings.count(), Rings::new(&spec, &[]).count()), (3, 1));
    }
}
