//! Which format a folder looks like.

use std::path::Path;

use occlabel_disk as disk;

use crate::{argoverse2, cloud, coda, kitti360, mcap, nuscenes, semantickitti, waymo};

/// Whether a folder has a format's files.
type Sign = fn(&Path) -> bool;

/// Each format as `--format` names it, and its sign. What looks far comes last.
const SIGNS: [(&str, Sign); 7] = [
    ("nuscenes", nuscenes::has_tables),
    ("waymo", waymo::has_frames),
    ("mcap", mcap::has_files),
    ("semantickitti", |root| kitti360::Kitti360Log::is_log(root) || semantickitti::has_scans(root)),
    ("cloud", cloud::has_clouds),
    ("coda", coda::has_sequences),
    ("av2", |root| has_av2_log(root, argoverse2::DEPTH)),
];

/// The name of the format whose files a folder holds, as `--format` has it; none if it is none's, or
/// cannot be read.
pub fn looks_like(root: &Path) -> Option<&'static str> {
    SIGNS.into_iter().find(|(_, has_files)| has_files(root)).map(|(name, _)| name)
}

/// Links to folders are not followed.
fn has_av2_log(folder: &Path, depth: usize) -> bool {
    if disk::is_file(&folder.join(argoverse2::POSES)) {
        return true;
    }
    let Ok(entries) = disk::list(folder) else { return false };
    depth > 0
        && entries.into_iter().any(|entry| {
            let is_folder = entry.is_dir();
            is_folder && has_av2_log(&entry.path(), depth - 1)
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn folder_with(file: &str, bytes: &[u8]) -> Option<&'static str> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).and_then(|()| fs::write(path, bytes)).unwrap();
        looks_like(folder.path())
    }

    #[test]
    fn a_folder_looks_like_the_format_whose_files_it_holds() {
        for (file, bytes, format) in [
            ("v1.0-mini/scene.json", &b"[]"[..], Some("nuscenes")),
            ("a.tfrecord", b"", Some("waymo")),
            ("vehicle_pose/a.parquet", b"PAR1", Some("waymo")),
            ("a.mcap", b"", Some("mcap")),
            ("sequences/00/velodyne/000000.bin", b"", Some("semantickitti")),
            ("velodyne/000000.bin", b"", Some("semantickitti")),
            ("data_3d_raw/drive/a.txt", b"", Some("semantickitti")),
            ("cloud.ply", b"", Some("cloud")),
            ("drive/cloud.laz", b"", Some("cloud")),
            ("3d_comp/os1/0/3d_comp_os1_0_0.bin", b"", Some("coda")),
            ("3d_raw/os1/7/3d_raw_os1_7_12.bin", b"", Some("coda")),
            ("city_SE3_egovehicle.feather", b"", Some("av2")),
            ("sensor/val/a/city_SE3_egovehicle.feather", b"", Some("av2")),
            ("a/b/c/d/city_SE3_egovehicle.feather", b"", None),
            ("v1.0-mini/readme.txt", b"", None),
            ("notes.txt", b"", None),
        ] {
            assert_eq!(folder_with(file, bytes), format, "{file}");
        }
        assert_eq!(looks_like(Path::new("no/such/folder")), None);
    }
}
