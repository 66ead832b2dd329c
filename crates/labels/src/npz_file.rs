//! Arrays read from an `.npz` or `.npy` file, whoever wrote it, within bounds.

use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use occlabel_core::Fault;
use occlabel_disk::{self as disk, File};
use zip::ZipArchive;
use zip::read::ZipFile;
use zip::result::ZipError;

use crate::files::read_fault;
use crate::npy::{MAX_HEADER_BYTES, Refusal};
use crate::{NpyHeader, NumberArray};

/// What deflate can make of a byte at most.
const MAX_INFLATION: u64 = 1032;

/// An `.npz` file whose arrays are read one by one.
pub struct NpzFile {
    path: PathBuf,
    zip: Zip,
}

type Zip = ZipArchive<BufReader<File>>;

impl NpzFile {
    /// Opens a file of at most so many bytes.
    ///
    /// # Errors
    /// If it cannot be read, is longer, or is no zip archive.
    pub fn open(path: &Path, max_bytes: u64) -> Result<Self, Fault> {
        let (file, _) = open_bounded(path, max_bytes)?;
        let zip = ZipArchive::new(BufReader::new(file)).map_err(|error| {
            Fault::new("npz", path.display().to_string(), "a zip archive", error.to_string())
        })?;
        Ok(Self { path: path.to_owned(), zip })
    }

    /// Where it stands.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The names of the arrays, in the order of the file.
    pub fn names(&self) -> Vec<String> {
        let names = (0..self.zip.len()).filter_map(|at| self.zip.name_for_index(at));
        names.filter_map(|name| name.strip_suffix(".npy")).map(str::to_owned).collect()
    }

    /// Whether there is an array of a name.
    pub fn holds(&self, name: &str) -> bool {
        self.zip.index_for_name(&format!("{name}.npy")).is_some()
    }

    /// The header of an array; `None` if there is no such array.
    ///
    /// # Errors
    /// If it cannot be read, says of other things than plain numbers, or of more than there are.
    pub fn header(&mut self, name: &str) -> Result<Option<NpyHeader>, Fault> {
        let Self { path, zip } = self;
        let header = find(zip, name).and_then(|entry| entry.map(read_header).transpose());
        header.map_err(|refusal| fault(path, Some(name), refusal))
    }

    /// An array whose numbers take at most so many bytes; `None` if there is no such array.
    ///
    /// # Errors
    /// If it cannot be read, is longer, or holds other things than plain numbers.
    pub fn array(&mut self, name: &str, max_bytes: u64) -> Result<Option<NumberArray>, Fault> {
        let Self { path, zip } = self;
        let array = find(zip, name)
            .and_then(|entry| entry.map(|entry| read_entry(entry, max_bytes)).transpose());
        array.map_err(|refusal| fault(path, Some(name), refusal))
    }
}

/// An array from an `.npy` file whose numbers take at most so many bytes.
///
/// # Errors
/// If it cannot be read, is longer, or holds other things than plain numbers.
pub fn read_npy(path: &Path, max_bytes: u64) -> Result<NumberArray, Fault> {
    let (file, bytes) = open_bounded(path, max_bytes.saturating_add(MAX_HEADER_BYTES))?;
    let read = NumberArray::read(file.take(bytes), bytes);
    read.map_err(|refusal| fault(path, None, refusal))
}

/// The bytes of a file of at most so many.
///
/// # Errors
/// If it cannot be read, or is longer.
pub fn read_bounded(path: &Path, max_bytes: u64) -> Result<Vec<u8>, Fault> {
    let (mut file, _) = open_bounded(path, max_bytes)?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(|error| read_fault(path, &error))?;
    Ok(bytes)
}

/// A file and its length.
fn open_bounded(path: &Path, max_bytes: u64) -> Result<(File, u64), Fault> {
    let unreadable = |error| read_fault(path, &error);
    let file = disk::open(path).map_err(unreadable)?;
    let bytes = file.size_bytes().map_err(unreadable)?;
    if bytes > max_bytes {
        let expected = format!("at most {max_bytes} bytes");
        let found = format!("{bytes} bytes");
        return Err(Fault::new("npz-size", path.display().to_string(), expected, found));
    }
    Ok((file, bytes))
}

fn find<'a>(zip: &'a mut Zip, name: &str) -> Result<Option<ZipFile<'a, BufReader<File>>>, Refusal> {
    match zip.by_name(&format!("{name}.npy")) {
        Ok(entry) => Ok(Some(entry)),
        Err(ZipError::FileNotFound) => Ok(None),
        Err(error) => Err(("an array of this name".to_owned(), error.to_string())),
    }
}

fn read_header(mut entry: ZipFile<'_, BufReader<File>>) -> Result<NpyHeader, Refusal> {
    let max_bytes = most_bytes(&entry);
    let header = NpyHeader::read(&mut entry)?;
    match header.value_bytes().is_some_and(|bytes| bytes <= max_bytes) {
        true => Ok(header),
        false => Err((format!("numbers of {max_bytes} bytes"), format!("{:?}", header.shape))),
    }
}

/// What an entry can unpack to at most.
fn most_bytes(entry: &ZipFile<'_, BufReader<File>>) -> u64 {
    entry.size().min(entry.compressed_size().saturating_mul(MAX_INFLATION))
}

fn read_entry(entry: ZipFile<'_, BufReader<File>>, max_bytes: u64) -> Result<NumberArray, Refusal> {
    let max = max_bytes.saturating_add(MAX_HEADER_BYTES);
    if entry.size() > max {
        let found = format!("{} bytes declared", entry.size());
        return Err((format!("at most {max} bytes"), found));
    }
    let max_bytes = most_bytes(&entry);
    // One byte more than there may be, so that the sum over all of them is checked.
    NumberArray::read(entry.take(max + 1), max_bytes)
}

fn fault(path: &Path, name: Option<&str>, (expected, found): Refusal) -> Fault {
    let fault = Fault::new("npz-array", path.display().to_string(), expected, found);
    match name {
        Some(name) => fault.record(name),
        None => fault,
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    #[test]
    fn fault_34_a_header_of_more_numbers_than_its_entry_holds_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npz");
        let sound = crate::NumberArray::new(&[9], &[1_u8; 9]).to_npy();
        let mut giant = crate::NumberArray::new(&[999], &[1_u8; 999]).to_npy();
        giant.truncate(giant.len() - 990);
        let header = |npy: &[u8]| {
            let mut writer = ZipWriter::new(std::fs::File::create(&path).unwrap());
            writer.start_file("a.npy", SimpleFileOptions::default()).unwrap();
            writer.write_all(npy).unwrap();
            writer.finish().unwrap();
            NpzFile::open(&path, 1 << 12).unwrap().header("a")
        };
        assert_eq!(header(&sound).unwrap().unwrap().shape, [9]);
        assert_eq!(header(&giant).unwrap_err().found, "[999]");
    }
}
