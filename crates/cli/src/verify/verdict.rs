//! What `verify` says.

use std::collections::BTreeSet;

use occlabel_core::{Fault, printable};
use occlabel_labels::{FileRecord, Manifest, write_file};
use serde_json::{Value, json};

use crate::args::VerifyArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};

/// Something that is not as the manifest says.
pub(crate) struct Defect {
    pub(crate) fault: Fault,
    /// The keyframe, scene and token, that is to be labelled again.
    pub(crate) keyframe: Option<(String, String)>,
}

/// All that was found.
pub(crate) struct Verdict {
    keyframes: usize,
    files: usize,
    bytes: u64,
    defects: Vec<Defect>,
}

impl Defect {
    /// A fault of a listed file. One that tells of all keyframes is made again by any run.
    pub(crate) fn of_file(record: &FileRecord, fault: Fault) -> Self {
        let keyframe = record.keyframe().map(|(scene, token)| (scene.into(), token.into()));
        let hint = "`label` with the same flags makes it again";
        let fault = if keyframe.is_none() { fault.hint(hint) } else { fault };
        Self { fault, keyframe }
    }

    fn json(&self) -> Value {
        let (scene, token) = self.keyframe.clone().unzip();
        let fault = &self.fault;
        json!({
            "rule": fault.rule, "place": fault.place, "record": fault.record,
            "expected": fault.expected, "found": fault.found, "scene": scene, "keyframe": token,
        })
    }
}

impl Verdict {
    pub(crate) fn new(manifest: &Manifest, defects: Vec<Defect>) -> Self {
        Self {
            keyframes: manifest.scenes.values().map(|scene| scene.keyframes.len()).sum(),
            files: manifest.files.len(),
            bytes: manifest.files.iter().map(|file| file.bytes).sum(),
            defects,
        }
    }

    /// Prints it and writes the list of keyframes to label again; fails if anything is wrong.
    pub(crate) fn tell(&self, args: &VerifyArgs, console: &Console) -> Result<Outcome, Stop> {
        let redo = self.redo();
        if let Some(file) = &args.redo_list {
            write_file(
                file,
                redo.iter().map(|line| format!("{line}\n")).collect::<String>().as_bytes(),
            )?;
        }
        match args.json {
            true => console.result(&self.json(&redo).to_string()),
            false => self.lines(&redo).iter().for_each(|line| console.result(line)),
        }
        if self.defects.is_empty() { Ok(Outcome::Complete) } else { Err(Stop::Failed(Vec::new())) }
    }

    /// The keyframes to label again, `SCENE/TOKEN`, in order.
    fn redo(&self) -> BTreeSet<String> {
        let keyframes = self.defects.iter().filter_map(|defect| defect.keyframe.as_ref());
        keyframes.map(|(scene, token)| format!("{scene}/{token}")).collect()
    }

    fn json(&self, redo: &BTreeSet<String>) -> Value {
        json!({
            "keyframes": self.keyframes, "files": self.files, "bytes": self.bytes,
            "defects": self.defects.iter().map(Defect::json).collect::<Vec<_>>(),
            "redo": redo,
        })
    }

    fn lines(&self, redo: &BTreeSet<String>) -> Vec<String> {
        let whole =
            format!("{} keyframes, {} files, {} bytes", self.keyframes, self.files, self.bytes);
        if self.defects.is_empty() {
            return vec![format!("{whole}: all as the manifest says")];
        }
        let defects = self.defects.iter().map(|defect| printable(&defect.fault.to_string()));
        let [found, again] = [(self.defects.len(), "defect"), (redo.len(), "keyframe")]
            .map(|(count, what)| format!("{count} {what}{}", if count == 1 { "" } else { "s" }));
        let summary = format!("{whole}: {found}; {again} to redo");
        defects.chain([summary]).collect()
    }
}
