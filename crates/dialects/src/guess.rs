//! Which dialect a folder is in, where nobody says.

use std::path::Path;

use occlabel_core::Fault;

use crate::label_set::find;
use crate::{Dialect, LabelSet, PathPattern, Wanted};

/// A dialect whose path fits files of a folder: its keyframes, or why the first does not read.
struct Candidate {
    dialect: Dialect,
    start: usize,
    /// How many folders above are called otherwise, and whether the grid is not the published one.
    doubts: (usize, bool),
    fault: Option<Fault>,
}

/// The set of the one dialect that fits best.
pub(crate) fn only_one(folder: &Path) -> Result<LabelSet, Fault> {
    let mut candidates = candidates(folder)?;
    let least = candidates.iter().filter(|it| it.fault.is_none()).map(|it| it.doubts).min();
    let Some(least) = least else { return Err(nothing_fits(folder, &candidates)) };
    candidates.retain(|it| it.fault.is_none() && it.doubts == least);
    match candidates.len() {
        1 => LabelSet::in_dialect(folder, candidates.remove(0).dialect, None),
        _ => {
            let names: Vec<_> = candidates.iter().map(|it| it.dialect.name.as_str()).collect();
            let found = format!("files that fit {}", names.join(", "));
            let fault = Fault::new("dialect", folder.display().to_string(), "one dialect", found);
            Err(fault.hint("say which with --dialect"))
        }
    }
}

fn candidates(folder: &Path) -> Result<Vec<Candidate>, Fault> {
    let mut candidates = Vec::new();
    for dialect in Dialect::all() {
        if let Some((start, found)) = find(folder, &dialect, 1)? {
            let read = LabelSet::of_found(folder, dialect.clone(), start, found).and_then(first);
            let pattern = PathPattern::new(dialect.layout.path(), "");
            let doubts = (pattern.contradictions(folder, start)?, *read.as_ref().unwrap_or(&true));
            candidates.push(Candidate { dialect, start, doubts, fault: read.err() });
        }
    }
    Ok(candidates)
}

/// Reads the first keyframe; whether its grid is not the published one.
fn first(mut set: LabelSet) -> Result<bool, Fault> {
    let published = set.spec().clone();
    set.adopt_told_spec()?;
    set.read_with(&set.keyframes()[0], &Wanted::ALL)?;
    Ok(*set.spec() != published)
}

fn nothing_fits(folder: &Path, candidates: &[Candidate]) -> Fault {
    let place = folder.display().to_string();
    // The more of a dialect's folders are there, the likelier it was meant.
    match candidates.iter().min_by_key(|it| (it.start, it.doubts)) {
        Some(Candidate { dialect, fault: Some(fault), .. }) => {
            let found = format!("files named as those of {}, but {fault}", dialect.name);
            Fault::new("dialect", place, "label files of a known dialect", found)
        }
        _ => {
            let fault = Fault::new("dialect", place, "label files of a known dialect", "none");
            fault.hint(format!("dialects: {}", Dialect::names().join(", ")))
        }
    }
}
