//! Every reader of this crate that meets bytes of a file, behind one signature: what fuzzing and the
//! tests with damage knock at.

use std::path::{Component, Path};

use occlabel_core::{Evidence, GridSpec, OccupancyLabels, VoxelGrid, VoxelState};
use occlabel_testkit::{Door, in_folder};
use serde_json::json;

use crate::{
    ClassRecord, FileRecord, GridRecord, InputHashes, InputMark, InputRecord, JournalEntry,
    LabelTree, Manifest, NpzFile, NumberArray, PoseRecord, Program, Resume, RigidRecord, RunFiles,
    RunRecord, SceneRecord, TaxonomyRecord, TrackRecord, TreePath, begin, evidence_npz, json_hash,
    labels_npz, pretty_json, read_evidence, read_labels, read_npy, unlisted_files, verify_file,
    verify_manifest,
};

/// All of them.
pub const DOORS: &[Door] = &[
    Door { name: "label_npz", knock: label_npz, seeds: || vec![labels_npz(&labels()), evidence()] },
    Door { name: "label_npy", knock: label_npy, seeds: arrays },
    Door { name: "manifest", knock: manifest, seeds: || vec![sound_manifest().to_json()] },
    Door { name: "run_records", knock: run_records, seeds: records },
    Door { name: "tree_path", knock: tree_path, seeds: || vec![LABELS.into()] },
];

const LABELS: &str = "gts/scene-1/a/labels.npz";
/// What an array takes at most.
const MAX_BYTES: u64 = 1 << 12;

fn spec() -> GridSpec {
    GridSpec::new([0.0; 3], [2.0, 2.0, 3.0], [1.0; 3]).unwrap()
}

fn labels() -> OccupancyLabels {
    OccupancyLabels {
        semantics: VoxelGrid::filled(&spec(), 17),
        mask_lidar: VoxelGrid::filled(&spec(), 1),
        mask_camera: VoxelGrid::filled(&spec(), 0),
        states: VoxelGrid::filled(&spec(), VoxelState::Free),
        evidence: None,
    }
}

fn evidence() -> Vec<u8> {
    evidence_npz(&Evidence {
        hits: VoxelGrid::filled(&spec(), 3),
        crossings: VoxelGrid::filled(&spec(), 1),
        state: VoxelGrid::filled(&spec(), 2),
        instances: VoxelGrid::filled(&spec(), 0),
        flow: VoxelGrid::filled(&spec(), [0.5, -1.0, 0.0]),
        camera_bits: VoxelGrid::filled(&spec(), 5),
    })
}

/// A file of arrays, read for labels, for evidence, and array by array.
fn label_npz(bytes: &[u8]) -> bool {
    in_folder(&[("a.npz", bytes)], |root| {
        let path = root.join("a.npz");
        if let Ok(mut file) = NpzFile::open(&path, MAX_BYTES) {
            for name in file.names() {
                let _ = file.header(&name);
                file.array(&name, MAX_BYTES).ok().flatten().iter().for_each(count);
            }
        }
        read_labels(&path, &spec()).is_ok() | read_evidence(&path, &spec()).is_ok()
    })
}

fn label_npy(bytes: &[u8]) -> bool {
    in_folder(&[("a.npy", bytes)], |root| {
        let array = read_npy(&root.join("a.npy"), MAX_BYTES);
        array.as_ref().is_ok_and(|array| {
            count(array);
            true
        })
    })
}

/// Reads all numbers in both ways.
fn count(array: &NumberArray) {
    assert_eq!(array.floats().len(), array.len());
    assert!(array.whole().is_none_or(|whole| whole.len() == array.len()));
    assert_eq!(array.len(), array.shape.iter().product::<usize>());
}

fn arrays() -> Vec<Vec<u8>> {
    let whole = NumberArray::new(&[2, 3], &[1_u16, 2, 3, 4, 5, 6]);
    let floats = NumberArray::new(&[2], &[0.5_f32, -1e9]);
    vec![whole.to_npy(), floats.to_npy()]
}

/// A manifest, with nothing of what it lists beside it.
fn manifest(bytes: &[u8]) -> bool {
    in_folder(&[("manifest.json", bytes)], |root| {
        let Ok(Some(manifest)) = Manifest::load_tree(root) else { return false };
        let tree = LabelTree::new(root);
        let _ = (manifest.grid.spec(), unlisted_files(&tree, &manifest));
        let missing = manifest.files.iter().filter(|file| verify_file(&tree, file).is_err());
        assert_eq!(missing.count(), manifest.files.len(), "files that are not there");
        let merged = manifest.clone().merge(manifest.clone()).expect("the same twice");
        assert_eq!(merged.scenes, manifest.scenes);
        verify_manifest(&manifest).is_empty()
    })
}

