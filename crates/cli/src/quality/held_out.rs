//! `quality --held-out`: labels asked by sweeps that took no part in them.

use std::collections::BTreeMap;

use occlabel_core::{Fault, printable};
use occlabel_evaluate::held_out::{HeldOutFigures, HeldOutTally, table};
use serde_json::{Value, json};

use crate::args::{LogArgs, QualityArgs};
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::input::{Opened, open};
use crate::quality::held_out_scene::{HeldOutRun, SceneTally};
use crate::threads::start_threads;

pub(crate) fn run(args: &QualityArgs, console: &Console) -> Result<Outcome, Stop> {
    let (every, log) = asked_for(args).map_err(Stop::usage)?;
    let threads = start_threads(args.jobs);
    let opened = open(log, &args.config)?;
    check_rays(&opened).map_err(Stop::usage)?;
    let noise_m = args.range_noise_m;
    let run = HeldOutRun { opened: &opened, root: &log.input, every, noise_m, threads, console };
    let mut scenes = BTreeMap::new();
    for name in opened.source.scene_names() {
        let scene = run.ask(&name)?;
        console.info(&scene.line(&name));
        scenes.insert(name, scene);
    }
    let total = total(&scenes);
    if total.asked() == 0 {
        return Err(Stop::usage(nothing_asked(log, every)));
    }
    console.result(&if args.json {
        json_text(&opened, every, &scenes, &total)
    } else {
        table(&HeldOutFigures::of(&total.tally))
    });
    Ok(Outcome::Complete)
}

/// Every how many-th sweep of which log: the command line makes sure of both.
fn asked_for(args: &QualityArgs) -> Result<(usize, &LogArgs), Fault> {
    match (args.held_out, &args.log) {
        (Some(every), Some(log)) => Ok((usize::from(every), log)),
        _ => {
            let expected = "--held-out N --format F --input DIR";
            Err(Fault::new("usage", "command line", expected, "less"))
        }
    }
}

/// Held-out sweeps are asked along their rays: labels that cameras alone make have nothing to answer.
fn check_rays(opened: &Opened) -> Result<(), Fault> {
    if opened.rules.casts_lidar_rays() {
        return Ok(());
    }
    let expected = "\"lidar\", whose rays are held out";
    Err(Fault::new("config", "raycast.source", expected, "\"camera\""))
}

fn total(scenes: &BTreeMap<String, SceneTally>) -> SceneTally {
    let mut total = SceneTally::default();
    scenes.values().for_each(|scene| total.add(scene));
    total
}

fn nothing_asked(log: &LogArgs, every: usize) -> Fault {
    let expected = format!("scenes with keyframes and at least {every} sweeps of a lidar");
    let place = log.input.display().to_string();
    Fault::new("held-out", place, expected, "none").hint("hold out more: a smaller --held-out")
}

fn json_text(
    opened: &Opened,
    every: usize,
    scenes: &BTreeMap<String, SceneTally>,
    total: &SceneTally,
) -> String {
    let named: serde_json::Map<String, Value> =
        scenes.iter().map(|(name, scene)| (printable(name), scene.json())).collect();
    let report = json!({
        "held_out": every,
        "preset": opened.preset,
        "config": opened.config,
        "scenes": named,
        "total": total.json(),
    });
    report.to_string()
}

impl SceneTally {
    fn line(&self, name: &str) -> String {
        let (sweeps, keyframes) = (self.sweeps, self.keyframes);
        format!("{name}: {sweeps} sweeps held out, {keyframes} keyframes asked")
    }

    fn json(&self) -> Value {
        let figures = HeldOutFigures::of(&self.tally);
        let mut json = serde_json::to_value(figures).expect("figures are JSON");
        json["sweeps_held_out"] = json!(self.sweeps);
        json["keyframes_asked"] = json!(self.keyframes);
        json
    }

    fn add(&mut self, other: &Self) {
        self.sweeps += other.sweeps;
        self.keyframes += other.keyframes;
        self.tally += &other.tally;
    }

    /// How many rays found something to say.
    fn asked(&self) -> u64 {
        let HeldOutTally { labels, .. } = &self.tally;
        labels.returns() + labels.covered
    }
}
