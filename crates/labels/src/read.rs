//! Label arrays read back, whoever wrote them.
//!
//! The grid is known, and so is the size of every array: a file that claims more is refused before
//! anything is allocated. Fortran order and big-endian numbers are read right; anything but plain
//! numbers of the expected type, a pickle above all, is refused.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use ndarray::ArrayD;
use ndarray_npy::{ReadNpyExt, ReadableElement};
use occlabel_core::{Evidence, Fault, GridSpec, VoxelGrid};
use zip::ZipArchive;

use crate::files::read_fault;

/// Longest header of an array that is accepted: version 1 of the format allows no more.
const MAX_HEADER_BYTES: u64 = 1 << 16;

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
        semantics: npz.grid("semantics")?,
        mask_lidar: npz.grid("mask_lidar")?,
        mask_camera: npz.grid("mask_camera")?,
    })
}

/// Reads an `evidence.npz` of a grid of this shape.
///
/// # Errors
/// If it cannot be read, an array is absent, or one is of another type or shape.
pub fn read_evidence(path: &Path, spec: &GridSpec) -> Result<Evidence, Fault> {
    let mut npz = Npz::open(path, spec)?;
    Ok(Evidence {
        hits: npz.grid("hits")?,
        crossings: npz.grid("crossings")?,
        state: npz.grid("state")?,
        instances: npz.grid("instances")?,
        flow: npz.vectors("flow")?,
        camera_bits: npz.grid("camera_bits")?,
    })
}

/// A number type of the arrays, and how numpy writes it down: little-endian, big-endian.
trait Number: ReadableElement + Copy {
    const TYPES: [&'static str; 2];
}

impl Number for u8 {
    const TYPES: [&'static str; 2] = ["|u1", "|u1"];
}

impl Number for u16 {
    const TYPES: [&'static str; 2] = ["<u2", ">u2"];
}

impl Number for f32 {
    const TYPES: [&'static str; 2] = ["<f4", ">f4"];
}

/// An npz file of which we know what must be in it.
struct Npz<'a> {
    path: &'a Path,
    spec: &'a GridSpec,
    zip: ZipArchive<BufReader<File>>,
}

impl<'a> Npz<'a> {
    fn open(path: &'a Path, spec: &'a GridSpec) -> Result<Self, Fault> {
        let unreadable = |error| read_fault(path, &error);
        let file = File::open(path).map_err(unreadable)?;
        let bytes = file.metadata().map_err(unreadable)?.len();
        let max = spec.len() as u64 * MAX_FILE_BYTES_PER_VOXEL + 8 * MAX_HEADER_BYTES;
        if bytes > max {
            let expected = format!("at most {max} bytes for {} voxels", spec.len());
            let found = format!("{bytes} bytes");
            return Err(Fault::new("npz-size", path.display().to_string(), expected, found));
        }
        let zip = ZipArchive::new(BufReader::new(file)).map_err(|error| {
            Fault::new("npz", path.display().to_string(), "a zip archive", error.to_string())
        })?;
        Ok(Self { path, spec, zip })
    }

    fn grid<T: Number>(&mut self, name: &str) -> Result<VoxelGrid<T>, Fault> {
        let values = self.array(name, &self.spec.shape())?;
        Ok(VoxelGrid::from_values(self.spec, values))
    }

    fn vectors(&mut self, name: &str) -> Result<VoxelGrid<[f32; 3]>, Fault> {
        let [x, y, z] = self.spec.shape();
        let values: Vec<f32> = self.array(name, &[x, y, z, 3])?;
        let (vectors, _) = values.as_chunks::<3>();
        Ok(VoxelGrid::from_values(self.spec, vectors.to_vec()))
    }

    /// The array's values in C order.
    fn array<T: Number>(&mut self, name: &str, shape: &[usize]) -> Result<Vec<T>, Fault> {
        let bytes = self.entry(name, (shape.iter().product::<usize>() * size_of::<T>()) as u64)?;
        check_header::<T>(&bytes, shape)
            .map_err(|(expected, found)| self.fault(name, expected, found))?;
        match ArrayD::<T>::read_npy(&bytes[..]) {
            Ok(array) => Ok(array.iter().copied().collect()),
            Err(error) => Err(self.fault(name, "the values of an array", error.to_string())),
        }
    }

    /// The bytes of an entry that holds so many bytes of values, and a header.
    fn entry(&mut self, name: &str, value_bytes: u64) -> Result<Vec<u8>, Fault> {
        let max = value_bytes + MAX_HEADER_BYTES;
        let mut bytes = Vec::new();
        let read = match self.zip.by_name(&format!("{name}.npy")) {
            Err(error) => Err(("an array of this name".to_owned(), error.to_string())),
            Ok(entry) if entry.size() > max => {
                Err((format!("at most {max} bytes"), format!("{} bytes declared", entry.size())))
            }
            Ok(entry) => entry
                .take(max)
                .read_to_end(&mut bytes)
                .map_err(|error| ("a whole entry".to_owned(), error.to_string())),
        };
        read.map(|_| bytes).map_err(|(expected, found)| self.fault(name, expected, found))
    }

    fn fault(&self, name: &str, expected: impl Into<String>, found: impl Into<String>) -> Fault {
        Fault::new("npz-array", self.path.display().to_string(), expected, found).record(name)
    }
}

/// Compares the header, word for word, with those that numpy gives to such an array.
fn check_header<T: Number>(bytes: &[u8], shape: &[usize]) -> Result<(), (String, String)> {
    let shape: Vec<_> = shape.iter().map(usize::to_string).collect();
    let shape = shape.join(",");
    let header = |number: &str, fortran: &str| {
        format!("{{'descr':'{number}','fortran_order':{fortran},'shape':({shape})}}")
    };
    let found = header_text(bytes).unwrap_or_else(|| "no header".to_owned());
    let fits = |number: &&str| ["False", "True"].iter().any(|order| found == header(number, order));
    if T::TYPES.iter().any(fits) {
        return Ok(());
    }
    Err((header(T::TYPES[0], "False"), found.chars().take(200).collect()))
}

/// The header's dictionary, without blanks and without the comma before a closing bracket.
///
/// See the `.npy` format in numpy's own documentation (`numpy.lib.format`).
fn header_text(bytes: &[u8]) -> Option<String> {
    let version = *bytes.strip_prefix(b"\x93NUMPY")?.first()?;
    let (text_at, length) = match version {
        1 => (10, usize::from(u16::from_le_bytes(*bytes.get(8..)?.first_chunk()?))),
        2 | 3 => (12, u32::from_le_bytes(*bytes.get(8..)?.first_chunk()?) as usize),
        _ => return None,
    };
    let text = std::str::from_utf8(bytes.get(text_at..)?.get(..length)?).ok()?;
    let text: String = text.chars().filter(|c| !c.is_ascii_whitespace()).collect();
    Some(text.replace(",)", ")").replace(",}", "}"))
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
        let hits = Npz::open(file.path(), &spec()).unwrap().grid::<u16>("hits").unwrap();
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
