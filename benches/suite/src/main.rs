//! What the stages and whole runs cost, on drives as large as those of nuScenes and Waymo.
//!
//! ```text
//! cargo run --release -p occlabel-suite -- stages  [--world W] [--rounds N]   each stage
//! cargo run --release -p occlabel-suite -- lidar   [--world W] [--rounds N]   rays on each instruction set
//! cargo run --release -p occlabel-suite -- rays    [--world W] [--rounds N]   rays of RayIoU, and the textbook's
//! cargo run --release -p occlabel-suite -- scaling [--rounds N]   with rays, voxel size, keyframes, length
//! cargo run --release -p occlabel-suite -- scene   [--world W] [--rounds N]   `label`, one thread and two
//! cargo run --release -p occlabel-suite -- log     [--world W]    where the log of a world is
//! cargo run --release -p occlabel-suite -- export DIR             a keyframe for other programs
//! cargo run --release -p occlabel-suite -- peer DIR               our own times on what was exported
//! ```
//!
//! A table goes to stderr, the same as JSON lines to stdout. Times are CPU time: harnesses such as
//! divan and criterion read the wall clock, which on a shared machine measures the neighbours. What
//! is compared is measured in turns, round by round.
//!
//! Worlds stand in `benches/worlds/`; their logs are made when first asked for, in `target/worlds/`.

mod args;
mod clock;
mod export;
mod exported;
mod keyframe;
mod keyframe_stages;
mod label_run;
mod lidar;
mod peer;
mod rays;
mod row;
mod scaling;
mod scene;
mod stages;
mod world;

use std::process::ExitCode;

use crate::args::Args;

fn main() -> ExitCode {
    let Some(args) = Args::parse(std::env::args().skip(1)) else {
        eprintln!("usage: occlabel-suite stages|lidar|rays|scaling|scene|log|export DIR|peer DIR");
        return ExitCode::from(2);
    };
    match args.bench.as_str() {
        "stages" => stages::run(&args),
        "lidar" => lidar::run(&args),
        "rays" => rays::run(&args),
        "scaling" => scaling::run(&args),
        "scene" => scene::run(&args),
        "label" => label_run::once(&args),
        "log" => println!("{}", world::log_of(&args.world, &[]).display()),
        "export" => export::run(&args),
        "peer" => peer::run(&args),
        _ => return ExitCode::from(2),
    }
    ExitCode::SUCCESS
}
