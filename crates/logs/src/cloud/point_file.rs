//! A file of points in any of the formats, by its ending.

use std::io::BufReader;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk::File;

use super::columns::{Column, Columns, Row};
use super::las::Las;
use super::pcd::Pcd;
use super::ply::Ply;
use crate::files::{open_file, unreadable};

/// How files of points end.
pub(super) const ENDINGS: [&str; 4] = [".ply", ".pcd", ".las", ".laz"];
/// So many bytes are read at once.
const BUFFER_BYTES: usize = 1 << 18;

/// A file whose header was read.
#[derive(Debug)]
pub(super) struct PointFile {
    name: String,
    bytes: u64,
    reader: BufReader<File>,
    header: Header,
}

#[derive(Debug)]
enum Header {
    Ply(Ply),
    Pcd(Pcd),
    Las(Las),
}

impl PointFile {
    /// Opens a file below the log's root, and reads its header.
    ///
    /// # Errors
    /// If it cannot be opened, or is none of its ending.
    pub(super) fn open(root: &Path, name: &str) -> Result<Self, Fault> {
        let file = open_file(&root.join(name), name)?;
        let bytes = file.size_bytes().map_err(|error| unreadable(name, &error))?;
        let mut reader = BufReader::with_capacity(BUFFER_BYTES, file);
        let header = match name.rsplit_once('.').map(|(_, ending)| ending) {
            Some("ply") => Ply::open(&mut reader).map(Header::Ply),
            Some("pcd") => Pcd::open(&mut reader).map(Header::Pcd),
            _ => Las::open(&mut reader).map(Header::Las),
        };
        let header = header.map_err(|found| broken(name, found))?;
        let file = Self { name: name.to_owned(), bytes, reader, header };
        match [Column::X, Column::Y, Column::Z].iter().all(|axis| file.has(*axis)) {
            true => Ok(file),
            false => Err(broken(name, "no x, y or z".into())),
        }
    }

    /// Whether its points have such a number.
    pub(super) fn has(&self, column: Column) -> bool {
        self.columns().contains_key(&column)
    }

    fn columns(&self) -> Columns {
        match &self.header {
            Header::Ply(ply) => ply.columns(),
            Header::Pcd(pcd) => pcd.columns(),
            Header::Las(las) => las.columns(),
        }
    }

    /// How many points there are at most: as many as declared, as far as the file's size allows.
    pub(super) fn most_points(&self) -> u64 {
        let (declared, each) = match &self.header {
            Header::Ply(ply) => (ply.points(), ply.point_bytes()),
            Header::Pcd(pcd) => (pcd.points(), pcd.point_bytes()),
            Header::Las(las) => (las.points(), las.point_bytes()),
        };
        declared.min(self.bytes / each.max(1))
    }

    /// Reads the points, one after the other.
    ///
    /// # Errors
    /// If there are fewer than declared, or they cannot be read.
    pub(super) fn read(self, visit: impl FnMut(&Row)) -> Result<(), Fault> {
        let mut reader = self.reader;
        let read = match self.header {
            Header::Ply(ply) => ply.read(&mut reader, visit),
            Header::Pcd(pcd) => pcd.read(&mut reader, visit),
            Header::Las(las) => las.read(&mut reader, visit),
        };
        read.map_err(|found| broken(&self.name, found))
    }
}

fn broken(name: &str, found: String) -> Fault {
    Fault::new("cloud-file", name, "a whole PLY, PCD or LAS file of points", found)
}
