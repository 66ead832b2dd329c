//! A scene labelled without some of its sweeps, and asked by them.

use std::collections::BTreeSet;
use std::path::Path;

use occlabel_core::{
    AggregatedScene, ClassId, Fault, Keyframe, PointCloud, PointLabel, Scene, SweepHeader,
    Timestamp,
};
use occlabel_evaluate::held_out::{
    GroundRule, HeldOutSettings, HeldOutTally, JudgedMoment, Labels, Verdict, ask, held_out,
    nearest_keyframe, place,
};
use occlabel_logs::Inventory;
use occlabel_pipeline::{
    LabelOptions, Lenses, MaskedExposures, aggregate_painted_scene, label_keyframe, sort_scene,
    standing_at,
};

use crate::console::Console;
use crate::exit::Stop;
use crate::input::Opened;
use crate::mask_reader::MaskReader;

/// A held-out sweep farther than this from every keyframe is not asked, seconds: keyframes of
/// nuScenes are 0.5 s apart, and what moves without a box should not have gone far.
const ASKED_WITHIN_S: f64 = 0.5;

/// A return counts as in a voxel within so many standard deviations of the range noise…
const TOLERANCE_SIGMAS: f64 = 3.0;

/// …or within this share of a voxel's smallest side, whichever is more.
const TOLERANCE_VOXELS: f64 = 0.25;

/// What all scenes of a run share.
pub(crate) struct HeldOutRun<'a> {
    pub(crate) opened: &'a Opened,
    /// The log's root.
    pub(crate) root: &'a Path,
    /// Every how many-th sweep of a lidar is held out.
    pub(crate) every: usize,
    /// Standard deviation of the range noise, metres.
    pub(crate) noise_m: f64,
    pub(crate) threads: usize,
    pub(crate) console: &'a Console,
}

/// What came of a scene, or of several.
#[derive(Default)]
pub(crate) struct SceneTally {
    pub(crate) sweeps: usize,
    /// Keyframes to which a held-out sweep was near enough.
    pub(crate) keyframes: usize,
    pub(crate) tally: HeldOutTally,
}

/// A scene in two parts.
struct Divided {
    scene: Scene,
    fused: AggregatedScene<ClassId>,
    held: AggregatedScene<Option<ClassId>>,
    settings: HeldOutSettings,
}

