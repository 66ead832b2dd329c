//! Which file labels the points of which sweep.

use std::collections::HashMap;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;

use super::rows::{Lidarseg, Panoptic};
use super::table::{Row, Table, read_table};
use super::token::Token;
use crate::files::name_defect;

/// By the token of a sweep's sample_data: the file of its labels.
pub(super) type LabelFiles = HashMap<Token, LabelFile>;

/// A file with one label for each point of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct LabelFile {
    /// How the labels are written.
    pub(super) encoding: LabelEncoding,
    /// Relative to the log's root.
    pub(super) file: String,
    /// Why the file's name cannot be trusted, if so.
    pub(super) defect: Option<Fault>,
}

/// How a file holds raw labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LabelEncoding {
    /// A byte a point.
    Lidarseg,
    /// An npz with a 16-bit number a point, 1000 times the label and an instance's number.
    Panoptic,
}

/// A table of label files.
trait LabelTable: Table {
    /// How its files hold labels.
    const ENCODING: LabelEncoding;
    /// The sweep's token, and its labels' file.
    fn sweep_and_file(&self) -> (&Token, &str);
}

impl LabelTable for Lidarseg {
    const ENCODING: LabelEncoding = LabelEncoding::Lidarseg;

    fn sweep_and_file(&self) -> (&Token, &str) {
        (&self.sample_data_token, &self.filename)
    }
}

impl LabelTable for Panoptic {
    const ENCODING: LabelEncoding = LabelEncoding::Panoptic;

    fn sweep_and_file(&self) -> (&Token, &str) {
        (&self.sample_data_token, &self.filename)
    }
}

/// Reads panoptic.json and lidarseg.json, as far as they are there; of a sweep that both name,
/// panoptic.json's file counts (labels.md section 2).
///
/// # Errors
/// If a table is there but cannot be read, names a file outside the root, or a sweep twice.
pub(super) fn read_label_files(folder: &Path) -> Result<LabelFiles, Fault> {
    let mut files = read_one::<Lidarseg>(folder)?;
    files.extend(read_one::<Panoptic>(folder)?);
    Ok(files)
}

fn read_one<T: LabelTable>(folder: &Path) -> Result<LabelFiles, Fault> {
    let mut files = LabelFiles::new();
    if !disk::exists(&folder.join(T::FILE)) {
        return Ok(files);
    }
    read_table(
        folder,
        |_| Ok(true),
        |row: Row<T>| {
            let (sweep, file) = row.sweep_and_file();
            let defect = name_defect(file).map(|defect| {
                let found = format!("`{file}`, {defect}");
                row.fault("file-name", "a path below the log's root", found)
            });
            let labels = LabelFile { encoding: T::ENCODING, file: file.to_owned(), defect };
            match files.insert(sweep.clone(), labels) {
                Some(_) => {
                    Err(row.fault("label-file", "one file a sweep", format!("another for {sweep}")))
                }
                None => Ok(()),
            }
        },
    )?;
    Ok(files)
}
