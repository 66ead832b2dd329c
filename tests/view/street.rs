//! A drive along a street, with images, labelled with evidence.

use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;

use tempfile::TempDir;

use crate::support::{Ended, SMALL, occlabel, text};

const WORLD: &str = include_str!("../fixtures/mcap_world.toml");

/// A log and its labels, made once for all tests.
pub(crate) struct Street {
    folder: TempDir,
    pub(crate) log: PathBuf,
    pub(crate) labels: PathBuf,
}

/// The street; its ego looks neither along x nor along y.
pub(crate) fn street() -> &'static Street {
    static STREET: OnceLock<Street> = OnceLock::new();
    STREET.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let [world, log, labels] =
            ["world.toml", "log", "labels"].map(|name| folder.path().join(name));
        fs::write(&world, WORLD.replace("y_m = -1.61 }", "y_m = -1.61, yaw_rad = 0.2 }"))
            .expect("a world");
        let line = ["simulate", "--world", text(&world), "--format", "nuscenes", "--output"];
        occlabel(&[&line[..], &[text(&log)]].concat()).exits(0);
        let line =
            ["label", "--format", "nuscenes", "--input", text(&log), "--output", text(&labels)];
        occlabel(&[&line[..], &SMALL, &["--evidence"]].concat()).exits(0);
        Street { folder, log, labels }
    })
}

impl Street {
    /// A place beside the labels.
    pub(crate) fn beside(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Views the labels; gives the place of what was made, and how it went.
    pub(crate) fn view(&self, output: &str, args: &[&str]) -> (PathBuf, Ended) {
        let output = self.beside(output);
        let line = ["view", text(&self.labels), "--output", text(&output)];
        let ended = occlabel(&[&line[..], args].concat());
        (output, ended)
    }

    /// The flags that name the log.
    pub(crate) fn with_log(&self) -> [&str; 4] {
        ["--format", "nuscenes", "--input", text(&self.log)]
    }
}
