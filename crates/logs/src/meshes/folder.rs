//! The folder that holds the meshes of a log.

use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use occlabel_core::{Fault, Keyframe, LoggedMesh};
use occlabel_disk as disk;

use super::{arrays, obj, ply};
use crate::files::{file_bytes, read_file, unreadable};

/// A folder of meshes.
#[derive(Clone, Debug)]
pub struct MeshFolder {
    /// What holds the folder.
    root: PathBuf,
    /// Its own name.
    name: String,
}

/// A file of meshes at a keyframe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshFile {
    /// Its path from what holds the folder: it begins with the folder's name.
    pub path: String,
    /// Its size.
    pub bytes: u64,
    /// The token of the keyframe.
    pub keyframe: String,
    kind: Kind,
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Kind {
    /// The mesh of a track, Wavefront OBJ.
    Obj(String),
    /// The mesh of a track, PLY.
    Ply(String),
    /// Those of all people of the keyframe.
    Npz,
}

impl MeshFolder {
    /// The folder at a path from a log's root.
    ///
    /// # Errors
    /// If there is no such folder.
    pub fn open(log: &Path, folder: &str) -> Result<Self, Fault> {
        let path = log.join(folder.trim_end_matches('/'));
        let place = path.display().to_string();
        if !disk::is_dir(&path) {
            return Err(Fault::new("mesh-folder", place, "a folder of meshes", "none"));
        }
        let (root, name) = path
            .parent()
            .zip(path.file_name())
            .ok_or_else(|| Fault::new("mesh-folder", place, "a folder with a name", "none"))?;
        Ok(Self { root: root.to_owned(), name: name.to_string_lossy().into_owned() })
    }

    /// What holds the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The folder's own name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The files of a scene's keyframes, in their order and then that of names. Files of other
    /// keyframes and of other kinds are none of these.
    ///
    /// # Errors
    /// If a folder cannot be listed.
    pub fn files(&self, scene: &str, keyframes: &[Keyframe]) -> Result<Vec<MeshFile>, Fault> {
        let of_scene = format!("{}/{scene}", self.name);
        let names: BTreeSet<String> = self.list(&of_scene)?.into_iter().collect();
        let mut files = Vec::new();
        for Keyframe { token, .. } in keyframes {
            let archive = format!("{token}.npz");
            if names.contains(&archive) {
                files.push(self.file(format!("{of_scene}/{archive}"), token, Kind::Npz));
            }
            if names.contains(token) {
                files.extend(self.files_in(&format!("{of_scene}/{token}"), token)?);
            }
        }
        Ok(files)
    }

    /// The files of single meshes.
    fn files_in(&self, folder: &str, token: &str) -> Result<Vec<MeshFile>, Fault> {
        let mut names = self.list(folder)?;
        names.sort_unstable();
        let file = |name: &String| {
            let kind = match name.rsplit_once('.')? {
                (track, "obj") => Kind::Obj(track.to_owned()),
                (track, "ply") => Kind::Ply(track.to_owned()),
                _ => return None,
            };
            Some(self.file(format!("{folder}/{name}"), token, kind))
        };
        Ok(names.iter().filter_map(file).collect())
    }

    fn file(&self, path: String, token: &str, kind: Kind) -> MeshFile {
        let bytes = file_bytes(&self.root, &path);
        MeshFile { path, bytes, keyframe: token.to_owned(), kind }
    }

    /// The names in a folder; none if it is absent.
    fn list(&self, folder: &str) -> Result<Vec<String>, Fault> {
        match disk::list(&self.root.join(folder)) {
            Ok(entries) => {
                Ok(entries.into_iter().filter_map(|entry| name_of(&entry.path())).collect())
            }
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
            Err(error) => Err(unreadable(folder, &error)),
        }
    }

    /// The names of the tracks whose meshes a file holds.
    ///
    /// # Errors
    /// If the file has to be read for that and cannot be, or holds no names.
    pub fn tracks(&self, file: &MeshFile) -> Result<Vec<String>, Fault> {
        match &file.kind {
            Kind::Obj(track) | Kind::Ply(track) => Ok(vec![track.clone()]),
            Kind::Npz => {
                let names = arrays::decode_names(&read_file(&self.root, &file.path)?);
                names.map_err(|fault| Fault { place: file.path.clone(), ..fault })
            }
        }
    }

