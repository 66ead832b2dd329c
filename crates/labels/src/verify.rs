//! A tree against its manifest: what is missing, changed, or not listed.

use std::collections::BTreeSet;

use occlabel_core::Fault;
use occlabel_disk as disk;

use crate::files::hash_file;
use crate::run_files::is_of_run;
use crate::{FileRecord, LabelTree, Manifest, json_hash};

/// Whether a listed file stands in the tree as its record says, every bit of it.
///
/// # Errors
/// If it is missing, is no file of the tree's own, or differs in length or hash.
pub fn verify_file(tree: &LabelTree, record: &FileRecord) -> Result<(), Fault> {
    let place = tree.place(&record.path);
    let expected = format!("{} bytes of hash {}", record.bytes, record.blake3);
    let fault = |rule, found: String| Err(Fault::new(rule, record.path.as_str(), &expected, found));
    match disk::symlink_metadata(&place) {
        Err(error) => return fault("file-missing", error.to_string()),
        Ok(meta) if !meta.is_file() => return fault("file-kind", "no plain file".to_owned()),
        Ok(_) => {}
    }
    let (bytes, blake3) = hash_file(&place)?;
    match bytes == record.bytes && blake3 == record.blake3 {
        true => Ok(()),
        false => fault("file-changed", format!("{bytes} bytes of hash {blake3}")),
    }
}

/// What a manifest says that cannot be: a hash that is not its configuration's or its inputs', keyframes
/// without files, files of keyframes that it does not list, or listed twice, a grid that is none.
pub fn verify_manifest(manifest: &Manifest) -> Vec<Fault> {
    let mut faults: Vec<Fault> = manifest.grid.spec().err().into_iter().collect();
    let hash = json_hash(&manifest.config);
    if hash != manifest.config_hash {
        faults.push(fault("config_hash", hash, manifest.config_hash.clone()));
    }
    let inputs = manifest.input_hashes.whole();
    if inputs != manifest.inputs_hash {
        faults.push(fault("inputs_hash", inputs, manifest.inputs_hash.clone()));
    }
    let mut paths = BTreeSet::new();
    let twice = manifest.files.iter().filter(|file| !paths.insert(&file.path));
    faults.extend(
        twice.map(|file| fault("files", "each file once".to_owned(), file.path.to_string())),
    );
    let listed: BTreeSet<(&str, &str)> = keyframes(manifest).collect();
    let with_files: BTreeSet<_> = manifest.files.iter().filter_map(FileRecord::keyframe).collect();
    let lacking = listed.difference(&with_files).map(|(scene, token)| {
        fault("scenes", format!("files of keyframe {scene}/{token}"), "none".to_owned())
    });
    let foreign = with_files.difference(&listed).map(|(scene, token)| {
        fault("files", "files of listed keyframes".to_owned(), format!("{scene}/{token}"))
    });
    faults.extend(lacking.chain(foreign));
    faults
}

/// The files of a tree that neither its manifest lists nor a run keeps for itself, in order of their
/// paths. Links are told, not followed.
///
/// # Errors
/// If a folder cannot be read.
pub fn unlisted_files(tree: &LabelTree, manifest: &Manifest) -> Result<Vec<String>, Fault> {
    let listed: BTreeSet<&str> = manifest.files.iter().map(|file| file.path.as_str()).collect();
    let mut found = tree.files()?;
    found.retain(|path| !listed.contains(path.as_str()) && !is_of_run(path));
    Ok(found)
}

/// The keyframes of a manifest: scene and token.
fn keyframes(manifest: &Manifest) -> impl Iterator<Item = (&str, &str)> {
    manifest.scenes.iter().flat_map(|(scene, record)| {
        record.keyframes.iter().map(move |token| (scene.as_str(), token.as_str()))
    })
}

