//! Small logs of several formats, and lines that label them.

use std::cell::Cell;
use std::fs;
use std::path::{Path, PathBuf};

use occlabel_testkit::{LogSpec, write_log};
use tempfile::TempDir;

use crate::support::{Ended, SMALL, leftovers, manifest, nano_spec, occlabel, text, tree_hash};

/// A street with a car that drives by, seen by a lidar and a camera.
const WORLD: &str = include_str!("../fixtures/mcap_world.toml");
/// The log's own keyframes, which some presets pass over.
const KEYFRAMES: [&str; 4] = ["--set", "keyframes.source=annotated", "--set", "keyframes.stride=1"];
/// All files that a line can write.
const SETS: [&str; 3] = ["--evidence", "--also", "1.6"];

/// A log, and how it is labelled.
pub(crate) struct Case {
    /// Format and preset.
    pub(crate) name: String,
    folder: TempDir,
    args: Vec<String>,
    trees: Cell<usize>,
}

impl Case {
    /// Three scenes in nuScenes' layout.
    pub(crate) fn scenes(preset: &str) -> Self {
        let mut case = Self::new("nuscenes", preset, "occ3d-nuscenes");
        case.args.extend(KEYFRAMES.map(str::to_owned));
        let spec = LogSpec { sweeps_per_keyframe: 2, ..nano_spec().with_scenes(3) };
        write_log(&case.log(), &spec).expect("a log");
        case
    }

    /// A simulated drive.
    pub(crate) fn drive(format: &str, preset: &str, taxonomy: &str) -> Self {
        let read = if format == "waymo-v2" { "waymo" } else { format };
        let case = Self { name: format!("{format}-{preset}"), ..Self::new(read, preset, taxonomy) };
        let world = case.folder.path().join("street.toml");
        fs::write(&world, WORLD).expect("a world");
        let log = case.log();
        let line = ["simulate", "--world", text(&world), "--format", format, "--images", "none"];
        occlabel(&[&line[..], &["--output", text(&log)]].concat()).exits(0);
        case
    }

    fn new(format: &str, preset: &str, taxonomy: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let (log, taxonomy) = (folder.path().join("log"), format!("taxonomy.file={taxonomy}"));
        let line = ["label", "--format", format, "--input", text(&log), "--preset", preset];
        let line = [&line[..], &["--set", &taxonomy], &SMALL, &SETS].concat();
        let args = line.into_iter().map(str::to_owned).collect();
        Self { name: format!("{format}-{preset}"), folder, args, trees: Cell::new(0) }
    }

    pub(crate) fn log(&self) -> PathBuf {
        self.folder.path().join("log")
    }

    /// A place for a tree that is not there yet.
    pub(crate) fn tree(&self) -> PathBuf {
        let number = self.trees.replace(self.trees.get() + 1);
        self.folder.path().join(format!("tree-{number}"))
    }

    /// The line with an output and more arguments.
    pub(crate) fn line<'a>(&'a self, tree: &'a Path, more: &[&'a str]) -> Vec<&'a str> {
        let line = self.args.iter().map(String::as_str).chain(["--output", text(tree)]);
        line.chain(more.iter().copied()).collect()
    }

    /// Labels into a tree, which may be begun.
    #[track_caller]
    pub(crate) fn label(&self, tree: &Path, more: &[&str]) -> Ended {
        occlabel(&self.line(tree, more)).exits(0)
    }

    /// The hash of a new tree.
    #[track_caller]
    pub(crate) fn hash(&self, more: &[&str]) -> String {
        let tree = self.tree();
        self.label(&tree, more);
        whole(&tree)
    }
}

/// The hash of a tree that a run has ended.
#[track_caller]
pub(crate) fn whole(tree: &Path) -> String {
    assert_eq!(leftovers(tree), [""; 0]);
    tree_hash(tree)
}

/// Scenes and keyframes of a tree, in the manifest's order.
pub(crate) fn keyframes(tree: &Path) -> Vec<(String, Vec<String>)> {
    let manifest = manifest(tree);
    let scenes = manifest["scenes"].as_object().expect("scenes").iter();
    let tokens = |scene: &serde_json::Value| {
        let tokens = scene["keyframes"].as_array().expect("keyframes").iter();
        tokens.map(|token| token.as_str().expect("a token").to_owned()).collect()
    };
    scenes.map(|(name, scene)| (name.clone(), tokens(scene))).collect()
}