    /// The meshes of a keyframe's files.
    ///
    /// # Errors
    /// If one cannot be read or is broken, or two are of one track.
    pub fn read(&self, files: &[&MeshFile]) -> Result<Vec<LoggedMesh>, Fault> {
        let mut of_track: BTreeMap<String, &str> = BTreeMap::new();
        let mut meshes = Vec::new();
        for file in files {
            let read =
                self.read_one(file).map_err(|fault| Fault { place: file.path.clone(), ..fault });
            for mesh in read? {
                if let Some(other) = of_track.insert(mesh.track.clone(), &file.path) {
                    let expected = "one mesh of a track at a keyframe";
                    let fault = Fault::new("mesh-twice", &file.path, expected, other);
                    return Err(fault.record(mesh.track));
                }
                meshes.push(mesh);
            }
        }
        Ok(meshes)
    }

    fn read_one(&self, file: &MeshFile) -> Result<Vec<LoggedMesh>, Fault> {
        let bytes = read_file(&self.root, &file.path)?;
        let one = |track: &String, mesh| vec![LoggedMesh { track: track.clone(), mesh }];
        match &file.kind {
            Kind::Obj(track) => obj::decode(&bytes).map(|mesh| one(track, mesh)),
            Kind::Ply(track) => ply::decode(&bytes).map(|mesh| one(track, mesh)),
            Kind::Npz => arrays::decode(&bytes),
        }
    }
}

fn name_of(path: &Path) -> Option<String> {
    path.file_name().map(|name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use occlabel_core::Timestamp;

    use super::*;

    const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    fn log(files: &[(&str, &[u8])]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (name, bytes) in files {
            let path = root.path().join("meshes").join(name);
            fs::create_dir_all(path.parent().unwrap())
                .and_then(|()| fs::write(path, bytes))
                .unwrap();
        }
        root
    }

    fn keyframes(tokens: &[&str]) -> Vec<Keyframe> {
        let keyframe = |token: &&str| Keyframe {
            token: (*token).to_owned(),
            time: Timestamp(0),
            sweep: 0,
            exposures: Vec::new(),
        };
        tokens.iter().map(keyframe).collect()
    }

    #[test]
    fn files_are_found_by_scene_and_keyframe_in_order() {
        let obj = OBJ.as_bytes();
        let root = log(&[
            ("s/k1/b.obj", obj),
            ("s/k1/a.ply", b""),
            ("s/k1/a.mtl", b""),
            ("s/k0.npz", b""),
            ("s/k9/a.obj", obj),
            ("other/k1/a.obj", obj),
        ]);
        let folder = MeshFolder::open(root.path(), "meshes").unwrap();
        let files = folder.files("s", &keyframes(&["k0", "k1", "k2"])).unwrap();
        let paths: Vec<&str> = files.iter().map(|file| file.path.as_str()).collect();
        assert_eq!(paths, ["meshes/s/k0.npz", "meshes/s/k1/a.ply", "meshes/s/k1/b.obj"]);
        assert_eq!(files[2].bytes, obj.len() as u64);
        assert_eq!(folder.tracks(&files[2]).unwrap(), ["b"]);
        assert_eq!(folder.files("absent", &keyframes(&["k0"])).unwrap(), []);
    }

    #[test]
    fn two_meshes_of_a_track_and_broken_files_are_refused_by_name() {
        let obj = OBJ.as_bytes();
        let ply = ply::tests::file("ascii");
        let root = log(&[("s/k/a.obj", obj), ("s/k/a.ply", &ply), ("s/l/a.obj", b"f 1 2 3")]);
        let folder = MeshFolder::open(root.path(), "meshes/").unwrap();
        let read = |token| {
            let files = folder.files("s", &keyframes(&[token])).unwrap();
            folder.read(&files.iter().collect::<Vec<_>>()).unwrap_err().to_string()
        };
        assert!(read("k").contains("meshes/s/k/a.ply (a)"), "{}", read("k"));
        assert!(read("l").contains("meshes/s/l/a.obj (line 1)"), "{}", read("l"));
        assert_eq!(MeshFolder::open(root.path(), "bodies").unwrap_err().rule, "mesh-folder");
    }
}
