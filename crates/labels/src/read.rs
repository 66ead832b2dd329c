//! The arrays of a label tree read back.
//!
//! The grid is known, and so is the size of every array: a file that claims more is refused before
//! anything is allocated. Anything but numbers of the expected type, a pickle above all, is refused.

use std::path::Path;

use occlabel_core::{Evidence, Fault, GridSpec, VoxelGrid};

use crate::npy::MAX_HEADER_BYTES;
use crate::{NpzFile, NumberArray, NumberType};

/// Largest file per voxel: the 21 bytes of all evidence, undeflated, and as much again.
const MAX_FILE_BYTES_PER_VOXEL: u64 = 42;

/// The arrays of a `labels.npz`.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelArrays {
    /// The class where occupied, the taxonomy's `free` elsewhere.
    pub semantics: VoxelGrid<u8>,
    /// 1 where not unobserved.
    pub mask_lidar: VoxelGrid<u8>,
    /// 1 where some camera sees it and it is not unobserved.
    pub mask_camera: VoxelGrid<u8>,
}

/// Reads a `labels.npz` of a grid of this shape.
///
/// # Errors
/// If it cannot be read, an array is absent, or one is of another type or shape.
pub fn read_labels(path: &Path, spec: &GridSpec) -> Result<LabelArrays, Fault> {
    let mut npz = Npz::open(path, spec)?;
    Ok(LabelArrays {
        semantics: npz.bytes("semantics")?,
        mask_lidar: npz.bytes("mask_lidar")?,
        mask_camera: npz.bytes("mask_camera")?,
    })
}

/// Reads an `evidence.npz` of a grid of this shape.
///
/// # Errors
/// If it cannot be read, an array is absent, or one is of another type or shape.
pub fn read_evidence(path: &Path, spec: &GridSpec) -> Result<Evidence, Fault> {
    let mut npz = Npz::open(path, spec)?;
    Ok(Evidence {
        hits: npz.words("hits")?,
        crossings: npz.words("crossings")?,
        state: npz.bytes("state")?,
        instances: npz.words("instances")?,
        flow: npz.vectors("flow")?,
        camera_bits: npz.words("camera_bits")?,
    })
}

/// An npz file of which we know what must be in it.
struct Npz<'a> {
    spec: &'a GridSpec,
    file: NpzFile,
}

impl<'a> Npz<'a> {
    fn open(path: &Path, spec: &'a GridSpec) -> Result<Self, Fault> {
        let max_bytes = spec.len() as u64 * MAX_FILE_BYTES_PER_VOXEL + 8 * MAX_HEADER_BYTES;
        Ok(Self { spec, file: NpzFile::open(path, max_bytes)? })
    }

    fn bytes(&mut self, name: &str) -> Result<VoxelGrid<u8>, Fault> {
        let array = self.array(name, NumberType::U8, &self.spec.shape())?;
        Ok(VoxelGrid::from_values(self.spec, array.bytes))
    }

    fn words(&mut self, name: &str) -> Result<VoxelGrid<u16>, Fault> {
        let array = self.array(name, NumberType::U16, &self.spec.shape())?;
        let words = array.bytes.as_chunks().0.iter().map(|&word| u16::from_le_bytes(word));
        Ok(VoxelGrid::from_values(self.spec, words.collect()))
    }

    fn vectors(&mut self, name: &str) -> Result<VoxelGrid<[f32; 3]>, Fault> {
        let [x, y, z] = self.spec.shape();
        let array = self.array(name, NumberType::F32, &[x, y, z, 3])?;
        let numbers = array.bytes.as_chunks().0.iter().map(|&word| f32::from_le_bytes(word));
        let numbers: Vec<f32> = numbers.collect();
        Ok(VoxelGrid::from_values(self.spec, numbers.as_chunks().0.to_vec()))
    }

