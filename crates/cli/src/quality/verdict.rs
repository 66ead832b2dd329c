//! What came of judging, told.

use occlabel_core::Fault;
use occlabel_evaluate::{Limits, Quality};
use serde_json::{Value, json};

use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::quality::judged_tree::JudgedTree;

/// Prints each tree's figures; fails if one does not keep the limits.
pub(crate) fn tell(
    judged: &[(&JudgedTree, Quality)],
    limits: Option<&Limits>,
    as_json: bool,
    console: &Console,
) -> Result<Outcome, Stop> {
    if as_json {
        let trees: Vec<Value> = judged.iter().map(json_of).collect();
        console.result(&json!({ "trees": trees }).to_string());
    } else {
        judged.iter().for_each(|one| table_of(one, console));
    }
    let misses: Vec<Fault> = judged.iter().flat_map(|one| misses(one, limits)).collect();
    if misses.is_empty() { Ok(Outcome::Complete) } else { Err(Stop::Failed(misses)) }
}

fn json_of((tree, quality): &(&JudgedTree, Quality)) -> Value {
    json!({ "tree": tree.name, "preset": tree.manifest.preset, "quality": quality })
}

fn table_of((tree, quality): &(&JudgedTree, Quality), console: &Console) {
    let preset = tree.manifest.preset.as_deref().unwrap_or("a configuration file");
    console.result(&format!("{} ({preset})", tree.name));
    console.result(&quality.table());
}

fn misses((tree, quality): &(&JudgedTree, Quality), limits: Option<&Limits>) -> Vec<Fault> {
    let missed = limits.map_or(Vec::new(), |limits| limits.misses(quality));
    let fault = |miss: occlabel_evaluate::Miss| {
        let found = miss.found.map_or("nothing to ask".into(), |found| format!("{found:.6}"));
        Fault::new("limit", &tree.name, miss.expected, found).record(miss.figure)
    };
    missed.into_iter().map(fault).collect()
}
