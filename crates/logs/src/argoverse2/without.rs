//! What a program without the feature says.

use std::path::Path;

use occlabel_core::{Fault, Scene, SweepHeader};

use super::format_defaults;
use crate::{ReadOptions, ReaderDefaults, SceneSource, SweepPoints};

/// A log of Argoverse 2, which this program cannot read.
#[derive(Debug)]
pub enum Argoverse2Log {}

impl Argoverse2Log {
    /// Opens no log.
    ///
    /// # Errors
    /// Always.
    pub fn open(root: &Path, _: ReadOptions) -> Result<Self, Fault> {
        let expected = "a program built with the cargo feature `av2`";
        Err(Fault::new("av2", root.display().to_string(), expected, "one without it"))
    }

    /// What the format itself says where the configuration says `"auto"`.
    pub fn format_defaults() -> ReaderDefaults {
        format_defaults()
    }
}

impl SceneSource for Argoverse2Log {
    fn scene_names(&self) -> Vec<String> {
        match *self {}
    }

    fn tables(&self) -> Vec<String> {
        match *self {}
    }

    fn sweep_files(&self, _: &SweepHeader) -> Vec<String> {
        match *self {}
    }

    fn load(&self, _: &str) -> Result<Scene, Fault> {
        match *self {}
    }

    fn scene_points(&self, _: &Scene) -> u64 {
        match *self {}
    }

    fn read_sweep(&self, _: &SweepHeader) -> Result<SweepPoints, Fault> {
        match *self {}
    }

    fn defaults(&self) -> ReaderDefaults {
        match *self {}
    }
}