fn sound_manifest() -> Manifest {
    let config = json!({"grid": {"frame": "ego"}});
    let input_hashes = InputHashes::of(&inputs());
    Manifest {
        program: Program::current(),
        preset: Some("precise".into()),
        config_hash: json_hash(&config),
        config,
        inputs_hash: input_hashes.whole(),
        input_hashes,
        taxonomy: TaxonomyRecord { name: "t".into(), hash: "0".into() },
        dialect: None,
        notes: vec!["a note".into()],
        grid: GridRecord::new("ego", &spec()),
        classes: vec![ClassRecord { id: 0, name: "car".into() }],
        free: 17,
        scenes: [("scene-1".into(), scene())].into(),
        files: vec![file()],
    }
}

fn scene() -> SceneRecord {
    let still = RigidRecord { translation: [1.0, 2.0, 3.0], rotation: [1.0, 0.0, 0.0, 0.0] };
    let pose =
        PoseRecord { token: "a".into(), time_ns: 5, world_from_ego: still, ego_from_lidar: still };
    let track =
        TrackRecord { index: 1, id: "t".into(), class: Some("car".into()), category: "c".into() };
    SceneRecord {
        cameras: vec!["CAM".into()],
        tracks: vec![track],
        keyframes: vec!["a".into()],
        poses: vec![pose],
        world: None,
    }
}

fn file() -> FileRecord {
    FileRecord::of_bytes(TreePath::new(LABELS).unwrap(), b"labels")
}

fn inputs() -> Vec<InputRecord> {
    let record = |path: &str, scene: Option<&str>, mark| InputRecord {
        path: path.into(),
        bytes: 7,
        mark,
        scene: scene.map(Into::into),
    };
    vec![
        record("a.json", None, InputMark::Blake3("0".into())),
        record("a.bin", Some("scene-1"), InputMark::MtimeNs(5)),
    ]
}

/// The names of a run's records.
const RECORDS: [&str; 5] =
    ["run.json", "journal.jsonl", "manifest.json", "report.json", ".run.lock"];

/// A run is taken up where an earlier one left its records, the one that the first byte tells with
/// other bytes; the second byte tells how.
fn run_records(bytes: &[u8]) -> bool {
    let [place, resume, bytes @ ..] = bytes else { return false };
    let mut files = sound_records();
    files[usize::from(*place) % RECORDS.len()].1 = bytes.to_vec();
    let resume = [Resume::IfSame, Resume::Never, Resume::Always][usize::from(resume % 3)];
    let mut files: Vec<_> = files.iter().map(|(name, bytes)| (*name, &bytes[..])).collect();
    files.push((LABELS, b"labels"));
    in_folder(&files, |root| {
        let record = RunRecord::new(json!({"a": 1}), inputs());
        begin(&RunFiles::whole(LabelTree::new(root)), &record, resume).is_ok()
    })
}

fn records() -> Vec<Vec<u8>> {
    let sound = sound_records().into_iter().enumerate();
    sound.map(|(place, (_, bytes))| [vec![place as u8, 2], bytes].concat()).collect()
}

fn sound_records() -> Vec<(&'static str, Vec<u8>)> {
    let entry = JournalEntry {
        scene: "scene-1".into(),
        keyframe: "a".into(),
        files: vec![file()],
        summary: json!({"rays": 5}),
    };
    let line = [serde_json::to_vec(&entry).unwrap(), b"\n".to_vec()].concat();
    let contents = [
        pretty_json(&RunRecord::new(json!({"a": 1}), inputs())),
        line,
        sound_manifest().to_json(),
        pretty_json(&json!({"inputs_mark": "0"})),
        // No process has this id.
        b"4194305 12\n".to_vec(),
    ];
    RECORDS.into_iter().zip(contents).collect()
}

/// A path that is one stays below any root.
fn tree_path(bytes: &[u8]) -> bool {
    let Ok(path) = TreePath::new(String::from_utf8_lossy(bytes)) else { return false };
    let mut parts = Path::new(path.as_str()).components();
    assert!(parts.all(|part| matches!(part, Component::Normal(_))), "{path}");
    path.keyframe().is_none_or(|(scene, _)| path.scene() == Some(scene))
}

#[cfg(test)]
mod tests {
    use occlabel_testkit::{knock_with_corpus, knock_with_damage};

    use super::*;

    /// Runs of each reader.
    const CASES: u32 = 100;

    #[test]
    fn fault_34_damaged_files_of_a_tree_are_read_or_refused() {
        for (door, [taken, refused]) in DOORS.iter().zip(knock_with_damage(DOORS, CASES)) {
            assert!(refused > CASES / 20, "{}: {taken} taken, {refused} refused", door.name);
        }
    }

    #[test]
    fn fault_34_what_fuzzing_found_in_files_of_a_tree_is_read_or_refused() {
        assert!(knock_with_corpus(DOORS) >= DOORS.len());
    }
}
