//! How fast logs are read, next to reading their bytes and doing nothing with them: opening a log,
//! loading its scenes, decoding all their sweeps.
//!
//! ```text
//! cargo bench --bench reading                    a simulated crossing in each format that is written
//! cargo bench --bench reading -- FORMAT DIR      a log of your own
//! ```
//!
//! One thread; files were just written or read once before, so that disks do not count. Bytes are
//! those of the scenes' files, packed as they are.
//!
//! One run in release, 80 sweeps of a simulated crossing (2.7 million points); labelling takes some
//! 0.2 million points a second:
//!
//! ```text
//! format             MB   plain MB/s   read MB/s   ratio   Mpoints/s
//! nuscenes         54.7         9319        3073   0.330      152.27
//! mcap             38.3         2142         353   0.165       24.97
//! semantickitti    44.4        11149        4076   0.366      248.40
//! waymo (v1)       13.4        13426         122   0.009       24.64
//! ```

use std::collections::BTreeSet;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use occlabel_core::{ClassId, McapSettings};
use occlabel_logs::{
    Argoverse2Log, CodaLog, Kitti360Log, McapLog, McapOptions, NuScenesLog, NuScenesOptions,
    QuaternionOrder, ReadOptions, SceneSource, SemanticKittiLog, TimeSource, WaymoLog,
};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};

/// Formats that `occlabel simulate` writes.
const WRITTEN: &[&str] = &[
    "nuscenes",
    "mcap",
    "semantickitti",
    "coda",
    "waymo",
    #[cfg(feature = "waymo-v2")]
    "waymo-v2",
];
/// Of a crossing, so many seconds: 80 sweeps of 32 beams.
const SHORTER: [&str; 4] = ["--set", "duration_s=4", "--images", "none"];
/// The fastest of so many tries counts.
const TRIES: usize = 5;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let rows = match args.as_slice() {
        [format, root] => vec![measure(format, Path::new(root))],
        _ => WRITTEN.iter().map(|format| simulated(format)).collect(),
    };
    println!("format             MB    points   plain MB/s   read MB/s   ratio   Mpoints/s");
    rows.iter().for_each(|row| println!("{row}"));
}

fn simulated(format: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder for the log");
    let log = folder.path().join("log");
    let line = ["occlabel", "simulate", "--quiet", "--world", "crossing", "--format", format];
    let output = ["--output", log.to_str().expect("UTF-8")];
    let line = [&line[..], &output, &SHORTER].concat();
    assert!(occlabel_cli::run(line) == std::process::ExitCode::SUCCESS, "no log was written");
    measure(format, &log)
}

/// A row of the table.
fn measure(format: &str, root: &Path) -> String {
    let (points, files) = read(format, root);
    let megabytes = plain(root, &files) as f64 / 1e6;
    let plain_s = fastest_s(|| {
        black_box(plain(root, &files));
    });
    let read_s = fastest_s(|| drop(black_box(read(format, root))));
    format!(
        "{format:<14} {megabytes:>7.1} {points:>9} {:>12.0} {:>11.0} {:>7.3} {:>11.2}",
        megabytes / plain_s,
        megabytes / read_s,
        plain_s / read_s,
        points as f64 / 1e6 / read_s
    )
}

fn fastest_s(work: impl Fn()) -> f64 {
    let once = |_| {
        let begun = Instant::now();
        work();
        begun.elapsed().as_secs_f64()
    };
    (0..TRIES).map(once).fold(f64::INFINITY, f64::min)
}

/// Reads all files whole, one after the other; how many bytes they have.
fn plain(root: &Path, files: &BTreeSet<String>) -> u64 {
    files
        .iter()
        .map(|file| black_box(fs::read(root.join(file)).expect("a file")).len() as u64)
        .sum()
}

/// Reads a log to the last point: how many there are, and all files that it took.
fn read(format: &str, root: &Path) -> (usize, BTreeSet<String>) {
    let source = open(format, root);
    let mut files: BTreeSet<String> = source.tables().into_iter().collect();
    let mut points = 0;
    for name in source.scene_names() {
        for sweep in source.load(&name).expect("a scene").sweeps {
            points += black_box(source.read_sweep(&sweep).expect("a sweep")).cloud.len();
            files.extend(source.sweep_files(&sweep));
        }
    }
    (points, files)
}

fn open(format: &str, root: &Path) -> Box<dyn SceneSource> {
    match format {
        "nuscenes" => {
            let options = NuScenesOptions {
                read: options("occ3d-nuscenes"),
                version: None,
                quaternion_order: QuaternionOrder::Wxyz,
                columns: None,
            };
            Box::new(NuScenesLog::open(root, options).expect("a log"))
        }
        "mcap" => {
            let options = McapOptions {
                read: options("occ3d-nuscenes"),
                settings: McapSettings::default(),
                time_source: TimeSource::Header,
                recover: false,
            };
            Box::new(McapLog::open(root, options).expect("a log"))
        }
        "semantickitti" if Kitti360Log::is_log(root) => {
            Box::new(Kitti360Log::open(root, options(format)).expect("a log"))
        }
        "semantickitti" => Box::new(SemanticKittiLog::open(root, options(format)).expect("a log")),
        "waymo" | "waymo-v2" => {
            Box::new(WaymoLog::open(root, options("occ3d-waymo")).expect("a log"))
        }
        "coda" => Box::new(CodaLog::open(root, options("coda")).expect("a log")),
        "av2" => Box::new(Argoverse2Log::open(root, options("argoverse2")).expect("a log")),
        other => panic!("no format `{other}`"),
    }
}

fn options(taxonomy: &str) -> ReadOptions {
    let text = shipped_taxonomy(taxonomy).expect("a shipped taxonomy");
    let taxonomy = parse_taxonomy(text, taxonomy).expect("a taxonomy");
    ReadOptions { unknown_as: Some(ClassId(0)), ..ReadOptions::of(taxonomy) }
}
