//! Which folders of a log are scenes, and what their files are called.

use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;

use super::point_file::ENDINGS;
use crate::files::unreadable;

/// A scene's name, and its folder below the log's root: with a `/` at the end, or nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Folder {
    pub(super) name: String,
    pub(super) path: String,
}

/// The folder of objects' clouds.
const OBJECTS: &str = "objects";

impl Folder {
    /// The path of a file of the scene.
    pub(super) fn file(&self, name: &str) -> String {
        format!("{}{name}", self.path)
    }

    /// The file of the world's points.
    ///
    /// # Errors
    /// If there is none, or several.
    pub(super) fn cloud(&self, root: &Path) -> Result<String, Fault> {
        let mut there = clouds(&root.join(&self.path));
        match (there.pop(), there.pop()) {
            (Some(one), None) => Ok(self.file(&one)),
            (one, other) => {
                let expected = "one of cloud.ply, cloud.pcd, cloud.las, cloud.laz";
                let found: Vec<String> = [other, one].into_iter().flatten().collect();
                let found = if found.is_empty() { "none".into() } else { found.join(", ") };
                Err(Fault::new("cloud-file", self.file("cloud"), expected, found))
            }
        }
    }

    /// The files of objects' points, each with the name of its track, in byte order.
    ///
    /// # Errors
    /// If their folder cannot be listed.
    pub(super) fn objects(&self, root: &Path) -> Result<Vec<(String, String)>, Fault> {
        let folder = self.file(OBJECTS);
        if !disk::is_dir(&root.join(&folder)) {
            return Ok(Vec::new());
        }
        let mut names = names_in(&root.join(&folder), &folder)?;
        names.sort_unstable();
        let object = |name: String| {
            let track = ENDINGS.iter().find_map(|ending| name.strip_suffix(ending))?;
            Some((track.to_owned(), format!("{folder}/{name}")))
        };
        Ok(names.into_iter().filter_map(object).collect())
    }
}

/// The scenes of a folder: itself, or folders in it, in byte order of their names.
///
/// # Errors
/// If there is none.
pub(super) fn scenes(root: &Path) -> Result<Vec<Folder>, Fault> {
    let place = root.display().to_string();
    if is_scene(root) {
        let full = disk::canonicalize(root).map_err(|error| unreadable(&place, &error))?;
        let name = full.file_name().map_or_else(String::new, |name| name.to_string_lossy().into());
        return Ok(vec![Folder { name, path: String::new() }]);
    }
    let mut names = names_in(root, &place)?;
    names.retain(|name| is_scene(&root.join(name)));
    names.sort_unstable();
    if names.is_empty() {
        let expected = "cloud.ply, .pcd, .las or .laz, or folders with one";
        return Err(Fault::new("cloud-layout", place, expected, "neither"));
    }
    let folder = |name: String| Folder { path: format!("{name}/"), name };
    Ok(names.into_iter().map(folder).collect())
}

fn is_scene(folder: &Path) -> bool {
    !clouds(folder).is_empty()
}

/// Clouds of the world that stand in a folder.
fn clouds(folder: &Path) -> Vec<String> {
    let names = ENDINGS.iter().map(|ending| format!("cloud{ending}"));
    names.filter(|name| disk::is_file(&folder.join(name))).collect()
}

/// The names in a folder. One that is no UTF-8 is left out.
fn names_in(folder: &Path, place: &str) -> Result<Vec<String>, Fault> {
    let listed = disk::list(folder).map_err(|error| unreadable(place, &error))?;
    Ok(listed.into_iter().filter_map(|entry| entry.file_name().into_string().ok()).collect())
}
