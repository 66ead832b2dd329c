//! Which keyframes are finished: a line each, safe on disk before the next is begun.

use std::path::Path;

use occlabel_core::Fault;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::atomic::{Appender, write_file};
use crate::{FileRecord, LabelTree, TreePath, json};

/// A finished keyframe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JournalEntry {
    /// Its scene's name.
    pub scene: String,
    /// Its token.
    pub keyframe: String,
    /// Its files.
    pub files: Vec<FileRecord>,
    /// What the report says of it; null if only the manifest of an earlier run knows of it.
    pub summary: Value,
}

impl JournalEntry {
    /// Whether all its files stand, by their lengths.
    pub fn stands(&self, tree: &LabelTree) -> bool {
        self.files.iter().all(|file| file.stands(tree))
    }

    /// Whether it has a file at this path: a run without evidence has finished its keyframes too.
    pub fn has(&self, path: &TreePath) -> bool {
        self.files.iter().any(|file| file.path == *path)
    }

    fn line(&self) -> Vec<u8> {
        let mut line = serde_json::to_vec(self).expect("a value with a JSON form");
        line.push(b'\n');
        line
    }
}

/// `journal.jsonl`, open to be added to.
#[derive(Debug)]
pub struct Journal(Appender);

impl Journal {
    /// A journal that begins with these entries, in place of one that is there.
    pub(crate) fn create<'a>(
        path: &Path,
        entries: impl IntoIterator<Item = &'a JournalEntry>,
    ) -> Result<Self, Fault> {
        let lines: Vec<u8> = entries.into_iter().flat_map(JournalEntry::line).collect();
        write_file(path, &lines)?;
        Ok(Self(Appender::open(path)?))
    }

    /// Notes that a keyframe is finished. Its files must stand by now.
    ///
    /// # Errors
    /// If the line cannot be written; then the keyframe will be done again.
    pub fn append(&mut self, entry: &JournalEntry) -> Result<(), Fault> {
        self.0.append(&entry.line())
    }
}

/// The entries of a journal; none if there is no journal.
///
/// A line that is torn, as by a power cut, is passed over: its keyframe will be done again.
pub(crate) fn read(path: &Path) -> Result<Vec<JournalEntry>, Fault> {
    let bytes = json::read_bounded(path)?.unwrap_or_default();
    Ok(bytes.split(|&byte| byte == b'\n').flat_map(serde_json::from_slice).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;

    fn entry(keyframe: &str) -> JournalEntry {
        let path = TreePath::labels("s", keyframe).unwrap();
        JournalEntry {
            scene: "s".to_owned(),
            keyframe: keyframe.to_owned(),
            files: vec![FileRecord::of_bytes(path, b"x")],
            summary: json!({"points": 12}),
        }
    }

    #[test]
    fn entries_are_read_back_in_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        assert_eq!(read(&path).unwrap(), []);
        let mut journal = Journal::create(&path, [&entry("a")]).unwrap();
        journal.append(&entry("b")).unwrap();
        journal.append(&entry("c")).unwrap();
        assert_eq!(read(&path).unwrap(), ["a", "b", "c"].map(entry));
        assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), 3);
    }

    #[test]
    fn fault_39_a_torn_last_line_is_passed_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let mut journal = Journal::create(&path, []).unwrap();
        journal.append(&entry("a")).unwrap();
        journal.append(&entry("b")).unwrap();
        let whole = fs::read(&path).unwrap();
        let mut torn = 0;
        for end in whole.len() / 2 + 1..whole.len() - 1 {
            fs::write(&path, &whole[..end]).unwrap();
            assert_eq!(read(&path).unwrap(), [entry("a")], "{end}");
            torn += 1;
        }
        assert!(torn > 100);
    }

    #[test]
    fn fault_36_a_line_with_a_path_outside_is_passed_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let line = String::from_utf8(entry("a").line()).unwrap().replace("gts/s", "../../x");
        fs::write(&path, line).unwrap();
        assert_eq!(read(&path).unwrap(), []);
    }

    #[test]
    fn fault_39_a_keyframe_without_its_files_is_not_finished() {
        let folder = tempfile::tempdir().unwrap();
        let tree = LabelTree::new(folder.path());
        assert!(!entry("a").stands(&tree));
        assert!(entry("a").has(&TreePath::labels("s", "a").unwrap()));
        assert!(!entry("a").has(&TreePath::evidence("s", "a").unwrap()));
        tree.write(&TreePath::labels("s", "a").unwrap(), b"x").unwrap();
        assert!(entry("a").stands(&tree));
    }
}
