//! A run's life: begun, interrupted, taken up again, ended.
//!
//! ```text
//!   begin: run.json, journal.jsonl -> keyframe after keyframe: its files, then its line
//!   end: report.json, manifest.json -> run.json and journal.jsonl leave
//! ```

use std::collections::BTreeMap;

use occlabel_core::Fault;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::atomic::{create_dir, remove_empty_dirs, remove_file, write_file};
use crate::differences::in_one_line;
use crate::earlier::{Earlier, mark_report};
use crate::other_runs::differences_from_others;
use crate::{
    FileRecord, InputRecord, Journal, JournalEntry, Manifest, Program, RunFiles, TreePath,
    WriterLock, json,
};

/// The rule of a fault that refuses to go on with another run: exit code 2.
pub const RESUME_DIFFERS: &str = "resume-differs";

/// What is done with what an earlier run left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Resume {
    /// Finished keyframes are kept if version, configuration and inputs are the same; if they are
    /// not, the run is refused.
    #[default]
    IfSame,
    /// All that the earlier run's own records list is removed, and nothing else.
    Never,
    /// Finished keyframes are kept, whatever made them.
    Always,
}

/// `run.json`: what a run is. Runs with equal records give the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Who runs.
    pub program: Program,
    /// All tables of the configuration as resolved.
    pub config: Value,
    /// [`json_hash`](crate::json_hash) of `config`.
    pub config_hash: String,
    /// What it reads, in order of the paths.
    pub inputs: Vec<InputRecord>,
}

impl RunRecord {
    /// The record of a run of this program.
    pub fn new(config: Value, mut inputs: Vec<InputRecord>) -> Self {
        inputs.sort();
        let config_hash = json::json_hash(&config);
        Self { program: Program::current(), config, config_hash, inputs }
    }
}

/// A run that may write.
#[derive(Debug)]
pub struct Begun {
    /// Keyframes that are finished already, by scene and token.
    pub finished: BTreeMap<(String, String), JournalEntry>,
    /// In what the run that finished them differs from this one: not empty under [`Resume::Always`]
    /// alone.
    pub differences: Vec<String>,
    /// Where each further one is noted.
    pub journal: Journal,
    files: RunFiles,
    record: RunRecord,
    /// Keeps a second process out of the same run.
    _lock: WriterLock,
}

/// Begins a run, or takes it up again. The record is written before anything else.
///
/// # Errors
/// [`RESUME_DIFFERS`] if another run has been here and `resume` is [`Resume::IfSame`], or if it was one
/// of other shards and `resume` is not [`Resume::Always`]: the differing keys are told, and nothing is
/// changed. If another process is at it. If the records
/// cannot be read or written.
pub fn begin(files: &RunFiles, record: &RunRecord, resume: Resume) -> Result<Begun, Fault> {
    create_dir(files.tree().root())?;
    let lock = WriterLock::acquire(files.lock())?;
    if resume != Resume::Always {
        refuse_others(files, &differences_from_others(files, record)?)?;
    }
    let earlier = Earlier::load(files)?;
    files.refuse_links()?;
    let differences = earlier.differences(record);
    if resume == Resume::IfSame && !earlier.finished(files.tree()).is_empty() {
        refuse_another(files, &differences)?;
    }
    if resume == Resume::Never {
        earlier.remove(files)?;
    }
    let finished = match resume {
        Resume::Never => BTreeMap::new(),
        Resume::IfSame | Resume::Always => finished_before(files, &earlier, record)?,
    };
    write_file(&files.run(), &json::pretty(record))?;
    let journal = Journal::create(&files.journal(), finished.values())?;
    if !earlier.manifest_is_of(record) {
        remove_file(&files.manifest())?;
        remove_file(&files.report())?;
        earlier.remove_files_of_all(files.tree())?;
    }
    let differences = if finished.is_empty() { Vec::new() } else { differences };
    let (files, record) = (files.clone(), record.clone());
    Ok(Begun { finished, differences, journal, files, record, _lock: lock })
}

