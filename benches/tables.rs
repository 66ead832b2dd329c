//! What it costs to load one scene out of tables as large as nuScenes trainval's: 850 scenes,
//! 1.2 million annotations. At most 15 CPU-seconds and 1.5 GiB are asked for.
//!
//! ```text
//! cargo bench --bench tables
//! ```

mod cost;

use occlabel_logs::{NuScenesLog, NuScenesOptions, QuaternionOrder, ReadOptions, SceneSource};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_testkit::{LogSpec, write_log};

const SCENE: &str = "scene-0426";

fn main() {
    let folder = tempfile::tempdir().expect("a folder for the tables");
    write_log(folder.path(), &LogSpec::tables()).expect("tables");
    let before = cost::cpu_s();
    let log = NuScenesLog::open(folder.path(), options()).expect("a log");
    let scene = log.load(SCENE).expect("a scene");
    println!(
        "{SCENE}: {} sweeps, {} keyframes, {} tracks",
        scene.sweeps.len(),
        scene.keyframes.len(),
        scene.tracks.len()
    );
    println!("loading cost {:.1} CPU-seconds of 15", cost::cpu_s() - before);
    println!("peak memory {} MiB of 1536, writing the tables included", cost::peak_bytes() >> 20);
}

fn options() -> NuScenesOptions {
    let text = shipped_taxonomy("occ3d-nuscenes").expect("a shipped taxonomy");
    let taxonomy = parse_taxonomy(text, "occ3d-nuscenes").expect("a taxonomy");
    NuScenesOptions {
        read: ReadOptions { scenes: Some([SCENE.to_owned()].into()), ..ReadOptions::of(taxonomy) },
        version: None,
        quaternion_order: QuaternionOrder::Wxyz,
        columns: None,
    }
}
