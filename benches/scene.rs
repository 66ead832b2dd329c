//! What it costs to label a scene as large as nuScenes': 40 keyframes, 400 sweeps of 34 000 points,
//! preset `precise`. At most 180 CPU-seconds and 4 GiB are asked for.
//!
//! ```text
//! cargo bench --bench scene
//! ```

mod cost;

use occlabel_testkit::{LogSpec, write_log};

fn main() {
    let folder = tempfile::tempdir().expect("a folder for the log");
    let (log, labels) = (folder.path().join("log"), folder.path().join("labels"));
    write_log(&log, &LogSpec::full()).expect("a log");
    let before = cost::cpu_s();
    let (log, labels) = (log.display().to_string(), labels.display().to_string());
    let line = ["occlabel", "label", "--format", "nuscenes", "--input", &log, "--output", &labels];
    assert!(
        occlabel_cli::run(line) == std::process::ExitCode::SUCCESS,
        "the scene was not labelled"
    );
    println!("labelling cost {:.1} CPU-seconds of 180", cost::cpu_s() - before);
    println!("peak memory {} MiB of 4096", cost::peak_bytes() >> 20);
}
