//! Which version of the format a folder holds, told by what its files begin with.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;

use super::tfrecord::is_record_head;
use crate::files::{open_file, unreadable};

/// The version, and its files.
#[derive(Debug)]
pub(super) enum Layout {
    /// TFRecord files in the folder, in byte order of their names.
    V1(Vec<String>),
    /// A folder of Parquet files for each component.
    V2,
}

/// The component of v2 without which no frame has a place.
pub(super) const VEHICLE_POSE: &str = "vehicle_pose";
/// What a Parquet file begins with.
const PARQUET: &[u8] = b"PAR1";

impl Layout {
    /// Looks into the folder itself, and into none below it but `vehicle_pose`.
    ///
    /// # Errors
    /// If it holds neither version, or both.
    pub(super) fn of_folder(root: &Path) -> Result<Self, Fault> {
        let named = |name: &String| name.ends_with(".tfrecord");
        let mut records = files(root)?;
        let begun = heads(root, &records)?;
        records.retain(|name| named(name) || is_record_head(&begun[name]));
        let poses = root.join(VEHICLE_POSE);
        let components = if disk::is_dir(&poses) { files(&poses)? } else { Vec::new() };
        let is_v2 = heads(&poses, &components)?.values().any(|head| head.starts_with(PARQUET));
        let expected = "TFRecord files (v1), or folders of Parquet files such as vehicle_pose (v2)";
        let fault = |found| Fault::new("waymo-layout", root.display().to_string(), expected, found);
        match (records.is_empty(), is_v2) {
            (false, false) => Ok(Self::V1(records)),
            (true, true) => Ok(Self::V2),
            (false, true) => Err(fault("both")),
            (true, false) => Err(fault("neither").hint("name the folder that holds the files")),
        }
    }
}

/// Names of a folder's files, sorted. One that is no UTF-8 is left out.
pub(super) fn files(folder: &Path) -> Result<Vec<String>, Fault> {
    let place = folder.display().to_string();
    let mut names = Vec::new();
    for entry in disk::list(folder).map_err(|error| unreadable(&place, &error))? {
        if disk::is_file(&entry.path()) {
            names.extend(entry.file_name().into_string().ok());
        }
    }
    names.sort_unstable();
    Ok(names)
}

/// The first bytes of a folder's files, by their names.
fn heads(folder: &Path, names: &[String]) -> Result<BTreeMap<String, Vec<u8>>, Fault> {
    let head = |name: &String| {
        let mut head = Vec::new();
        let file = open_file(&folder.join(name), name)?;
        let read = file.take(12).read_to_end(&mut head);
        read.map_err(|error| unreadable(name, &error))?;
        Ok((name.clone(), head))
    };
    names.iter().map(head).collect()
}
