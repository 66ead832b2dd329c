//! The label arrays as numpy reads them.
//!
//! `[x][y][z]`, C order, deflated at level 6, every entry dated 1980-01-01: the same labels give
//! the same bytes.

use std::io::Cursor;

use ndarray::{ArrayViewD, IxDyn};
use ndarray_npy::{NpzWriter, WriteNpyExt};
use occlabel_core::{Evidence, OccupancyLabels, VoxelGrid};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime};

use crate::{Number, NumberArray};

/// Level of zlib: 12 ms and 55 kB for a grid of 200 x 200 x 16; level 9 takes 100 ms for 43 kB.
const DEFLATE_LEVEL: i64 = 6;

/// Above this many bytes an array gets the 64-bit sizes of zip; they are 32-bit otherwise.
const LARGE_BYTES: usize = 1 << 31;

/// The bytes of `labels.npz`: `semantics`, `mask_lidar`, `mask_camera`, each u8.
pub fn labels_npz(labels: &OccupancyLabels) -> Vec<u8> {
    let mut npz = Archive::new();
    npz.add("semantics", &labels.semantics);
    npz.add("mask_lidar", &labels.mask_lidar);
    npz.add("mask_camera", &labels.mask_camera);
    npz.finish()
}

/// The bytes of `evidence.npz`: `hits`, `crossings` u16, `state` u8, `instances` u16, `flow` f32
/// `[x][y][z][3]` in metres per second, `camera_bits` u16.
pub fn evidence_npz(evidence: &Evidence) -> Vec<u8> {
    let mut npz = Archive::new();
    npz.add("hits", &evidence.hits);
    npz.add("crossings", &evidence.crossings);
    npz.add("state", &evidence.state);
    npz.add("instances", &evidence.instances);
    npz.add_vectors("flow", &evidence.flow);
    npz.add("camera_bits", &evidence.camera_bits);
    npz.finish()
}

/// The bytes of an `.npz` file of arrays, each by its name, in this order.
pub fn npz<'a>(arrays: impl IntoIterator<Item = (&'a str, &'a NumberArray)>) -> Vec<u8> {
    let mut npz = Archive::new();
    for (name, array) in arrays {
        npz.add_array(name, array, array.bytes.len());
    }
    npz.finish()
}

/// An npz in memory, where writing does not fail.
struct Archive(NpzWriter<Cursor<Vec<u8>>>);

impl Archive {
    fn new() -> Self {
        Self(NpzWriter::new(Cursor::new(Vec::new())))
    }

    fn add<T: Number>(&mut self, name: &str, grid: &VoxelGrid<T>) {
        self.add_values(name, &grid.shape(), grid.values());
    }

    fn add_vectors(&mut self, name: &str, grid: &VoxelGrid<[f32; 3]>) {
        let [x, y, z] = grid.shape();
        self.add_values(name, &[x, y, z, 3], grid.values().as_flattened());
    }

    fn add_values<T: Number>(&mut self, name: &str, shape: &[usize], values: &[T]) {
        let array = ArrayViewD::from_shape(IxDyn(shape), values).expect("one value per voxel");
        self.add_array(name, &array, size_of_val(values));
    }

    fn add_array(&mut self, name: &str, array: &impl WriteNpyExt, bytes: usize) {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .compression_level(Some(DEFLATE_LEVEL))
            .last_modified_time(DateTime::default())
            .large_file(bytes > LARGE_BYTES);
        self.0.add_array_with_options(name, array, options).expect("room in memory");
    }

    fn finish(self) -> Vec<u8> {
        self.0.finish().expect("room in memory").into_inner()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use occlabel_core::{GridSpec, VoxelState};
    use zip::ZipArchive;

    /// A grid with three different sides, so that no two axes can be mixed up unseen.
    pub(crate) fn spec() -> GridSpec {
        GridSpec::new([0.0; 3], [5.0, 4.0, 3.0], [1.0; 3]).unwrap()
    }

    /// Labels in which every voxel of every array is different from its neighbours.
    pub(crate) fn labels() -> OccupancyLabels {
        let spec = spec();
        let bytes = |step: usize| grid(|at| (at * step % 251) as u8);
        let words = |step: usize| grid(|at| (at * step % 65_521) as u16);
        let flow = spec.voxels().map(|voxel| voxel.0.map(|i| i as f32 - 0.25)).collect();
        OccupancyLabels {
            semantics: bytes(7),
            mask_lidar: grid(|at| (at % 2) as u8),
            mask_camera: grid(|at| (at % 3 == 0) as u8),
            states: grid(|at| [VoxelState::Unobserved, VoxelState::Free][at % 2]),
            evidence: Some(Evidence {
                hits: words(1009),
                crossings: words(2003),
                state: grid(|at| (at % 3) as u8),
                instances: words(3001),
                flow: VoxelGrid::from_values(&spec, flow),
                camera_bits: words(4001),
            }),
        }
    }

    fn grid<T>(f: impl Fn(usize) -> T) -> VoxelGrid<T> {
        let spec = spec();
        VoxelGrid::from_values(&spec, (0..spec.len()).map(f).collect())
    }

    #[test]
    fn section_11_entries_are_named_deflated_and_dated_1980() {
        let labels = labels();
        let bytes = [labels_npz(&labels), evidence_npz(labels.evidence())];
        let mut names = Vec::new();
        for bytes in bytes {
            let mut zip = ZipArchive::new(Cursor::new(bytes)).unwrap();
            for at in 0..zip.len() {
                let entry = zip.by_index(at).unwrap();
                assert_eq!(entry.compression(), CompressionMethod::Deflated);
                assert_eq!(entry.last_modified().unwrap().to_string(), "1980-01-01 00:00:00");
                names.push(entry.name().to_owned());
            }
        }
        assert_eq!(names[..3], ["semantics.npy", "mask_lidar.npy", "mask_camera.npy"]);
        assert_eq!(names[3..6], ["hits.npy", "crossings.npy", "state.npy"]);
        assert_eq!(names[6..], ["instances.npy", "flow.npy", "camera_bits.npy"]);
    }

    #[test]
    fn section_12_the_same_labels_give_the_same_bytes() {
        assert_eq!(labels_npz(&labels()), labels_npz(&labels()));
        assert_eq!(evidence_npz(labels().evidence()), evidence_npz(labels().evidence()));
    }

    #[test]
    fn section_12_the_bytes_are_those_of_earlier_versions() {
        let hash = |bytes: &[u8]| blake3::hash(bytes).to_hex()[..16].to_owned();
        assert_eq!(hash(&labels_npz(&labels())), "7b40350ebeac3988");
        assert_eq!(hash(&evidence_npz(labels().evidence())), "6e83b1386b994494");
    }
}
