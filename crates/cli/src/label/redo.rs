//! Keyframes that are labelled again although an earlier run finished them.

use std::collections::BTreeSet;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;

use crate::label::plan::Plan;

/// Scenes and tokens.
pub(crate) type Redo = BTreeSet<(String, String)>;

/// The keyframes of a list, `SCENE/TOKEN` a line; none without one.
///
/// # Errors
/// If it cannot be read, or names a keyframe that the run would not label.
pub(crate) fn read(list: Option<&Path>, plan: &Plan) -> Result<Redo, Fault> {
    let Some(list) = list else { return Ok(Redo::new()) };
    let fault = |expected: &str, found: String| {
        Fault::new("redo", list.display().to_string(), expected, found)
    };
    let text = disk::read_to_string(list)
        .map_err(|error| fault("SCENE/TOKEN a line", error.to_string()))?;
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let keyframe = |line: &str| {
        let (scene, token) = line.split_once('/').unwrap_or((line, ""));
        let is_planned = plan
            .scenes
            .iter()
            .any(|planned| planned.name == scene && planned.wanted.contains(token));
        let unknown = || fault("keyframes that this command labels", format!("`{line}`"));
        is_planned.then(|| (scene.to_owned(), token.to_owned())).ok_or_else(unknown)
    };
    lines.map(keyframe).collect()
}