impl HeldOutRun<'_> {
    /// Labels the scene's keyframes without the held-out sweeps, and asks these.
    pub(crate) fn ask(&self, name: &str) -> Result<SceneTally, Stop> {
        let divided = self.divide(self.load(name)?)?;
        let mut heard = SceneTally { sweeps: divided.held.background.len(), ..Default::default() };
        for (at, keyframe) in divided.scene.keyframes.iter().enumerate() {
            if (divided.held.background.iter())
                .any(|sweep| sweep.time.is_some_and(|time| self.asks(&divided, time, at)))
            {
                heard.keyframes += 1;
                heard.tally += &self.ask_keyframe(&divided, at, keyframe);
            }
        }
        Ok(heard)
    }

    fn load(&self, name: &str) -> Result<Scene, Stop> {
        let scene = self.opened.source.load(name)?;
        scene.warnings.iter().for_each(|fault| self.console.warning(name, fault));
        let refused = scene.refused.iter().map(|refusal| refusal.fault.clone());
        let missing = Inventory::take(&*self.opened.source, self.root, &scene).missing;
        let missing = missing.iter().map(|m| Fault::new("missing-file", &m.file, "a file", "none"));
        let faults: Vec<Fault> = refused.chain(missing).collect();
        if faults.is_empty() { Ok(scene) } else { Err(Stop::Failed(faults)) }
    }

    /// Reads every sweep, and keeps apart what is held out. Poses and boxes are those of the log.
    fn divide(&self, scene: Scene) -> Result<Divided, Stop> {
        let rules = &self.opened.rules;
        let is_held_out = held_out(&scene.sweeps, self.every);
        let pairs = scene.sweeps.iter().zip(&is_held_out);
        let held: BTreeSet<&str> =
            pairs.filter(|(_, held)| **held).map(|(sweep, _)| sweep.source_id.as_str()).collect();
        let is_held = |sweep: &SweepHeader| held.contains(sweep.source_id.as_str());
        let rest = without(&scene, is_held);
        rules.check(&rest).map_err(Stop::usage)?;
        let settings = self.settings(rest.has_point_labels());
        let fused = self.fuse(&scene, is_held)?;
        let read_held = |sweep: &_| if is_held(sweep) { self.read(sweep) } else { Ok(None) };
        let held = sort_scene(&scene, rules, read_held)?;
        Ok(Divided { scene, fused, held, settings })
    }

    /// The sweeps that are not held out, painted where images have masks.
    fn fuse(
        &self,
        scene: &Scene,
        is_held: impl Fn(&SweepHeader) -> bool + Sync,
    ) -> Result<AggregatedScene<ClassId>, Fault> {
        let masks = MaskReader::new(self.opened.masks.as_ref(), scene)?;
        let masked = masks.as_ref().map_or_else(MaskedExposures::none, MaskReader::exposures);
        let read = |sweep: &_| if is_held(sweep) { Ok(None) } else { self.read(sweep) };
        aggregate_painted_scene(scene, &self.opened.rules, read, &masked, |_| {})
    }

    fn read(&self, sweep: &SweepHeader) -> Result<Option<PointCloud<PointLabel>>, Fault> {
        self.opened.source.read_sweep(sweep).map(|points| Some(points.cloud))
    }

    fn settings(&self, has_point_labels: bool) -> HeldOutSettings {
        let flat = self.opened.rules.taxonomy.flat;
        let ground = if has_point_labels { GroundRule::Classes(flat) } else { GroundRule::Height };
        let quarter_m = self.opened.rules.spec.size_m().min() * TOLERANCE_VOXELS;
        HeldOutSettings { ground, tolerance_m: quarter_m.max(TOLERANCE_SIGMAS * self.noise_m) }
    }

    /// Whether a held-out sweep of that time is asked about the keyframe at a place of the list.
    fn asks(&self, divided: &Divided, time: Timestamp, at: usize) -> bool {
        let times: Vec<_> = divided.scene.keyframes.iter().map(|keyframe| keyframe.time).collect();
        let within_s = self.opened.rules.window.window_s.min(ASKED_WITHIN_S);
        nearest_keyframe(&times, time, within_s) == Some(at)
    }

    fn ask_keyframe(&self, divided: &Divided, at: usize, keyframe: &Keyframe) -> HeldOutTally {
        let (rules, scene) = (&self.opened.rules, &divided.scene);
        // What cameras see is not asked.
        let unseen = Keyframe { exposures: Vec::new(), ..keyframe.clone() };
        let labels = label_keyframe(
            scene,
            &divided.fused,
            &Lenses::default(),
            &unseen,
            rules,
            &LabelOptions::labels(self.threads),
            |_| {},
        )
        .labels;
        let grid_from_world = rules.world_from_grid(scene.reference_sweep(keyframe)).inverse();
        let standing = standing_at(scene, keyframe.time, &grid_from_world, rules);
        let moment = JudgedMoment {
            time: keyframe.time,
            grid_from_world,
            standing: &standing,
            growth: rules.window.growth,
            same_time_s: rules.rays().settings.same_time_s,
            deformable_window_s: rules.window.deformable_window_s,
            deformable: rules.window.deformable,
        };
        let rays = place(&divided.held, &moment, |time| self.asks(divided, time, at));
        let labels = Labels {
            spec: &rules.spec,
            verdicts: &Verdict::of_labels(&labels),
            standing: Some(&Labels::standing_voxels(&rules.spec, &standing)),
        };
        ask(&labels, &rays, &divided.settings)
    }
}

/// The scene with the sweeps that are fused alone.
fn without(scene: &Scene, is_held: impl Fn(&SweepHeader) -> bool) -> Scene {
    let sweeps = scene.sweeps.iter().filter(|sweep| !is_held(sweep)).cloned().collect();
    Scene { name: scene.name.clone(), sweeps, ..Scene::default() }
}
