//! A tree holds the labels of one run: a whole one, or the shards of one.

use occlabel_core::Fault;

use crate::earlier::Earlier;
use crate::run_files::shards_in;
use crate::{RunFiles, RunRecord};

/// In what the other runs that keep records in a tree differ from the one that begins there: another
/// program, configuration or log, or other shards. A shard that ends late may follow the whole run
/// that the others became.
pub(crate) fn differences_from_others(
    files: &RunFiles,
    now: &RunRecord,
) -> Result<Vec<String>, Fault> {
    let mut shards = shards_in(files.tree(), "manifest")?;
    shards.extend(shards_in(files.tree(), "run")?);
    shards.retain(|shard| Some(*shard) != files.as_shard());
    let now_count = files.as_shard().map(|(_, count)| count);
    if let Some((_, count)) = shards.iter().find(|(_, count)| Some(*count) != now_count) {
        let now = now_count.map_or_else(|| "none".to_owned(), |count| count.to_string());
        return Ok(vec![format!("shards: {count} before, {now} now")]);
    }
    // Those that are there were compared with each other when they began.
    let one = shards.first().map(|&(at, count)| RunFiles::shard(files.tree().clone(), at, count));
    let whole = now_count.map(|_| RunFiles::whole(files.tree().clone()));
    let mut found = Vec::new();
    for other in one.into_iter().chain(whole) {
        found.extend(Earlier::load(&other)?.differences_in_kind(now));
    }
    found.sort();
    found.dedup();
    Ok(found)
}
