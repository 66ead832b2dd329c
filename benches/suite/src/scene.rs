//! A whole run of `occlabel label`: two presets, one thread and two, in turns.

use std::cell::Cell;
use std::rc::Rc;

use crate::args::Args;
use crate::label_run::label;
use crate::row::{Case, measure, print, tell};
use crate::world::{OpenLog, log_of};

const PRESETS: [&str; 2] = ["precise", "occ3d-nuscenes"];
const THREADS: [usize; 2] = [1, 2];

/// `scene [PRESET...]`: all presets if none is named.
pub(crate) fn run(args: &Args) {
    let log = log_of(&args.world, &[]);
    let opened = OpenLog::open(&args.world, &[]);
    let rays = opened.ray_count();
    let keyframes = opened.scene.keyframes.len();
    tell("scene", &format!("{}, keyframes", args.world), "keyframes", keyframes as f64);
    let presets: Vec<&str> = match args.rest.as_slice() {
        [] => PRESETS.to_vec(),
        named => named.iter().map(String::as_str).collect(),
    };
    let peaks = Rc::new(Cell::new(0));
    for preset in presets {
        let case = |threads| {
            let (log, peaks) = (log.clone(), peaks.clone());
            let name = format!("{}, {preset}, {threads} threads", args.world);
            Case::new(name, "ray", rays, move || {
                let run = label(&log, preset, threads);
                peaks.set(peaks.get().max(run.peak_bytes));
                run.cost()
            })
        };
        print(&measure("scene", THREADS.map(case).into(), args.rounds));
        let name = format!("{}, {preset}, peak memory", args.world);
        tell("scene", &name, "MiB", (peaks.take() >> 20) as f64);
    }
}
