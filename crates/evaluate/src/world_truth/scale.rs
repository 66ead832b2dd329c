//! What labels are measured by.

use occlabel_core::{ClassSet, GridSpec, Taxonomy, VoxelIndex};

/// Outer radii of the range rings, metres.
pub const RINGS_M: [f64; 4] = [10.0, 20.0, 30.0, 40.0];

/// The grid, the classes, the rings and the noise that labels are judged by.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// The grid of labels and truth.
    pub spec: GridSpec,
    /// Class names in id order.
    pub classes: Vec<String>,
    /// The id of voxels that are not occupied.
    pub free: u8,
    /// The ground's classes.
    pub flat: ClassSet,
    /// Classes of those whose shape changes: people.
    pub deformable: ClassSet,
    /// Outer radii of the range rings, rising, metres. What lies beyond the last is a ring too.
    pub ring_m: Vec<f64>,
    /// Standard deviation of the logged ranges, metres; 0 if they are exact.
    pub noise_sigma_m: f64,
}

impl Scale {
    /// The usual rings, and no noise.
    pub fn new(spec: GridSpec, taxonomy: &Taxonomy) -> Self {
        Self {
            spec,
            classes: taxonomy.names.clone(),
            free: taxonomy.free,
            flat: taxonomy.flat,
            deformable: taxonomy.deformable,
            ring_m: RINGS_M.to_vec(),
            noise_sigma_m: 0.0,
        }
    }

    /// The ring of a column of voxels, by its centre's horizontal distance from the grid frame's
    /// origin: rings are half-open, the outer radius belongs to the next.
    pub(crate) fn ring(&self, x: usize, y: usize) -> usize {
        let centre = self.spec.centre(VoxelIndex([x as i64, y as i64, 0]));
        let distance_m = (centre.x * centre.x + centre.y * centre.y).sqrt();
        self.ring_m.iter().filter(|&&outer_m| distance_m >= outer_m).count()
    }

    /// The ring of a voxel by its place.
    pub(crate) fn ring_of(&self, flat: usize) -> usize {
        let [_, ny, nz] = self.spec.shape();
        self.ring(flat / nz / ny, flat / nz % ny)
    }

    /// How far noise may carry a return, in voxels of the shortest edge.
    pub(crate) fn noise_reach(&self) -> f64 {
        3.0 * self.noise_sigma_m / self.spec.size_m().min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_begins_at_its_inner_radius() {
        let spec = GridSpec::new([0.0, -0.5, 0.0], [12.0, 0.5, 1.0], [1.0; 3]).unwrap();
        let (classes, flat) = (vec![], ClassSet::default());
        let ring_m = vec![1.5, 10.0];
        let scale =
            Scale { spec, classes, free: 0, flat, deformable: flat, ring_m, noise_sigma_m: 0.1 };
        // Centres stand at 0.5, 1.5, ... 11.5 m on the x axis.
        let rings: Vec<usize> = (0..12).map(|x| scale.ring(x, 0)).collect();
        assert_eq!(rings, [0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2]);
        assert!((scale.noise_reach() - 0.3).abs() < 1e-12);
    }
}
