//! `merge-manifests`: what the shards of a run say, as one whole run would say it.
//!
//! The manifest of the whole is written last, then the shards' own files leave: a merge that was
//! interrupted is done by the same command. So is one of shards that ended after the others were merged.

mod files_of_whole;
mod reports;
mod shard_files;

use occlabel_core::Fault;
use occlabel_labels::{LabelTree, Manifest, RunFiles, Shards, pretty_json, write_file};

use crate::args::MergeArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::merge_manifests::files_of_whole::with_files_of_whole;
use crate::merge_manifests::reports::MergedReport;
use crate::merge_manifests::shard_files::remove_merged;
use crate::urls::check_url;

pub(crate) fn run(args: &MergeArgs, console: &Console) -> Result<Outcome, Stop> {
    check_url(&args.labels)?;
    let tree = LabelTree::new(&args.labels);
    let whole = RunFiles::whole(tree.clone());
    let earlier = Manifest::load(&whole.manifest())?;
    // Without that manifest, nothing was merged, whatever a report says.
    let mut report = match &earlier {
        Some(_) => MergedReport::load(&whole.report())?,
        None => MergedReport::empty(),
    };
    let shards = Shards::find(tree.root()).map_err(Stop::usage)?;
    report.expect(&shards);
    let missing: Vec<Fault> = report.missing(&tree).iter().map(not_ended).collect();
    if !missing.is_empty() && !args.without_missing {
        return Err(Stop::Usage(missing));
    }
    missing.iter().for_each(|fault| console.warning("its scenes", fault));
    let merged = merge(&tree, &whole, earlier, shards, &mut report)?;
    remove_merged(&tree, &merged)?;
    let keyframes: usize = merged.scenes.values().map(|scene| scene.keyframes.len()).sum();
    let (scenes, files) = (merged.scenes.len(), merged.files.len());
    console.result(&format!("{scenes} scenes, {keyframes} keyframes, {files} files"));
    Ok(report.outcome())
}

/// Writes the whole run's files, the manifest last; nothing if it says all that the shards do.
fn merge(
    tree: &LabelTree,
    whole: &RunFiles,
    earlier: Option<Manifest>,
    shards: Shards,
    report: &mut MergedReport,
) -> Result<Manifest, Stop> {
    let is_new = |(_, shard): &(RunFiles, Manifest)| {
        !earlier.as_ref().is_some_and(|whole| holds(whole, shard))
    };
    let new: Vec<_> = shards.ended.into_iter().filter(is_new).collect();
    if let (Some(earlier), true) = (&earlier, new.is_empty()) {
        return Ok(earlier.clone());
    }
    new.iter().try_for_each(|(files, _)| report.add(files))?;
    let manifests = earlier.into_iter().chain(new.into_iter().map(|(_, shard)| shard));
    let merged = Manifest::merge_all(manifests)?.ok_or_else(|| Stop::usage(no_shards(tree)))?;
    let merged = with_files_of_whole(tree, merged)?;
    write_file(&whole.report(), &pretty_json(&report.json()))?;
    write_file(&whole.manifest(), &merged.to_json())?;
    Ok(merged)
}

/// Whether a manifest says all that a shard's says.
fn holds(whole: &Manifest, shard: &Manifest) -> bool {
    let mut scenes = shard.scenes.iter();
    whole.config_hash == shard.config_hash
        && scenes.all(|(scene, record)| whole.scenes.get(scene) == Some(record))
}

fn not_ended(shard: &RunFiles) -> Fault {
    let place = shard.manifest().display().to_string();
    Fault::new("shards", place, "the manifests of all shards", "no such file").hint(
        "label that shard, with the command that labelled the others; or merge without it, by \
         --without-missing",
    )
}

fn no_shards(tree: &LabelTree) -> Fault {
    let place = tree.root().display().to_string();
    Fault::new("shards", place, "manifests of shards: manifest.I-of-N.json", "none")
}
