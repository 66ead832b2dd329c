//! `quality --world-truth`: label trees against the exactly known world they were made of.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::{Exposure, Fault, Keyframe, Timestamp};
use occlabel_evaluate::{COSTLY_FIGURES, KnownWorld, Limits, Scale, Tally, judge};
use occlabel_occlusion::Eye;
use occlabel_simulate::{
    Drive, TrueRays, TruthAt, TruthSettings, World, dense_ends, keyframe_truth,
};

use crate::args::QualityArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::quality::judged_tree::JudgedTree;
use crate::quality::known_worlds::KnownWorlds;
use crate::quality::verdict;
use crate::threads::start_threads;

pub(crate) fn run(args: &QualityArgs, truth: &Path, console: &Console) -> Result<Outcome, Stop> {
    let limits = asked_limits(args, console).map_err(Stop::usage)?;
    let worlds = KnownWorlds::read(truth).map_err(Stop::usage)?;
    let trees: Vec<JudgedTree> = args
        .trees
        .iter()
        .map(|folder| JudgedTree::open(folder))
        .collect::<Result<_, _>>()
        .map_err(Stop::usage)?;
    start_threads(args.jobs);
    let mut tallies = vec![Tally::default(); trees.len()];
    for scene in trees[0].manifest.scenes.keys() {
        console.info(&format!("{scene}: driving through its world"));
        let world = world_of(scene, &worlds, &trees, console).map_err(Stop::usage)?;
        judge_scene(world, &trees, args.quick, &mut tallies)?;
    }
    let judged = trees.iter().zip(tallies.iter().map(Tally::quality));
    verdict::tell(&judged.collect::<Vec<_>>(), limits.as_ref(), args.json, console)
}

/// The world that every tree's scene was driven in.
fn world_of<'w>(
    scene: &str,
    worlds: &'w KnownWorlds,
    trees: &[JudgedTree],
    console: &Console,
) -> Result<&'w World, Fault> {
    let world = worlds.of(scene)?;
    for tree in trees {
        match tree.world_hash(scene) {
            Some(hash) => worlds.check(world, hash)?,
            None => console.info(&format!(
                "{}: made where no world lay beside the log: taken on trust that it is `{scene}`",
                tree.name
            )),
        }
    }
    Ok(world)
}

/// The limits on those figures that are taken.
fn asked_limits(args: &QualityArgs, console: &Console) -> Result<Option<Limits>, Fault> {
    let Some(limits) = args.limits.as_deref().map(limits).transpose()? else { return Ok(None) };
    if !args.quick {
        return Ok(Some(limits));
    }
    let (limits, unasked) = limits.without(COSTLY_FIGURES);
    if !unasked.is_empty() {
        console.info(&format!("--quick leaves these limits unasked: {}", unasked.join(", ")));
    }
    Ok(Some(limits))
}

/// `precise`, or a file of limits.
fn limits(name: &Path) -> Result<Limits, Fault> {
    if name.as_os_str() == "precise" {
        return Ok(Limits::precise());
    }
    let fault = |found: String| {
        Fault::new("limits", name.display().to_string(), "`precise`, or a file of limits", found)
    };
    let text = std::fs::read_to_string(name).map_err(|error| fault(error.to_string()))?;
    toml::from_str(&text).map_err(|error| fault(error.message().to_owned()))
}

/// Judges a scene of every tree. Trees of one grid and one window share the truth.
fn judge_scene(
    world: &World,
    trees: &[JudgedTree],
    quick: bool,
    tallies: &mut [Tally],
) -> Result<(), Fault> {
    let drive = Drive::new(world.clone(), &trees[0].rules.taxonomy)?;
    let rays = TrueRays::cast(&drive);
    let mut at = 0;
    for alike in trees.chunk_by(same_truth) {
        let keyframes = labelled(alike, &drive)?;
        let bench = Bench { drive: &drive, rays: &rays, trees: alike, keyframes, quick };
        bench.judge(&mut tallies[at..at + alike.len()])?;
        at += alike.len();
    }
    Ok(())
}