impl Begun {
    /// Writes a JSON file that tells of all keyframes, `<stem>.json`, at the top of the tree or in a
    /// folder of it, and gives what the manifest says of it. Shards have theirs each.
    ///
    /// # Errors
    /// If it cannot be written, or the folder is no plain name.
    pub fn write_of_all(
        &self,
        folder: Option<&str>,
        stem: &str,
        json: &impl Serialize,
    ) -> Result<FileRecord, Fault> {
        let name = self.files.name(stem, "json");
        let path = folder.map_or(name.clone(), |folder| format!("{folder}/{name}"));
        self.files.tree().write(&TreePath::new(path)?, &json::pretty(json))
    }

    /// Ends the run: the report, then the manifest; the records of the unfinished run leave.
    ///
    /// # Errors
    /// If they cannot be written or removed.
    pub fn end(self, manifest: &Manifest, mut report: Value) -> Result<(), Fault> {
        mark_report(&mut report, &self.record);
        write_file(&self.files.report(), &json::pretty(&report))?;
        write_file(&self.files.manifest(), &manifest.to_json())?;
        remove_file(&self.files.journal())?;
        remove_file(&self.files.run())?;
        self.remove_empty_scenes(manifest);
        Ok(())
    }

    /// Layouts other than ours leave nothing in the folders that scenes were locked by. Shards leave
    /// them: another might be about to lock.
    fn remove_empty_scenes(&self, manifest: &Manifest) {
        let tree = self.files.tree();
        let locks = manifest.scenes.keys().filter_map(|scene| TreePath::lock(scene).ok());
        for lock in locks.filter(|_| !self.files.is_of_shard()) {
            let place = tree.place(&lock);
            remove_empty_dirs(place.parent().unwrap_or(tree.root()), tree.root());
        }
    }
}

/// The keyframes that this run finished, and, of a shard, those that were merged since.
fn finished_before(
    files: &RunFiles,
    earlier: &Earlier,
    record: &RunRecord,
) -> Result<BTreeMap<(String, String), JournalEntry>, Fault> {
    let mut finished = Earlier::merged(files, record)?;
    finished.extend(earlier.finished(files.tree()));
    Ok(finished)
}

fn refuse_another(files: &RunFiles, differences: &[String]) -> Result<(), Fault> {
    if differences.is_empty() {
        return Ok(());
    }
    let place = files.tree().root().display().to_string();
    let expected = "the version, configuration and inputs of the run that was here";
    Err(Fault::new(RESUME_DIFFERS, place, expected, in_one_line(differences)).hint(
        "give another --output, or --resume never to start anew, --resume always to keep what is finished",
    ))
}

