//! NumPy archives: the meshes of all people of a keyframe, of one topology.

use std::io::{Cursor, Read};
use std::sync::Arc;

use nalgebra::Point3;
use occlabel_core::{Fault, LoggedMesh, TriangleMesh};
use zip::ZipArchive;

use crate::nuscenes::{read_header, text_of};

/// Arrays of more bytes are refused: a thousand people of 20 000 vertices.
const MAX_ARRAY_BYTES: u64 = 1 << 29;

/// The meshes of a file: `vertices` [people][v][3] of floats, `faces` [f][3] of integers, `track_ids`
/// [people] of integers or texts.
///
/// # Errors
/// If an array is absent, of another shape or type, or does not fit the others.
pub(super) fn decode(bytes: &[u8]) -> Result<Vec<LoggedMesh>, Fault> {
    let names = decode_names(bytes)?;
    let (vertices, faces) = (member(bytes, "vertices")?, member(bytes, "faces")?);
    let [people, count, 3] = vertices.shape[..] else {
        return Err(vertices.fault("[people][v][3]"));
    };
    let [_, 3] = faces.shape[..] else { return Err(faces.fault("[f][3]")) };
    if people != names.len() {
        return Err(vertices.fault(&format!("{} people, as track_ids", names.len())));
    }
    let corners = faces.whole_numbers().ok_or_else(|| faces.fault("integers from 0"))?;
    let corners = corners.into_iter().map(u32::try_from).collect::<Result<Vec<u32>, _>>();
    let corners = corners.map_err(|_| faces.fault("numbers of vertices"))?;
    let faces: Arc<[[u32; 3]]> = corners.as_chunks().0.into();
    let numbers = vertices.floats().ok_or_else(|| vertices.fault("floats"))?;
    let points: Vec<Point3<f64>> = numbers.as_chunks().0.iter().map(|&p| Point3::from(p)).collect();
    let mesh = |(at, track): (usize, String)| {
        let own = points[at * count..(at + 1) * count].to_vec();
        let mesh = TriangleMesh::new(own, faces.clone());
        Ok(LoggedMesh { mesh: mesh.map_err(|fault| fault.record(&track))?, track })
    };
    names.into_iter().enumerate().map(mesh).collect()
}

/// The tracks of a file.
///
/// # Errors
/// If there is no such array.
pub(super) fn decode_names(bytes: &[u8]) -> Result<Vec<String>, Fault> {
    let array = member(bytes, "track_ids")?;
    let [_] = array.shape[..] else { return Err(array.fault("[people]")) };
    array.texts().ok_or_else(|| array.fault("integers or texts"))
}

/// An array of a file.
struct Array {
    name: &'static str,
    /// NumPy's: byte order, kind, bytes.
    descr: String,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

fn member(bytes: &[u8], name: &'static str) -> Result<Array, Fault> {
    let fault = |found: String| fault(name, "an array of plain numbers or texts in C order", found);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| fault(e.to_string()))?;
    let mut member =
        archive.by_name(&format!("{name}.npy")).map_err(|error| fault(error.to_string()))?;
    let header = read_header(&mut member).map_err(|defect| fault(format!("{defect:?}")))?;
    let (descr, shape) = parse(&header).ok_or_else(|| fault(header.clone()))?;
    let size = item_bytes(&descr).ok_or_else(|| fault(header.clone()))?;
    let length = shape.iter().try_fold(size, |bytes, &side| bytes.checked_mul(side as u64));
    let length = length.filter(|&length| length <= MAX_ARRAY_BYTES);
    let length = length.ok_or_else(|| fault(format!("{shape:?} of {descr}, which is too much")))?;
    let mut read = Vec::new();
    member.take(length + 1).read_to_end(&mut read).map_err(|error| fault(error.to_string()))?;
    if read.len() as u64 != length {
        return Err(fault(format!("{} bytes for {shape:?} of {descr}", read.len())));
    }
    Ok(Array { name, descr, shape, bytes: read })
}

fn parse(header: &str) -> Option<(String, Vec<usize>)> {
    let (descr, _) = text_of(header, "'descr':")?.strip_prefix('\'')?.split_once('\'')?;
    if !text_of(header, "'fortran_order':")?.starts_with("False") {
        return None;
    }
    let (sides, _) = text_of(header, "'shape':")?.strip_prefix('(')?.split_once(')')?;
    let sides = sides.split(',').map(str::trim).filter(|side| !side.is_empty());
    Some((descr.to_owned(), sides.map(|side| side.parse().ok()).collect::<Option<_>>()?))
}

/// The bytes of a number or a text; none of what is neither.
fn item_bytes(descr: &str) -> Option<u64> {
    let (kind, size) = descr.get(1..2).zip(descr.get(2..))?;
    let size: u64 = size.parse().ok()?;
    match (kind, size) {
        ("f", 4 | 8) | ("i" | "u", 1 | 2 | 4 | 8) => Some(size),
        ("U", 1..=256) => Some(4 * size),
        _ => None,
    }
}

impl Array {
    fn kind(&self) -> &str {
        &self.descr[1..2]
    }

