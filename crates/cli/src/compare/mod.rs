//! `compare`: how two label sets differ.

mod found;
mod verdict;

use std::collections::BTreeSet;

use occlabel_core::Fault;
use occlabel_dialects::{KeyframeKey, KeyframeLabels, Wanted};
use occlabel_evaluate::compare::{ComparedLabels, Comparer, Difference};
use rayon::prelude::*;

use crate::args::CompareArgs;
use crate::compare::found::Found;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::label_pairs::LabelPairs;
use crate::ray_origins::RayOrigins;
use crate::threads::start_threads;

/// All that labels say in the same words in every dialect.
const COMPARED: Wanted = Wanted { instances: true, flow: true, extras: false };

pub(crate) fn run(args: &CompareArgs, console: &Console) -> Result<Outcome, Stop> {
    start_threads(args.jobs);
    let pairs = open(args)?;
    let origins = match args.quick {
        true => None,
        false => RayOrigins::find(args.ray_origins.as_deref(), &args.a)?,
    };
    if origins.is_none() && !args.quick {
        console.info("no RayIoU: the manifest of the first set tells no poses; see --ray-origins");
    }
    let classes = pairs.a.classes().names();
    let spec = pairs.a.spec().clone();
    let comparer = match origins {
        Some(_) => Comparer::along_rays(spec, classes),
        None => Comparer::new(spec, classes),
    };
    let comparer = comparer.map_err(Stop::usage)?;
    let found = compare(&pairs, &comparer, origins.as_ref(), args.worst)?;
    verdict::tell(args, &pairs, &found, &comparer, console)
}

fn open(args: &CompareArgs) -> Result<LabelPairs, Stop> {
    let a = (args.a.as_path(), args.a_dialect.as_deref());
    let b = (args.b.as_path(), args.b_dialect.as_deref());
    LabelPairs::open(a, b, &args.scenes).map_err(Stop::usage)
}

/// Keyframes in parallel, each read, counted and forgotten.
fn compare(
    pairs: &LabelPairs,
    comparer: &Comparer,
    origins: Option<&RayOrigins>,
    worst: usize,
) -> Result<Found, Fault> {
    let one = |(a, b): &(KeyframeKey, KeyframeKey)| {
        let origins = origins.map_or(Ok(Vec::new()), |origins| origins.of(a))?;
        let (labels_a, labels_b) =
            (pairs.a.read_with(a, &COMPARED)?, pairs.b.read_with(b, &COMPARED)?);
        let (labels_a, labels_b) = (compared(&labels_a), compared(&labels_b));
        let difference: Difference = comparer.compare(&labels_a, &labels_b, &origins)?;
        let lacking = lacking(&labels_a, &labels_b);
        Ok(Found::of(a, difference, lacking, comparer))
    };
    let add = |a: Found, b: Found| Ok(a.and(b, worst));
    pairs.both.par_iter().map(one).try_reduce(Found::default, add)
}

fn compared(labels: &KeyframeLabels) -> ComparedLabels<'_> {
    ComparedLabels {
        semantics: &labels.semantics,
        mask_lidar: labels.mask_lidar.as_ref(),
        mask_camera: labels.mask_camera.as_ref(),
        instances: labels.instances.as_ref(),
        flow: labels.flow.as_ref(),
    }
}

/// Arrays that one of the two does not have.
fn lacking(a: &ComparedLabels, b: &ComparedLabels) -> BTreeSet<String> {
    let has = |of: &ComparedLabels| {
        [
            ("mask_lidar", of.mask_lidar.is_some()),
            ("mask_camera", of.mask_camera.is_some()),
            ("instances", of.instances.is_some()),
            ("flow", of.flow.is_some()),
        ]
    };
    let differing = has(a).into_iter().zip(has(b)).filter(|((_, in_a), (_, in_b))| in_a != in_b);
    let told = differing
        .map(|((name, in_a), _)| format!("{name} in {} only", if in_a { "A" } else { "B" }));
    told.collect()
}
