//! How right the labels of the shipped worlds are, as `docs/findings.md` quotes it.
//!
//! ```text
//! cargo bench --bench quality -- crossing precise,occ3d-nuscenes,paper annotator.missing_boxes=0.1
//! ```
//!
//! The first argument names a world (`crossing/5`: every fifth keyframe is judged), the second the
//! presets (`precise+states.conflict=ratio` sets a
//! key of one), the rest set keys of the world. One JSON object a preset goes to stdout, the table
//! to stderr. Everything happens in memory: what is read, no reader can have spoilt.

use occlabel_core::{Keyframe, VoxelGrid};
use occlabel_evaluate::{JudgedLabels, KnownWorld, Scale, Tally, judge};
use occlabel_occlusion::Eye;
use occlabel_pipeline::{
    Autos, Config, LabelOptions, Lenses, Rules, aggregate_scene, label_keyframe, parse_taxonomy,
    preset, shipped_taxonomy,
};
use occlabel_simulate::{
    Drive, TrueRays, TruthAt, TruthSettings, World, dense_ends, keyframe_truth, shipped_world,
    world_text_with,
};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let world = args.first().map_or("street", String::as_str);
    let (world, every) = world.split_once('/').unwrap_or((world, "1"));
    let every: usize = every.parse().expect("every how many-th keyframe");
    let presets = args.get(1).map_or("precise", String::as_str);
    let drive = drive(world, args.get(2..).unwrap_or_default());
    let rays = TrueRays::cast(&drive);
    for preset in presets.split(',') {
        let quality = label_and_judge(&drive, &rays, &rules(&drive, preset), every).quality();
        eprintln!("{world}, {preset}\n{}", quality.table());
        let judged = serde_json::json!({ "world": world, "preset": preset, "quality": quality });
        println!("{judged}");
    }
}

fn drive(name: &str, sets: &[String]) -> Drive {
    let text = shipped_world(name).expect("a shipped world");
    let text = world_text_with(text, sets).expect("keys of a world");
    let world = World::parse(&text, name).expect("a world");
    let taxonomy = shipped_taxonomy(&world.taxonomy).expect("a shipped taxonomy");
    let taxonomy = parse_taxonomy(taxonomy, &world.taxonomy).expect("a taxonomy");
    Drive::new(world, &taxonomy).expect("a drive")
}

/// The rules of `preset` or `preset+table.key=value+...`.
fn rules(drive: &Drive, preset_and_keys: &str) -> Rules {
    let mut words = preset_and_keys.split('+').map(String::from);
    let name = words.next().expect("a preset's name");
    let text = preset(&name).expect("a shipped preset");
    let sets: Vec<String> = words.collect();
    let mut config = Config::from_layers(&name, text, None, &sets).expect("keys of a preset");
    let taxonomy = &drive.world().taxonomy;
    let ego = drive.world().ego.body.as_ref().map(|body| (body.min_m, body.max_m));
    let autos =
        Autos { ego_box_m: ego, taxonomy: taxonomy.clone(), reference_lidar: "LIDAR_TOP".into() };
    let text = shipped_taxonomy(taxonomy).expect("a shipped taxonomy");
    let taxonomy = parse_taxonomy(text, taxonomy).expect("a taxonomy");
    config.resolve(&autos, &taxonomy);
    Rules::new(&config, taxonomy.into()).expect("rules")
}

fn label_and_judge(drive: &Drive, rays: &TrueRays, rules: &Rules, every: usize) -> Tally {
    let scene = drive.scene();
    let read = |header: &_| {
        let sweep = drive.sweep_number(header).expect("a sweep of the drive");
        Ok::<_, std::convert::Infallible>(Some(drive.points(sweep)))
    };
    let Ok(aggregated) = aggregate_scene(scene, rules, read, |_| {});
    let frames: Vec<_> = places(drive, rules).into_iter().step_by(every).collect();
    let settings = TruthSettings {
        window_s: rules.window.window_s,
        deformable_window_s: rules.window.deformable_window_s,
        sight_depth_m: Some(rules.occlusion.depth_max_m),
    };
    let dense = dense_ends(drive, &frames, &settings);
    let one = |(at, dense): (&TruthAt, VoxelGrid<u32>)| {
        let truth = keyframe_truth(drive, rays, at, &settings, Some(&dense));
        let labels = label_keyframe(
            scene,
            &aggregated,
            &Lenses::default(),
            at.keyframe,
            rules,
            &LabelOptions::with_evidence(2),
            |_| {},
        )
        .labels;
        let judged = JudgedLabels {
            semantics: &labels.semantics,
            mask_lidar: &labels.mask_lidar,
            mask_camera: &labels.mask_camera,
            flow: Some(&labels.evidence().flow),
        };
        let eyes = eyes(drive, at);
        let known = KnownWorld {
            scene: &scene.name,
            truth: &truth,
            eyes: &eyes,
            occlusion: Some(&rules.occlusion),
        };
        judge(&judged, &known, &scale(drive, rules)).expect("one grid")
    };
    frames.iter().zip(dense).map(one).sum()
}

/// The keyframes, each with its grid where it truly stands.
fn places<'a>(drive: &'a Drive, rules: &'a Rules) -> Vec<TruthAt<'a>> {
    let place = |keyframe: &'a Keyframe| {
        let reference = drive.scene().reference_sweep(keyframe);
        let true_sweep = drive.true_header(reference);
        let world_from_grid = rules.world_from_grid(&true_sweep);
        TruthAt { keyframe, spec: &rules.spec, world_from_grid }
    };
    drive.scene().keyframes.iter().map(place).collect()
}

/// The keyframe's cameras where they truly stood.
fn eyes<'a>(drive: &'a Drive, at: &TruthAt) -> Vec<Eye<'a>> {
    let eye = |exposure: &occlabel_core::Exposure| Eye {
        bit: exposure.camera,
        camera: &drive.scene().cameras[exposure.camera].camera,
        grid_from_camera: at.world_from_grid.inverse() * drive.world_from_camera(exposure),
    };
    at.keyframe.exposures.iter().map(eye).collect()
}

fn scale(drive: &Drive, rules: &Rules) -> Scale {
    let noise_sigma_m = drive.world().range_noise_m();
    Scale { noise_sigma_m, ..Scale::new(rules.spec.clone(), &rules.taxonomy) }
}