/// The keyframes of a drive that some tree labels, by time.
fn labelled(trees: &[JudgedTree], drive: &Drive) -> Result<BTreeMap<Timestamp, Keyframe>, Fault> {
    let mut labelled = BTreeMap::new();
    for tree in trees {
        let keyframes = tree.keyframes(&drive.scene().name, drive)?;
        labelled.extend(keyframes.into_iter().map(|keyframe| (keyframe.time, keyframe)));
    }
    Ok(labelled)
}

/// Whether the same truth holds for two trees.
fn same_truth(a: &JudgedTree, b: &JudgedTree) -> bool {
    let window =
        |tree: &JudgedTree| (tree.rules.window.window_s, tree.rules.window.deformable_window_s);
    let place = |tree: &JudgedTree| (tree.rules.frame, tree.manifest.taxonomy.hash.clone());
    a.spec() == b.spec() && place(a) == place(b) && window(a) == window(b)
}

/// Trees that share a truth, and the drive that tells it.
struct Bench<'a> {
    drive: &'a Drive,
    rays: &'a TrueRays,
    trees: &'a [JudgedTree],
    /// Those that some tree labels.
    keyframes: BTreeMap<Timestamp, Keyframe>,
    quick: bool,
}

impl Bench<'_> {
    fn judge(&self, tallies: &mut [Tally]) -> Result<(), Fault> {
        let places = self.places();
        let settings = self.settings();
        let dense = match self.quick {
            true => Vec::new(),
            false => dense_ends(self.drive, &places, &settings),
        };
        for (number, at) in places.iter().enumerate() {
            let truth = keyframe_truth(self.drive, self.rays, at, &settings, dense.get(number));
            let eyes = if self.quick { Vec::new() } else { self.eyes(at) };
            for (tree, tally) in self.trees.iter().zip(&mut *tallies) {
                let known = KnownWorld {
                    scene: &self.drive.world().name,
                    truth: &truth,
                    eyes: &eyes,
                    occlusion: Some(&tree.rules.occlusion),
                };
                *tally += self.judge_keyframe(tree, at.keyframe, &known)?;
            }
        }
        Ok(())
    }

    fn judge_keyframe(
        &self,
        tree: &JudgedTree,
        keyframe: &Keyframe,
        known: &KnownWorld,
    ) -> Result<Tally, Fault> {
        let Some(token) = tree.token_at(known.scene, keyframe.time) else {
            return Ok(Tally::default());
        };
        let arrays = tree.read(known.scene, token)?;
        let scale = Scale {
            noise_sigma_m: self.drive.world().range_noise_m(),
            ..Scale::new(tree.spec().clone(), &tree.rules.taxonomy)
        };
        judge(&arrays.judged(), known, &scale).map_err(|fault| fault.record(token))
    }

    /// The keyframes, each with its grid where it truly stands.
    fn places(&self) -> Vec<TruthAt<'_>> {
        let rules = &self.trees[0].rules;
        let place = |keyframe| {
            let reference = self.drive.true_header(self.drive.scene().reference_sweep(keyframe));
            TruthAt {
                keyframe,
                spec: &rules.spec,
                world_from_grid: rules.world_from_grid(&reference),
            }
        };
        self.keyframes.values().map(place).collect()
    }

    fn settings(&self) -> TruthSettings {
        let rules = &self.trees[0].rules;
        TruthSettings {
            window_s: rules.window.window_s,
            deformable_window_s: rules.window.deformable_window_s,
            sight_depth_m: (!self.quick).then_some(rules.occlusion.depth_max_m),
        }
    }

    /// The keyframe's cameras where they truly stood.
    fn eyes(&self, at: &TruthAt) -> Vec<Eye<'_>> {
        let grid_from_world = at.world_from_grid.inverse();
        let eye = |exposure: &Exposure| Eye {
            bit: exposure.camera,
            camera: &self.drive.scene().cameras[exposure.camera].camera,
            grid_from_camera: grid_from_world * self.drive.world_from_camera(exposure),
        };
        at.keyframe.exposures.iter().map(eye).collect()
    }
}
