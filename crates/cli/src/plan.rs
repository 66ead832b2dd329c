//! `plan`: a log's scenes as work items, a JSON line each: whoever hands them out needs no more.

use serde_json::{Value, json};

use crate::args::PlanArgs;
use crate::console::{Console, fault_json};
use crate::exit::{Outcome, Stop};
use crate::interrupt::Interrupt;
use crate::label::findings::Findings;
use crate::label::job::Job;
use crate::label::planned_scene::{PlannedScene, Refused};

pub(crate) fn run(args: &PlanArgs, console: &Console) -> Result<Outcome, Stop> {
    let interrupt = Interrupt::listen();
    let job = Job::open(&args.work, console)?;
    let mut findings = Findings::default();
    let names = job.opened.source.scene_names();
    for (index, name) in names.iter().enumerate() {
        if interrupt.is_raised() {
            return Ok(Outcome::Interrupted);
        }
        let mut tokens = args.work.keyframes.iter().map(String::as_str).collect();
        let mut line = match PlannedScene::plan(&job, name, &mut tokens, &mut findings) {
            Ok(None) => continue,
            Ok(Some(scene)) => work(&scene),
            Err(refused) => trouble(console, name, refused, &mut findings),
        };
        line["scene"] = json!(name);
        line["shard"] = json!(format!("{index}/{}", names.len()));
        console.result(&line.to_string());
    }
    Ok(findings.outcome())
}

/// What a scene will cost.
fn work(scene: &PlannedScene) -> Value {
    let cost = scene.cost();
    json!({
        "keyframes": scene.wanted.len(),
        "sweeps": scene.sweeps,
        "points": scene.points,
        "rays": scene.rays(),
        "bytes": scene.bytes(),
        "cpu_seconds": cost.cpu_seconds,
        "memory_bytes": scene.memory_bytes,
        "expected_memory_bytes": cost.memory_bytes.round() as u64,
        "output_bytes": cost.output_bytes.round() as u64,
        "work": scene.work,
    })
}

/// A scene that cannot be labelled costs nothing, and says why.
fn trouble(console: &Console, name: &str, refused: Refused, findings: &mut Findings) -> Value {
    let faults = match refused {
        Refused::Configuration(fault) => vec![fault],
        Refused::Broken(faults) => faults,
    };
    faults.iter().for_each(|fault| findings.lose(console, name, fault));
    let mut line = json!({ "errors": faults.iter().map(fault_json).collect::<Vec<_>>() });
    let of_no_work =
        ["keyframes", "sweeps", "points", "rays", "bytes", "memory_bytes", "output_bytes"];
    for key in of_no_work.into_iter().chain(["expected_memory_bytes"]) {
        line[key] = json!(0);
    }
    line["cpu_seconds"] = json!(0.0);
    line
}