/// Refuses to write beside runs whose records are not this one's to remove.
fn refuse_others(files: &RunFiles, differences: &[String]) -> Result<(), Fault> {
    if differences.is_empty() {
        return Ok(());
    }
    let place = files.tree().root().display().to_string();
    let expected = "a tree of this run, whole or in these shards";
    Err(Fault::new(RESUME_DIFFERS, place, expected, in_one_line(differences)).hint(
        "give another --output; `occlabel merge-manifests` ends a run in shards that have all ended",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifest::tests::manifest;
    use crate::{InputHashes, InputMark, LabelTree, TreePath, hash_files};
    use serde_json::json;
    use std::fs;
    use std::path::Path;

    fn record() -> RunRecord {
        let table = InputMark::Blake3("ab".to_owned());
        let sweep = InputMark::MtimeNs(7);
        let inputs = vec![
            InputRecord { path: "sweep.bin".to_owned(), bytes: 20, mark: sweep, scene: None },
            InputRecord { path: "scene.json".to_owned(), bytes: 2, mark: table, scene: None },
        ];
        RunRecord::new(manifest().config, inputs)
    }

    fn other_record() -> RunRecord {
        RunRecord::new(json!({"raycast": {"outside": "drop"}}), record().inputs)
    }

    fn run() -> (tempfile::TempDir, RunFiles) {
        let folder = tempfile::tempdir().unwrap();
        let files = RunFiles::whole(LabelTree::new(folder.path().join("out")));
        (folder, files)
    }

    fn finish(files: &RunFiles, begun: &mut Begun, keyframe: &str) {
        let path = TreePath::labels("s", keyframe).unwrap();
        let record = files.tree().write(&path, keyframe.as_bytes()).unwrap();
        let entry = JournalEntry {
            scene: "s".to_owned(),
            keyframe: keyframe.to_owned(),
            files: vec![record],
            summary: json!({"hits": 3}),
        };
        begun.journal.append(&entry).unwrap();
    }

    /// Two keyframes finished, then killed.
    fn interrupted() -> (tempfile::TempDir, RunFiles) {
        let (folder, files, _) = two_finished();
        (folder, files)
    }

    fn two_finished() -> (tempfile::TempDir, RunFiles, Begun) {
        let (folder, files) = run();
        let mut begun = begin(&files, &record(), Resume::IfSame).unwrap();
        finish(&files, &mut begun, "k1");
        finish(&files, &mut begun, "k2");
        (folder, files, begun)
    }

    fn complete() -> (tempfile::TempDir, RunFiles) {
        let (folder, files, begun) = two_finished();
        let paths = ["k1", "k2"].map(|keyframe| TreePath::labels("s", keyframe).unwrap());
        let listed = hash_files(files.tree(), paths).unwrap();
        let inputs_hash = InputHashes::of(&record().inputs).whole();
        let manifest = Manifest { files: listed, inputs_hash, ..manifest() };
        begun.end(&manifest, json!({"seconds": 1.5})).unwrap();
        (folder, files)
    }

    fn keyframes(begun: &Begun) -> Vec<&str> {
        begun.finished.keys().map(|(_, keyframe)| keyframe.as_str()).collect()
    }

    fn top(files: &RunFiles) -> Vec<String> {
        let entries = fs::read_dir(files.tree().root()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn labels(files: &RunFiles, keyframe: &str) -> std::path::PathBuf {
        files.tree().place(&TreePath::labels("s", keyframe).unwrap())
    }

    #[test]
    fn fault_39_a_run_goes_on_after_its_finished_keyframes() {
        let (_folder, files) = interrupted();
        let begun = begin(&files, &record(), Resume::IfSame).unwrap();
        assert_eq!(keyframes(&begun), ["k1", "k2"]);
        let entry = &begun.finished[&("s".to_owned(), "k1".to_owned())];
        assert_eq!(entry.summary, json!({"hits": 3}));
        assert_eq!(top(&files), [".run.lock", "gts", "journal.jsonl", "run.json"]);
    }

    #[test]
    fn fault_39_a_keyframe_whose_file_is_gone_or_cut_is_done_again() {
        let (_folder, files) = interrupted();
        fs::write(labels(&files, "k1"), b"").unwrap();
        let begun = begin(&files, &record(), Resume::IfSame).unwrap();
        assert_eq!(keyframes(&begun), ["k2"]);
    }

    #[test]
    fn fault_39_a_second_process_at_the_same_run_is_refused() {
        let (_folder, files) = run();
        let _begun = begin(&files, &record(), Resume::IfSame).unwrap();
        assert_eq!(begin(&files, &record(), Resume::Never).unwrap_err().rule, "lock");
    }

    #[test]
    fn fault_40_another_configuration_or_input_is_refused_with_its_keys() {
        for (_folder, files) in [interrupted(), complete()] {
            let before = top(&files);
            let fault = begin(&files, &other_record(), Resume::IfSame).unwrap_err();
            assert_eq!(fault.rule, RESUME_DIFFERS);
            let told = "config.raycast.outside: \"clip\" before, \"drop\" now";
            assert!(fault.found.contains(told), "{fault}");
            assert!(fault.hint.as_deref().unwrap().contains("--resume never"));

            let mut newer = record();
            newer.program.version = "99.0.0".to_owned();
            newer.inputs[0].bytes += 1;
            let found = begin(&files, &newer, Resume::IfSame).unwrap_err().found;
            assert!(found.contains("program.version") && found.contains("inputs"), "{found}");
            assert_eq!(top(&files), before);
        }
    }

    #[test]
    fn fault_40_an_unfinished_run_knows_the_input_that_changed() {
        let (_folder, files) = interrupted();
        let mut touched = record();
        touched.inputs[1].mark = InputMark::MtimeNs(8);
        let found = begin(&files, &touched, Resume::IfSame).unwrap_err().found;
        assert_eq!(found, "inputs.sweep.bin.mtime_ns: 7 before, 8 now");
    }

    #[test]
    fn fault_40_never_removes_what_the_records_list_and_nothing_else() {
        for (_folder, files) in [interrupted(), complete()] {
            let note = labels(&files, "k2").with_file_name("note.txt");
            fs::write(&note, b"mine").unwrap();
            let begun = begin(&files, &other_record(), Resume::Never).unwrap();
            assert!(begun.finished.is_empty());
            assert!(note.exists() && !labels(&files, "k2").exists());
            assert!(!labels(&files, "k1").parent().unwrap().exists());
            assert_eq!(top(&files), [".run.lock", "gts", "journal.jsonl", "run.json"]);
        }
    }

    #[test]
    fn fault_40_never_leaves_a_scene_alone_that_another_writes() {
        let (_folder, files) = interrupted();
        let _lock = WriterLock::of_scene(files.tree(), "s").unwrap();
        assert_eq!(begin(&files, &record(), Resume::Never).unwrap_err().rule, "lock");
        assert!(labels(&files, "k1").exists());
    }

    #[test]
    fn fault_40_always_keeps_what_is_finished_whatever_made_it() {
        for (_folder, files) in [interrupted(), complete()] {
            let begun = begin(&files, &other_record(), Resume::Always).unwrap();
            assert_eq!(keyframes(&begun), ["k1", "k2"]);
            assert!(!files.manifest().exists());
        }
    }

    #[test]
    fn a_finished_run_leaves_manifest_and_report() {
        let (_folder, files) = complete();
        assert_eq!(top(&files), ["gts", "manifest.json", "report.json"]);
        let report: Value = json::read(&files.report()).unwrap().unwrap();
        assert_eq!(report["seconds"], 1.5);
    }

    #[test]
    fn a_finished_run_given_again_has_nothing_to_do_and_ends_with_the_same_manifest() {
        let (_folder, files) = complete();
        let before = fs::read(files.manifest()).unwrap();
        let begun = begin(&files, &record(), Resume::IfSame).unwrap();
        assert_eq!(keyframes(&begun), ["k1", "k2"]);
        drop(begun);
        assert_eq!(fs::read(files.manifest()).unwrap(), before);

        let again = begin(&files, &record(), Resume::IfSame).unwrap();
        assert_eq!(keyframes(&again), ["k1", "k2"]);
        let manifest = Manifest::load(&files.manifest()).unwrap().unwrap();
        again.end(&manifest, json!({})).unwrap();
        assert_eq!(fs::read(files.manifest()).unwrap(), before);
    }

    #[test]
    fn fault_40_a_sweep_touched_since_a_finished_run_is_noticed() {
        let (_folder, files) = complete();
        let mut touched = record();
        touched.inputs[1].mark = InputMark::MtimeNs(8);
        assert_eq!(begin(&files, &touched, Resume::IfSame).unwrap_err().rule, RESUME_DIFFERS);
        let kept = begin(&files, &touched, Resume::Always).unwrap();
        assert_eq!((keyframes(&kept), kept.differences.len()), (vec!["k1", "k2"], 1));
    }

    #[test]
    fn fault_39_killed_while_ending_the_run_counts_as_it_stands() {
        let (_folder, files) = complete();
        write_file(&files.run(), &json::pretty(&record())).unwrap();
        let begun = begin(&files, &record(), Resume::IfSame).unwrap();
        assert_eq!(keyframes(&begun), ["k1", "k2"]);
    }

    #[test]
    fn fault_38_an_output_that_is_a_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        fs::write(&path, b"x").unwrap();
        for root in [path.clone(), path.join("deeper")] {
            let files = RunFiles::whole(LabelTree::new(root));
            assert_eq!(begin(&files, &record(), Resume::IfSame).unwrap_err().rule, "folder");
        }
        assert_eq!(fs::read(Path::new(&path)).unwrap(), b"x");
    }
}
