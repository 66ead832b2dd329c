//! Where a run keeps its records in the tree.

use std::collections::BTreeSet;
use std::io::{self, ErrorKind};
use std::path::PathBuf;

use occlabel_core::Fault;
use occlabel_disk as disk;

use crate::LabelTree;
use crate::atomic::refuse_symlink;
use crate::files::read_fault;

/// A run's own files at the top of a tree. Shards that run side by side have theirs each:
/// `manifest.0-of-4.json`, `run.0-of-4.json` and so on.
#[derive(Clone, Debug)]
pub struct RunFiles {
    tree: LabelTree,
    shard: Option<(usize, usize)>,
}

impl RunFiles {
    /// The files of a run over all of a tree.
    pub fn whole(tree: LabelTree) -> Self {
        Self { tree, shard: None }
    }

    /// The files of shard `index` of `count`, from 0.
    pub fn shard(tree: LabelTree, index: usize, count: usize) -> Self {
        Self { tree, shard: Some((index, count)) }
    }

    /// The tree they stand in.
    pub fn tree(&self) -> &LabelTree {
        &self.tree
    }

    /// Of which shard they are, as `17-of-60`; none of a run that is undivided.
    pub fn shard_name(&self) -> Option<String> {
        self.shard.map(|(index, count)| format!("{index}-of-{count}"))
    }

    /// How many shards there are.
    pub(crate) fn count(&self) -> usize {
        self.shard.map_or(1, |(_, count)| count)
    }

    /// Which shard of how many it is, if it is one.
    pub fn as_shard(&self) -> Option<(usize, usize)> {
        self.shard
    }

    /// Whether it is a part of a larger run.
    pub(crate) fn is_of_shard(&self) -> bool {
        self.shard.is_some()
    }

    /// `manifest.json`: the run is finished.
    pub fn manifest(&self) -> PathBuf {
        self.named("manifest", "json")
    }

    /// `report.json`: how the run went.
    pub fn report(&self) -> PathBuf {
        self.named("report", "json")
    }

    /// `run.json`: what the run is, while it is not finished.
    pub fn run(&self) -> PathBuf {
        self.named("run", "json")
    }

    /// `journal.jsonl`: how far the run is.
    pub fn journal(&self) -> PathBuf {
        self.named("journal", "jsonl")
    }

    /// `.run.lock`: which process runs it.
    pub(crate) fn lock(&self) -> PathBuf {
        self.named(".run", "lock")
    }

    /// Refuses records that are symbolic links: they could lead out of the tree.
    ///
    /// # Errors
    /// If one is.
    pub fn refuse_links(&self) -> Result<(), Fault> {
        [self.manifest(), self.report(), self.run(), self.journal()]
            .iter()
            .try_for_each(|path| refuse_symlink(path))
    }

    fn named(&self, stem: &str, ending: &str) -> PathBuf {
        self.tree.root().join(self.name(stem, ending))
    }

    pub(crate) fn name(&self, stem: &str, ending: &str) -> String {
        match self.shard_name() {
            None => format!("{stem}.{ending}"),
            Some(shard) => format!("{stem}.{shard}.{ending}"),
        }
    }
}

/// The shards of which there are such files, `<stem>.I-of-N.json`, at the top of a tree: I and N.
pub(crate) fn shards_in(tree: &LabelTree, stem: &str) -> Result<BTreeSet<(usize, usize)>, Fault> {
    let entries = match disk::list(tree.root()) {
        Err(error) if is_no_folder(&error) => Vec::new(),
        entries => entries.map_err(|error| read_fault(tree.root(), &error))?,
    };
    let names = entries.iter().filter_map(|entry| entry.file_name().into_string().ok());
    Ok(names.filter_map(|name| shard_of(&name, stem)).collect())
}

/// 17 and 60 of `<stem>.17-of-60.json`.
fn shard_of(name: &str, stem: &str) -> Option<(usize, usize)> {
    let name = name.strip_prefix(stem)?.strip_prefix('.')?;
    let (index, count) = name.strip_suffix(".json")?.split_once("-of-")?;
    let (index, count) = (index.parse().ok()?, count.parse().ok()?);
    (index < count).then_some((index, count))
}

fn is_no_folder(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// Whether a path of a tree is that of a file which a run, or a shard of one, keeps for itself.
pub(crate) fn is_of_run(path: &str) -> bool {
    const OF_WHOLE: [&str; 5] =
        ["manifest.json", "report.json", "run.json", "journal.jsonl", ".run.lock"];
    let is_lock = path.starts_with("gts/") && path.ends_with("/.lock");
    is_lock || OF_WHOLE.contains(&name_of_whole(path).as_deref().unwrap_or(path))
}

/// The path of the whole run's file in place of a shard's, which is `NAME.I-of-N.ENDING`; none if the path
/// is not that of a shard's file.
pub fn name_of_whole(path: &str) -> Option<String> {
    let is_shard = |part: &str| {
        let numbers = part.split_once("-of-");
        numbers.is_some_and(|(i, n)| i.parse::<usize>().is_ok() && n.parse::<usize>().is_ok())
    };
    let (rest, ending) = path.rsplit_once('.')?;
    let (stem, shard) = rest.rsplit_once('.')?;
    is_shard(shard).then(|| format!("{stem}.{ending}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_have_their_own_files() {
        let tree = LabelTree::new("out");
        let names = |files: RunFiles| {
            [files.manifest(), files.report(), files.run(), files.journal()]
                .map(|path| path.strip_prefix("out").unwrap().display().to_string())
        };
        let whole = ["manifest.json", "report.json", "run.json", "journal.jsonl"];
        assert_eq!(names(RunFiles::whole(tree.clone())), whole);
        assert_eq!(names(RunFiles::shard(tree, 0, 4))[0], "manifest.0-of-4.json");
    }
}