fn fault(record: &str, expected: String, found: String) -> Fault {
    Fault::new("manifest", "manifest.json", expected, found).record(record)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifest::tests::manifest;
    use crate::{SceneRecord, TreePath};
    use std::fs;

    /// A tree of two keyframes, and its manifest.
    fn tree() -> (tempfile::TempDir, LabelTree, Manifest) {
        let folder = tempfile::tempdir().unwrap();
        let tree = LabelTree::new(folder.path());
        let file = |token: &str| {
            let path = TreePath::labels("s", token).unwrap();
            tree.write(&path, token.as_bytes()).unwrap()
        };
        let files = vec![file("k1"), file("k2")];
        let inputs_hash = manifest().input_hashes.whole();
        (folder, tree, Manifest { files, inputs_hash, ..manifest() })
    }

    #[test]
    fn a_tree_as_it_was_written_has_no_faults() {
        let (_folder, tree, manifest) = tree();
        assert!(manifest.files.iter().all(|file| verify_file(&tree, file).is_ok()));
        assert_eq!(verify_manifest(&manifest), []);
        let own =
            ["manifest.json", "report.0-of-2.json", "journal.jsonl", ".run.lock", "gts/s/.lock"];
        own.iter().for_each(|name| fs::write(tree.root().join(name), b"").unwrap());
        assert_eq!(unlisted_files(&tree, &manifest).unwrap(), [""; 0]);
    }

    #[test]
    fn every_flipped_bit_is_found() {
        let (_folder, tree, manifest) = tree();
        let place = tree.place(&manifest.files[1].path);
        let bytes = fs::read(&place).unwrap();
        for bit in 0..bytes.len() * 8 {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            fs::write(&place, flipped).unwrap();
            let fault = verify_file(&tree, &manifest.files[1]).unwrap_err();
            assert_eq!(fault.rule, "file-changed", "bit {bit}");
        }
        assert_eq!(bytes.len() * 8, 16);
    }

    #[test]
    fn what_is_missing_or_no_file_is_told() {
        let (_folder, tree, manifest) = tree();
        let (one, two) = (&manifest.files[0], &manifest.files[1]);
        fs::remove_file(tree.place(&one.path)).unwrap();
        assert_eq!(verify_file(&tree, one).unwrap_err().rule, "file-missing");
        std::os::unix::fs::symlink(tree.place(&two.path), tree.place(&one.path)).unwrap();
        assert_eq!(verify_file(&tree, one).unwrap_err().rule, "file-kind");
    }

    #[test]
    fn what_is_not_listed_is_told_in_order() {
        let (_folder, tree, mut manifest) = tree();
        manifest.files.remove(0);
        fs::write(tree.root().join("gts/s/k2/.labels.npz.Ab12Cd.part"), b"half").unwrap();
        fs::write(tree.root().join("manifest.jsonx"), b"").unwrap();
        let expected =
            ["gts/s/k1/labels.npz", "gts/s/k2/.labels.npz.Ab12Cd.part", "manifest.jsonx"];
        assert_eq!(unlisted_files(&tree, &manifest).unwrap(), expected);
    }

    #[test]
    fn a_manifest_that_contradicts_itself_is_told() {
        let (_folder, _tree, mut manifest) = tree();
        manifest.config_hash = "0".repeat(64);
        manifest.files.pop();
        let told: Vec<_> = verify_manifest(&manifest).iter().map(ToString::to_string).collect();
        assert_eq!(told.len(), 2);
        assert!(told[0].contains("config_hash") && told[1].contains("s/k2"), "{told:?}");
        manifest.inputs_hash = "0".repeat(64);
        manifest.files.push(manifest.files[0].clone());
        let told: Vec<_> = verify_manifest(&manifest).iter().map(ToString::to_string).collect();
        assert!(told[1].contains("inputs_hash") && told[2].contains("each file once"), "{told:?}");
        (manifest.inputs_hash, _) = (manifest.input_hashes.whole(), manifest.files.pop());
        manifest.scenes.insert("s".to_owned(), SceneRecord::default());
        let told = verify_manifest(&manifest)[1].to_string();
        assert!(told.contains("expected files of listed keyframes, found s/k1"), "{told}");
    }
}
