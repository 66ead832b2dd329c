//! The worlds' logs, made when first asked for, and what is in them.

use std::path::{Path, PathBuf};

use occlabel_core::{PointCloud, PointLabel, Scene, SweepHeader, Taxonomy};
use occlabel_logs::{NuScenesLog, NuScenesOptions, QuaternionOrder, ReadOptions, SceneSource};
use occlabel_pipeline::{Autos, Config, Rules, parse_taxonomy, preset, shipped_taxonomy};
use occlabel_simulate::{Drive, Images, Output, World, world_text_with, write_nuscenes};

/// Where logs are kept, by the hash of their world.
const LOGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/worlds");
/// Where worlds stand.
const WORLDS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../worlds");
/// The taxonomy of all worlds here.
const TAXONOMY: &str = "occ3d-nuscenes";

/// A log and its only scene.
pub(crate) struct OpenLog {
    pub(crate) scene: Scene,
    source: NuScenesLog,
}

/// The folder of a world's log; it is made if it is not there. `settings` are laid over the world.
pub(crate) fn log_of(world: &str, settings: &[String]) -> PathBuf {
    let file = Path::new(WORLDS).join(format!("{world}.toml"));
    let text = std::fs::read_to_string(&file).expect("a world in benches/worlds");
    let text = world_text_with(&text, settings).expect("keys of a world");
    let hash = blake3::hash(text.as_bytes()).to_hex();
    let folder = Path::new(LOGS).join(format!("{world}-{}", &hash[..16]));
    if !folder.is_dir() {
        let cost = crate::clock::cost_of(|| make(&text, world, &folder));
        eprintln!("made {} in {:.1} CPU-seconds", folder.display(), cost.cpu_s);
    }
    folder
}

/// Under another name first, so that a log that has its name is whole.
fn make(text: &str, world: &str, folder: &Path) {
    let world = World::parse(text, world).expect("a world");
    let drive = Drive::new(world, &taxonomy()).expect("a drive");
    std::fs::create_dir_all(LOGS).expect("a folder for logs");
    let unfinished = tempfile::tempdir_in(LOGS).expect("a folder for the log");
    let output = Output::create(unfinished.path()).expect("an empty folder");
    let (_, last) =
        write_nuscenes(&[drive], &taxonomy(), Images::None, &output).expect("room for a log");
    output.finish(last).expect("a log");
    std::fs::rename(unfinished.keep(), folder).expect("a name for the log");
}

impl OpenLog {
    pub(crate) fn open(world: &str, settings: &[String]) -> Self {
        let options = NuScenesOptions {
            read: ReadOptions::of(taxonomy()),
            version: None,
            quaternion_order: QuaternionOrder::Wxyz,
            columns: None,
        };
        let source = NuScenesLog::open(&log_of(world, settings), options).expect("a log");
        let name = source.scene_names().remove(0);
        Self { scene: source.load(&name).expect("a scene"), source }
    }

    /// How many rays the scene has.
    pub(crate) fn ray_count(&self) -> u64 {
        self.source.scene_points(&self.scene)
    }

    /// The points of a sweep.
    pub(crate) fn points(&self, sweep: &SweepHeader) -> PointCloud<PointLabel> {
        self.source.read_sweep(sweep).expect("a sweep").cloud
    }

    /// The rules of a preset for this log.
    pub(crate) fn rules(&self, preset: &str) -> Rules {
        self.rules_with(preset, &[])
    }

    /// The same with keys set over it.
    pub(crate) fn rules_with(&self, name: &str, settings: &[&str]) -> Rules {
        let text = preset(name).expect("a shipped preset");
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        let mut config = Config::from_layers(name, text, None, &settings).expect("keys of presets");
        let defaults = self.source.defaults();
        let autos = Autos {
            ego_box_m: defaults.ego_box_m,
            taxonomy: TAXONOMY.into(),
            reference_lidar: defaults.reference_lidar,
        };
        config.resolve(&autos, &taxonomy());
        Rules::new(&config, taxonomy().into()).expect("rules of a shipped preset")
    }
}

fn taxonomy() -> Taxonomy {
    let text = shipped_taxonomy(TAXONOMY).expect("a shipped taxonomy");
    parse_taxonomy(text, TAXONOMY).expect("a shipped taxonomy")
}
