//! `verify`: a label tree against its manifest.

mod reopened;
mod verdict;

use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::{
    Beside, FileRecord, LabelTree, Manifest, RunFiles, unlisted_files, verify_file, verify_manifest,
};
use rayon::prelude::*;

use crate::args::VerifyArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::threads::start_threads;
use crate::urls::check_url;
use crate::verify::reopened::reopened;
use crate::verify::verdict::{Defect, Verdict};

/// What makes a file beside the labels again.
const MADE_BY_POLARIZATION: &str = "`polarization` with the same flags makes it again";

pub(crate) fn run(args: &VerifyArgs, console: &Console) -> Result<Outcome, Stop> {
    start_threads(args.jobs);
    check_url(&args.labels)?;
    let manifest = load(&args.labels)?;
    let tree = LabelTree::new(&args.labels);
    let verdict = Verdict::new(&manifest, defects(&tree, &manifest)?);
    verdict.tell(args, console)
}

fn load(folder: &Path) -> Result<Manifest, Stop> {
    let absent = || {
        let place = folder.join("manifest.json").display().to_string();
        Fault::new("manifest", place, "the manifest of a finished run", "none")
            .hint("an interrupted run goes on when its command is given again")
    };
    if !disk::is_dir(folder) {
        let place = folder.display().to_string();
        return Err(Stop::usage(Fault::new("labels", place, "the folder of a label tree", "none")));
    }
    RunFiles::whole(LabelTree::new(folder)).refuse_links()?;
    let manifest = Manifest::load_tree(folder)?;
    manifest.ok_or_else(|| Stop::usage(absent()))
}

/// All that is wrong: the manifest's contradictions, then files in order of their paths, then those beside
/// the labels, then what is not listed. What is whole is opened as well.
fn defects(tree: &LabelTree, manifest: &Manifest) -> Result<Vec<Defect>, Fault> {
    let of_tree = |fault| Defect { fault, keyframe: None };
    let mut defects: Vec<Defect> = verify_manifest(manifest).into_iter().map(of_tree).collect();
    let check = |record: &FileRecord| {
        let fault = verify_file(tree, record).err()?;
        Some(Defect::of_file(record, fault))
    };
    defects.par_extend(manifest.files.par_iter().filter_map(check));
    if defects.is_empty() {
        defects.extend(reopened(tree, manifest)?);
    }
    let beside = Beside::load(tree)?;
    let faults = beside.files.par_iter().filter_map(|record| verify_file(tree, record).err());
    defects.par_extend(faults.map(|fault| of_tree(fault.hint(MADE_BY_POLARIZATION))));
    let (mut extra, known) = (unlisted_files(tree, manifest)?, beside.paths());
    extra.retain(|path| !known.contains(path.as_str()));
    defects.extend(extra.iter().map(|path| of_tree(not_listed(path))));
    Ok(defects)
}

fn not_listed(path: &str) -> Fault {
    Fault::new("file-extra", path, "a file that the manifest lists", "one that it does not")
}
