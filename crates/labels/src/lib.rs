//! Label trees on disk: npz arrays, a manifest, atomic writes, resume.
//!
//! A tree is read by others, in other languages, years later, and is written by runs that get
//! killed. So a file is either there, whole and under its name, or it is not there: everything is
//! written beside its place and renamed (`atomic`). The data come first, then a line in the journal
//! that says so, and the manifest last; whoever finds a manifest finds all that it lists. The same
//! labels give the same bytes, so that a tree can be compared by hash. And no name that a log brings
//! along leads out of the tree: a path is a [`TreePath`] or it is no path.
//!
//! ```
//! use occlabel_core::{GridSpec, OccupancyLabels, VoxelGrid, VoxelState};
//! use occlabel_labels::{LabelTree, TreePath, WriterLock, labels_npz, read_labels};
//!
//! let spec = GridSpec::new([0.0; 3], [4.0, 4.0, 2.0], [1.0; 3])?;
//! let labels = OccupancyLabels {
//!     semantics: VoxelGrid::filled(&spec, 17),
//!     mask_lidar: VoxelGrid::filled(&spec, 1),
//!     mask_camera: VoxelGrid::filled(&spec, 0),
//!     states: VoxelGrid::filled(&spec, VoxelState::Free),
//!     evidence: None,
//! };
//!
//! let folder = tempfile::tempdir().unwrap();
//! let tree = LabelTree::new(folder.path());
//! let lock = WriterLock::of_scene(&tree, "scene-0061")?;
//! let record = tree.write(&TreePath::labels("scene-0061", "3e8750f3")?, &labels_npz(&labels))?;
//! assert_eq!(record.path.as_str(), "gts/scene-0061/3e8750f3/labels.npz");
//!
//! let read = read_labels(&tree.place(&record.path), &spec)?;
//! assert_eq!(read.semantics, labels.semantics);
//! # drop(lock);
//! # Ok::<(), occlabel_core::Fault>(())
//! ```

mod atomic;
mod beside;
mod differences;
#[cfg(any(test, fuzzing))]
pub mod doors;
mod earlier;
mod files;
mod inputs;
mod journal;
mod json;
mod lock;
mod manifest;
mod npy;
mod npz;
mod npz_file;
mod numbers;
mod other_runs;
mod pose_record;
mod read;
mod run;
mod run_files;
mod shards;
mod tree;
mod verify;

pub use atomic::{create_dir, remove_file, write_file, write_pieces};
pub use beside::Beside;
pub use files::{FileRecord, hash_files};
pub use inputs::{InputHashes, InputMark, InputRecord};
pub use journal::{Journal, JournalEntry};
pub use json::{json_hash, pretty as pretty_json, read as read_json, read_file as read_json_file};
pub use lock::WriterLock;
pub use manifest::{
    ClassRecord, GridRecord, Manifest, Program, SceneRecord, TaxonomyRecord, TrackRecord,
};
pub use npy::NpyHeader;
pub use npz::{evidence_npz, labels_npz, npz};
pub use npz_file::{NpzFile, read_bounded, read_npy};
pub use numbers::{Number, NumberArray, NumberType};
pub use pose_record::{PoseRecord, RigidRecord};
pub use read::{LabelArrays, read_evidence, read_labels};
pub use run::{Begun, RESUME_DIFFERS, Resume, RunRecord, begin};
pub use run_files::{RunFiles, name_of_whole};
pub use shards::Shards;
pub use tree::{LabelTree, TreePath};
pub use verify::{unlisted_files, verify_file, verify_manifest};