    /// The items, least byte first.
    fn items(&self, item: usize) -> impl Iterator<Item = [u8; 8]> + '_ {
        let is_big_endian = self.descr.starts_with('>');
        self.bytes.chunks_exact(item).map(move |bytes| {
            let mut word = [0; 8];
            word[..item].copy_from_slice(bytes);
            if is_big_endian {
                word[..item].reverse();
            }
            word
        })
    }

    fn floats(&self) -> Option<Vec<f64>> {
        let narrow = |word: [u8; 8]| f64::from(f32::from_bits(u64::from_le_bytes(word) as u32));
        match &self.descr[1..] {
            "f4" => Some(self.items(4).map(narrow).collect()),
            "f8" => Some(self.items(8).map(f64::from_le_bytes).collect()),
            _ => None,
        }
    }

    fn whole_numbers(&self) -> Option<Vec<i64>> {
        let item = item_bytes(&self.descr)? as usize;
        let unused = 64 - 8 * item as u32;
        let signed = |word| (u64::from_le_bytes(word) << unused) as i64 >> unused;
        match self.kind() {
            "i" => Some(self.items(item).map(signed).collect()),
            "u" => {
                self.items(item).map(|word| i64::try_from(u64::from_le_bytes(word)).ok()).collect()
            }
            _ => None,
        }
    }

    fn texts(&self) -> Option<Vec<String>> {
        let item = item_bytes(&self.descr)? as usize;
        if self.kind() != "U" {
            return Some(self.whole_numbers()?.iter().map(i64::to_string).collect());
        }
        let letters: Option<Vec<char>> =
            self.items(4).map(|word| char::from_u32(u64::from_le_bytes(word) as u32)).collect();
        let texts = letters?;
        let text = |letters: &[char]| letters.iter().collect::<String>();
        Some(
            texts.chunks(item / 4).map(|one| text(one).trim_end_matches('\0').to_owned()).collect(),
        )
    }

    fn fault(&self, expected: &str) -> Fault {
        fault(self.name, expected, format!("{:?} of {}", self.shape, self.descr))
    }
}

fn fault(array: &str, expected: &str, found: String) -> Fault {
    Fault::new("mesh-file", "an npz file", expected, found).record(format!("array {array}"))
}

#[cfg(test)]
pub(super) mod tests {
    use ndarray::{Array1, Array3, arr1, arr2};
    use ndarray_npy::NpzWriter;

    use super::*;

    /// Two people of one triangle each.
    pub(in crate::meshes) fn file() -> Vec<u8> {
        let vertices = Array3::from_shape_fn((2, 3, 3), |(p, v, axis)| {
            p as f32 * 10.0 + f32::from(u8::from(v == axis + 1))
        });
        let mut npz = NpzWriter::new_compressed(Cursor::new(Vec::new()));
        npz.add_array("vertices", &vertices).unwrap();
        npz.add_array("faces", &arr2(&[[0_i32, 1, 2]])).unwrap();
        npz.add_array("track_ids", &arr1(&[7_i64, -3])).unwrap();
        npz.finish().unwrap().into_inner()
    }

    #[test]
    fn people_share_their_faces_and_are_named_by_their_tracks() {
        let meshes = decode(&file()).unwrap();
        let names: Vec<&str> = meshes.iter().map(|mesh| mesh.track.as_str()).collect();
        assert_eq!(names, ["7", "-3"]);
        assert!(meshes[0].mesh.is_like(&meshes[1].mesh));
        assert_eq!(meshes[1].mesh.vertices()[1], Point3::new(11.0, 10.0, 10.0));
    }

    #[test]
    fn names_may_be_texts_of_one_width() {
        let letters = |text: &str| {
            let mut letters: Vec<u8> =
                text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
            letters.resize(4 * 5, 0);
            letters
        };
        let bytes = [letters("é-1"), letters("abcde")].concat();
        let array = Array { name: "track_ids", descr: "<U5".into(), shape: vec![2], bytes };
        assert_eq!(array.texts().unwrap(), ["é-1", "abcde"]);
    }

    #[test]
    fn fault_35_arrays_that_do_not_fit_are_refused() {
        let with = |name: &str, array: Array1<f64>| {
            let mut npz = NpzWriter::new(Cursor::new(Vec::new()));
            npz.add_array("vertices", &Array3::<f64>::zeros((1, 3, 3))).unwrap();
            let names = arr1(&[1_i64]);
            match name {
                "faces" => npz.add_array(name, &array).unwrap(),
                _ => npz.add_array("faces", &arr2(&[[0_i64, 1, 3]])).unwrap(),
            }
            match name {
                "track_ids" => npz.add_array(name, &array).unwrap(),
                _ => npz.add_array("track_ids", &names).unwrap(),
            }
            decode(&npz.finish().unwrap().into_inner()).unwrap_err().to_string()
        };
        assert!(with("faces", arr1(&[0.0])).contains("[f][3]"));
        assert!(with("track_ids", arr1(&[0.5])).contains("integers or texts"));
        assert!(with("", arr1(&[])).contains("vertex 3"));
        assert!(decode(b"PK").is_err());
    }

    #[test]
    fn fault_34_declared_shapes_reserve_nothing() {
        assert_eq!(item_bytes("<U9999999"), None);
        assert_eq!((item_bytes("|O8"), item_bytes("<f2"), item_bytes("<")), (None, None, None));
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (4000000000, 9, 3), }";
        assert_eq!(parse(header).unwrap().1, [4_000_000_000, 9, 3]);
        assert!(parse(&header.replace("False", "True")).is_none());
    }
}