    /// The array, which must be there, of this type and shape.
    fn array(
        &mut self,
        name: &str,
        number: NumberType,
        shape: &[usize],
    ) -> Result<NumberArray, Fault> {
        let max_bytes = shape.iter().product::<usize>() * number.size();
        let read = self.file.array(name, max_bytes as u64);
        let expected = told(number, shape);
        let fault = |found: String| {
            let place = self.file.path().display().to_string();
            Fault::new("npz-array", place, expected.clone(), found).record(name)
        };
        match read {
            Ok(Some(array)) if array.number == number && array.shape == shape => Ok(array),
            Ok(Some(array)) => Err(fault(told(array.number, &array.shape))),
            Ok(None) => Err(fault("no array of this name".to_owned())),
            Err(refused) => Err(fault(refused.found)),
        }
    }
}

fn told(number: NumberType, shape: &[usize]) -> String {
    let sides: Vec<_> = shape.iter().map(usize::to_string).collect();
    format!("'{}' in the shape ({})", number.descr(), sides.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::npz::tests::{labels, spec};
    use crate::{evidence_npz, labels_npz};
    use std::io::Write;
    use zip::write::SimpleFileOptions;
    use zip::{CompressionMethod, ZipWriter};

    const SHAPE: &str = "(5, 4, 3)";

    fn saved(bytes: &[u8]) -> tempfile::NamedTempFile {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(bytes).unwrap();
        file
    }

    /// A file of arrays that all have this header and these values.
    fn npz_with(names: &[&str], header: &str, values: &[u8]) -> tempfile::NamedTempFile {
        npz_of_version(1, names, header, values)
    }

    fn npz_of_version(
        version: u8,
        names: &[&str],
        header: &str,
        values: &[u8],
    ) -> tempfile::NamedTempFile {
        let length = (header.len() as u32).to_le_bytes();
        let length = if version == 1 { &length[..2] } else { &length[..] };
        let mut zip = ZipWriter::new(std::io::Cursor::new(Vec::new()));
        let deflated = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        for name in names {
            zip.start_file(format!("{name}.npy"), deflated).unwrap();
            zip.write_all(&[b"\x93NUMPY", &[version, 0][..], length].concat()).unwrap();
            zip.write_all(header.as_bytes()).unwrap();
            zip.write_all(values).unwrap();
        }
        saved(&zip.finish().unwrap().into_inner())
    }

    fn labels_with(header: &str, values: &[u8]) -> tempfile::NamedTempFile {
        npz_with(&["semantics", "mask_lidar", "mask_camera"], header, values)
    }

    fn header(number: &str, fortran: &str, shape: &str) -> String {
        format!("{{'descr': '{number}', 'fortran_order': {fortran}, 'shape': {shape}, }}  \n")
    }

    #[test]
    fn section_11_what_was_written_is_read_back() {
        let labels = labels();
        let read = read_labels(saved(&labels_npz(&labels)).path(), &spec()).unwrap();
        assert_eq!(read.semantics, labels.semantics);
        assert_eq!(read.mask_lidar, labels.mask_lidar);
        assert_eq!(read.mask_camera, labels.mask_camera);

        let evidence = labels.evidence();
        let read = read_evidence(saved(&evidence_npz(evidence)).path(), &spec()).unwrap();
        assert_eq!(read.hits, evidence.hits);
        assert_eq!(read.crossings, evidence.crossings);
        assert_eq!(read.state, evidence.state);
        assert_eq!(read.instances, evidence.instances);
        assert_eq!(read.flow, evidence.flow);
        assert_eq!(read.camera_bits, evidence.camera_bits);
    }

    #[test]
    fn fault_35_fortran_order_is_read_right() {
        let values: Vec<u8> = (0..60).collect();
        let file = labels_with(&header("|u1", "True", SHAPE), &values);
        let read = read_labels(file.path(), &spec()).unwrap().semantics;
        assert_eq!([*read.at([1, 0, 0]), *read.at([0, 1, 0]), *read.at([0, 0, 1])], [1, 5, 20]);
    }

    #[test]
    fn fault_35_versions_2_and_3_are_read_right_and_others_refused() {
        let (values, header): (Vec<u8>, _) = ((0..60).collect(), header("|u1", "False", SHAPE));
        let names = ["semantics", "mask_lidar", "mask_camera"];
        for version in [1, 2, 3] {
            // NumPy pads headers so that values begin at a multiple of 64 bytes.
            let padding = 64 - (header.len() + if version == 1 { 10 } else { 12 }) % 64;
            let header = format!("{}{}\n", header.trim_end(), " ".repeat(padding + 2));
            let file = npz_of_version(version, &names, &header, &values);
            let read = read_labels(file.path(), &spec()).unwrap();
            assert_eq!(read.semantics.values(), values, "version {version}");
        }
        for version in [0, 4, 255] {
            let file = npz_of_version(version, &names, &header, &values);
            assert_eq!(read_labels(file.path(), &spec()).unwrap_err().rule, "npz-array");
        }
    }

    #[test]
    fn fault_35_big_endian_is_read_right() {
        let values: Vec<u8> = (0..60_u16).flat_map(|value| (value * 1000).to_be_bytes()).collect();
        let file = npz_with(&["hits"], &header(">u2", "False", SHAPE), &values);
        let hits = Npz::open(file.path(), &spec()).unwrap().words("hits").unwrap();
        assert_eq!([*hits.at([0, 0, 1]), *hits.at([4, 3, 2])], [1000, 59_000]);
    }

    #[test]
    fn fault_35_pickles_other_types_and_other_shapes_are_refused() {
        let refused = [
            header("|O", "False", SHAPE),
            header("|b1", "False", SHAPE),
            header("<i8", "False", SHAPE),
            header("|u1", "False", "(4, 5, 3)"),
            header("|u1", "False", "(60,)"),
            header("|u1", "False", "(18446744073709551615, 2, 2)"),
            header("|u1", "False", "(1000000, 1000000, 1000000)"),
            "os.system('x')".to_owned(),
        ];
        for header in refused {
            let file = labels_with(&header, &[0; 60]);
            let fault = read_labels(file.path(), &spec()).unwrap_err();
            assert_eq!(fault.rule, "npz-array", "{header}");
            assert!(fault.expected.contains("(5,4,3)"), "{fault}");
        }
    }

    #[test]
    fn fault_35_too_few_and_too_many_values_are_refused() {
        for count in [0, 59, 61] {
            let file = labels_with(&header("|u1", "False", SHAPE), &vec![0; count]);
            assert!(read_labels(file.path(), &spec()).is_err(), "{count}");
        }
    }

    #[test]
    fn fault_34_a_bomb_is_refused_by_its_declared_size() {
        let file = labels_with(&header("|u1", "False", SHAPE), &vec![0; 50_000_000]);
        assert!(file.as_file().metadata().unwrap().len() < 300_000);
        let fault = read_labels(file.path(), &spec()).unwrap_err();
        assert!(fault.found.contains("bytes declared"), "{fault}");
        let large = saved(&vec![0; 1_000_000]);
        assert_eq!(read_labels(large.path(), &spec()).unwrap_err().rule, "npz-size");
    }

    #[test]
    fn a_torn_file_and_a_missing_array_are_told() {
        let bytes = labels_npz(&labels());
        let torn = saved(&bytes[..bytes.len() / 2]);
        assert_eq!(read_labels(torn.path(), &spec()).unwrap_err().rule, "npz");
        let other = saved(&bytes);
        let fault = read_evidence(other.path(), &spec()).err().unwrap();
        assert_eq!(fault.record.as_deref(), Some("hits"));
        assert_eq!(read_labels(Path::new("/not/there"), &spec()).unwrap_err().rule, "read");
    }
}
