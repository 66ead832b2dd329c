//! What a file holds, before anyone knows what it means.

use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::{NpyHeader, NpzFile, NumberType, read_npy};
use serde::Serialize;

/// The arrays of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sight {
    /// How they are packed.
    pub packing: Packing,
    /// Each of them, in the order of the file.
    pub arrays: Vec<SeenArray>,
}

/// How a file holds arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// By their names, in a zip archive.
    Npz,
    /// One, with a header.
    Npy,
    /// One, of bytes alone.
    Bytes,
}

/// An array of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SeenArray {
    /// Its name: in the archive, or the ending of the file's.
    pub name: String,
    /// The type of its numbers, as numpy calls it; `None` where they are no plain numbers.
    pub number: Option<String>,
    /// Its shape; of bytes alone, how many there are.
    pub shape: Vec<usize>,
}

/// Largest npy file that is looked into.
const MAX_NPY_BYTES: u64 = 1 << 32;

impl Sight {
    /// What a file holds, by its contents.
    ///
    /// # Errors
    /// If it cannot be read, or is torn.
    pub fn of(path: &Path) -> Result<Self, Fault> {
        match first_bytes(path)? {
            [b'P', b'K', ..] => Self::of_npz(path),
            [0x93, b'N', b'U', b'M'] => Self::of_npy(path),
            _ => Self::of_bytes(path),
        }
    }

    /// An array by its name.
    pub(crate) fn array(&self, name: &str) -> Option<&SeenArray> {
        self.arrays.iter().find(|array| array.name == name)
    }

    fn of_npz(path: &Path) -> Result<Self, Fault> {
        let mut file = NpzFile::open(path, u64::MAX)?;
        let names = file.names();
        let seen = |name: String| match file.header(&name) {
            Ok(Some(header)) => SeenArray::of_header(name, &header),
            _ => SeenArray { name, number: None, shape: Vec::new() },
        };
        let arrays = names.into_iter().map(seen).collect();
        Ok(Self { packing: Packing::Npz, arrays })
    }

    fn of_npy(path: &Path) -> Result<Self, Fault> {
        let array = read_npy(path, MAX_NPY_BYTES)?;
        let number = Some(array.number.descr());
        let seen = SeenArray { name: String::new(), number, shape: array.shape };
        Ok(Self { packing: Packing::Npy, arrays: vec![seen] })
    }

    fn of_bytes(path: &Path) -> Result<Self, Fault> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        let bytes =
            disk::metadata(path).map_err(|error| unreadable(path, &error))?.bytes() as usize;
        let number = Some(NumberType::U8.descr());
        let seen = SeenArray { name: ending, number, shape: vec![bytes] };
        Ok(Self { packing: Packing::Bytes, arrays: vec![seen] })
    }
}

impl SeenArray {
    fn of_header(name: String, header: &NpyHeader) -> Self {
        Self { name, number: Some(header.number.descr()), shape: header.shape.clone() }
    }

    /// Whether its numbers are whole by type.
    pub(crate) fn is_whole(&self) -> bool {
        self.number.as_ref().is_some_and(|number| !number.contains('f'))
    }
}

/// The first four bytes; zeros where there are fewer.
fn first_bytes(path: &Path) -> Result<[u8; 4], Fault> {
    use std::io::Read;
    let mut bytes = [0; 4];
    let file = disk::open(path).map_err(|error| unreadable(path, &error))?;
    let mut start = Vec::new();
    file.take(4).read_to_end(&mut start).map_err(|error| unreadable(path, &error))?;
    bytes[..start.len()].copy_from_slice(&start);
    Ok(bytes)
}

fn unreadable(path: &Path, error: &std::io::Error) -> Fault {
    Fault::new("read", path.display().to_string(), "to read this file", error.to_string())
}
