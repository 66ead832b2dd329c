//! `quality --painted`: what masks give labelled points, beside their labels.

use std::collections::BTreeMap;

use occlabel_core::{AggregatedScene, ClassId, Fault, Scene, SweepHeader, printable};
use occlabel_evaluate::painted::{PaintedTally, painted_table};
use occlabel_pipeline::{MaskedExposures, paint_scene, sort_scene};
use serde_json::json;

use crate::args::{LogArgs, QualityArgs};
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::input::{Opened, open};
use crate::mask_reader::MaskReader;
use crate::threads::start_threads;

pub(crate) fn run(args: &QualityArgs, log: &LogArgs, console: &Console) -> Result<Outcome, Stop> {
    start_threads(args.jobs);
    let opened = open(log, &args.config)?;
    if opened.masks.is_none() {
        return Err(Stop::usage(no_masks()));
    }
    let names = &opened.rules.taxonomy.names;
    let (mut scenes, mut total) = (BTreeMap::new(), PaintedTally::default());
    for name in opened.source.scene_names() {
        let tally = paint_labelled(&opened, &opened.source.load(&name)?)?;
        total += &tally;
        scenes.insert(printable(&name), tally.figures(names));
    }
    let total = total.figures(names);
    console.result(&match args.json {
        true => json!({"config": opened.config, "scenes": scenes, "total": total}).to_string(),
        false => painted_table(&total),
    });
    Ok(Outcome::Complete)
}

fn no_masks() -> Fault {
    let fault = Fault::new("config", "paint.masks", "a folder of masks", "`none`");
    fault.hint("name one with --set paint.masks=DIR")
}

/// Paints the labelled sweeps of a scene as if nobody had labelled them, and compares.
fn paint_labelled(opened: &Opened, scene: &Scene) -> Result<PaintedTally, Fault> {
    let read = |sweep: &SweepHeader| {
        let read = || opened.source.read_sweep(sweep).map(|points| points.cloud);
        sweep.labelled.then(read).transpose()
    };
    let mut sorted = sort_scene(scene, &opened.rules, read)?;
    let labels = take_labels(&mut sorted);
    let reader = MaskReader::new(opened.masks.as_ref(), scene)?;
    let masked = reader.as_ref().map_or_else(MaskedExposures::none, MaskReader::exposures);
    let painted = paint_scene(scene, sorted, &opened.rules, &masked)?;
    let mut tally = PaintedTally::default();
    for (labels, sweep) in labels.iter().zip(&painted.background) {
        let points = labels.iter().zip(&sweep.cloud.labels);
        points.for_each(|(label, painted)| {
            label.iter().for_each(|label| tally.count(*label, *painted));
        });
    }
    Ok(tally)
}

/// The labels of each background sweep, of which none are left.
fn take_labels(sorted: &mut AggregatedScene<Option<ClassId>>) -> Vec<Vec<Option<ClassId>>> {
    let take = |labels: &mut Vec<Option<ClassId>>| {
        let none = vec![None; labels.len()];
        std::mem::replace(labels, none)
    };
    sorted.background.iter_mut().map(|sweep| take(&mut sweep.cloud.labels)).collect()
}
