//! A tiny world, driven through, measured and labelled.

use nalgebra::{Point3, Vector3};
use occlabel_core::{Fault, PointLabel, Taxonomy, Timestamp};
use occlabel_pipeline::{
    Autos, Config, LabelOptions, Lenses, Rules, aggregate_scene, label_keyframe, parse_taxonomy,
    preset, shipped_taxonomy,
};
use occlabel_simulate::{Drive, Ray, What, World};

const TINY: &str = include_str!("tiny.toml");

fn taxonomy() -> Taxonomy {
    parse_taxonomy(shipped_taxonomy("occ3d-nuscenes").unwrap(), "occ3d-nuscenes").unwrap()
}

fn world(text: &str) -> World {
    World::parse(text, "tiny.toml").unwrap_or_else(|fault| panic!("{fault}"))
}

fn drive(text: &str) -> Drive {
    Drive::new(world(text), &taxonomy()).unwrap_or_else(|fault| panic!("{fault}"))
}

fn mover(drive: &Drive, name: &str) -> usize {
    drive.world().movers.iter().position(|mover| mover.name == name).unwrap()
}

#[test]
fn the_drive_is_the_scene_a_reader_would_give() {
    let drive = drive(TINY);
    let scene = drive.scene();
    assert_eq!(scene.sweeps.len(), 2 * 21);
    let times: Vec<i64> = scene.keyframes.iter().map(|key| key.time.0).collect();
    assert_eq!(times, [0, 500_000_000, 1_000_000_000, 1_500_000_000, 2_000_000_000]);
    assert!(scene.keyframes.iter().all(|key| scene.sweeps[key.sweep].lidar == "LIDAR_TOP"));
    let exposure = &scene.keyframes[1].exposures[0];
    assert_eq!(exposure.time, Timestamp(510_000_000), "0.01 s + 6 / 12 Hz");
    let ids: Vec<_> = scene.tracks.iter().map(|t| (t.id.0, t.source_id.as_str())).collect();
    assert_eq!(ids, [(1, "car"), (2, "trailer"), (3, "truck"), (4, "walker")]);
    assert!(scene.tracks.iter().all(|track| track.boxes.len() == 5));
    let header = &scene.sweeps[7];
    assert_eq!(drive.sweep_number(header), Some(7));
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let drive = drive(TINY);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (0..6).map(|sweep| drive.points(sweep)).collect::<Vec<_>>())
    };
    let alone = on(1);
    assert!(alone.iter().map(|cloud| cloud.len()).sum::<usize>() > 8_000);
    assert!(alone == on(2) && alone == on(8));
}

#[test]
fn the_seed_moves_noise_and_nothing_else() {
    let (a, b) = (drive(TINY), drive(&TINY.replace("seed = 7", "seed = 8")));
    let lidar = |drive: &Drive, sweep: usize| drive.scene().sweeps[sweep].lidar.clone();
    for sweep in 0..4 {
        let is_noisy = lidar(&a, sweep) == "ROSETTE";
        assert_eq!(a.points(sweep) != b.points(sweep), is_noisy, "{}", lidar(&a, sweep));
    }
}

#[test]
fn noise_and_dropout_are_as_large_as_told() {
    let drive = drive(TINY);
    let lidar = &drive.world().lidars[1];
    let returns: Vec<_> = (0..20).flat_map(|k| lidar.sweep(drive.world(), k)).collect();
    let all: usize = (0..20).map(|k| lidar.true_sweep(drive.world(), k).len()).sum();
    let lost = 1.0 - returns.len() as f64 / all as f64;
    let squares =
        returns.iter().map(|r| libm::pow(r.position_m.coords.norm() - r.hit.distance_m, 2.0));
    let deviation_m = (squares.sum::<f64>() / returns.len() as f64).sqrt();
    assert!(returns.len() > 5_000 && (lost - 0.1).abs() < 0.02, "{lost} of {all}");
    assert!((deviation_m - 0.02).abs() < 0.001, "{deviation_m}");
}

#[test]
fn returns_of_movers_lie_in_their_boxes() {
    let drive = drive(TINY);
    let mut seen = [0; 4];
    let (lidar, world) = (&drive.world().lidars[0], drive.world());
    for found in (0..20).flat_map(|k| lidar.sweep(world, k)) {
        let What::Mover(at) = found.hit.what else { continue };
        let in_world = lidar.world_from_lidar(world, found.time) * found.position_m;
        let time_s = found.time.seconds_since(Timestamp(0));
        let boxed = world.movers[at].box_at(time_s, &world.ground);
        let p = boxed.world_from_box.inverse() * in_world;
        assert!((0..3).all(|axis| p[axis].abs() <= boxed.size_m[axis] / 2.0 + 1e-9), "{p:?} {at}");
        seen[at] += 1;
    }
    assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
}

#[test]
fn a_rolling_sweep_of_a_wall_is_straight_once_every_point_has_its_own_pose() {
    let rolling = TINY.replace("max_range_m = 60.0", "max_range_m = 60.0\nrolling = true");
    let drive = drive(&rolling);
    let (lidar, world) = (&drive.world().lidars[0], drive.world());
    let top = (0..4).find(|&at| drive.scene().sweeps[at].lidar == "LIDAR_TOP").unwrap();
    let header = &drive.scene().sweeps[top];
    let returns = drive.returns(top);
    let on_wall: Vec<bool> = returns.iter().map(|r| r.hit.what == What::Static(0)).collect();
    let cloud = drive.points(top);
    let off = |p: Point3<f64>| (p.y - 9.5).abs();
    let mut worst_m = [0.0_f64; 2];
    for at in (0..cloud.len()).filter(|&at| on_wall[at]) {
        worst_m[0] = worst_m[0].max(off(header.world_from_lidar() * cloud.positions[at]));
        worst_m[1] = worst_m[1].max(off(header.world_from_lidar() * returns[at].position_m));
    }
    assert!(on_wall.iter().filter(|on| **on).count() > 200);
    assert!(worst_m[0] < 1e-9 && worst_m[1] > 0.01, "{worst_m:?}");
    let first = lidar.world_from_lidar(world, returns[0].time);
    assert_ne!(first, lidar.world_from_lidar(world, returns.last().unwrap().time));
}

#[test]
fn casts_and_contains_agree_about_the_whole_world() {
    let world = world(TINY);
    let instant = world.at(0.8);
    let mut met = std::collections::BTreeSet::new();
    let mut count = 0;
    for k in 0..4000 {
        let angle = f64::from(k) * 2.399_963;
        let way = Vector3::new(libm::cos(angle), libm::sin(angle), -0.3 + f64::from(k % 37) * 0.01);
        let ray = Ray { origin: Point3::new(8.0, 1.0, 1.7), direction: way.normalize() };
        let Some(hit) = instant.cast(&ray, 40.0) else { continue };
        let before = (1..40).map(|at| hit.distance_m * f64::from(at) / 40.0);
        assert!(before.into_iter().all(|at| instant.contains(&ray.at(at)).is_none()), "{hit:?}");
        if let Some(what) = instant.contains(&ray.at(hit.distance_m + 1e-7)) {
            assert_eq!(what, hit.what);
            count += 1;
        }
        assert!(hit.normal.dot(&ray.direction) < 0.0, "{hit:?}");
        met.insert(hit.what);
    }
    assert!(count > 2000 && met.len() >= 6, "{count} {met:?}");
}

fn refusal(text: &str) -> Fault {
    World::parse(text, "tiny.toml").and_then(|world| Drive::new(world, &taxonomy())).unwrap_err()
}

#[test]
fn bad_world_files_are_refused_by_their_key() {
    for (from, to, key) in [
        ("seed = 7", "sead = 7", "sead"),
        ("seed = 7", "seed = \"x\"", "seed"),
        ("seed = 7", "seed = ", "the file"),
        ("duration_s = 2.05", "duration_s = nan", "duration_s"),
        ("name = \"tiny\"", "name = \"../tiny\"", "name"),
        ("until_y_m = 4.0, ", "", "ground.bands"),
        ("size_m = [4.4, 1.8, 1.5]", "size_m = [4.4, 0.0, 1.5]", "mover[0].size_m"),
        ("radius_m = 0.3", "radius_m = -0.3", "static[1].shape.cylinder.radius_m"),
        ("by = \"truck\"", "by = \"tank\"", "mover[2].towed.by"),
        ("begin_s = 0.2", "begin_s = -0.2", "mover[1].trajectory.turn.begin_s"),
        ("rate_hz = 12.0", "rate_hz = 0.0", "camera[0].rate_hz"),
        ("offset_s = 0.01", "offset_s = 2.05", "camera[0].offset_s"),
        ("dropout = 0.1", "dropout = 0.1\noffset_s = 99", "lidar[1].offset_s"),
        ("[[400.0, 0.0", "[[-400.0, 0.0", "camera[0].model"),
        ("count = 24", "count = 1", "lidar[0].pattern.spinning.beams.even.count"),
        ("azimuths = 240", "azimuths = 9000000000", "lidar[0].pattern.rays"),
        ("dropout = 0.1", "dropout = 1.1", "lidar[1].dropout"),
        ("name = \"ROSETTE\"", "name = \"LIDAR_TOP\"", "lidar[1].name"),
        ("[0.9, 0.0, 1.84]", "[0.9, 0.0, 1.4]", "ego.body"),
        ("period_s = 1.3", "period_s = 0.0", "ego.roll_rad.period_s"),
    ] {
        assert!(TINY.contains(from), "{from}");
        let fault = refusal(&TINY.replacen(from, to, 1));
        let found = fault.record.clone().unwrap_or_default();
        assert!(found.contains(key) && fault.place == "tiny.toml", "{key}: {fault}");
    }
}

#[test]
fn names_that_the_taxonomy_lacks_are_refused_by_their_key() {
    for (from, to, key) in [
        ("vehicle.car", "vehicle.tank", "mover car.category"),
        ("static.vegetation", "static.jelly", "static[1].class"),
        ("flat.sidewalk", "flat.sidewalks", "ground.bands[1].class"),
        ("vehicle.ego", "ego", "ego.body.class"),
        ("keyframe_hz = 2.0", "keyframe_hz = 3.0", "keyframe_hz"),
    ] {
        let fault = refusal(&TINY.replacen(from, to, 1));
        assert_eq!((fault.place.as_str(), fault.record.as_deref()), ("tiny.toml", Some(key)));
    }
}

#[test]
fn refusals_list_what_is_known() {
    for (from, to, known) in [
        ("vehicle.car", "vehicle.tank", "vehicle.bicycle"),
        ("static.vegetation", "static.jelly", "static.manmade"),
        ("model.pinhole", "model.fisheye", "`kannala-brandt`"),
    ] {
        assert!(TINY.contains(from), "{from}");
        let fault = refusal(&TINY.replace(from, to));
        assert!(fault.expected.contains(known), "{fault}");
    }
}

#[test]
fn a_ground_without_bands_is_refused_as_such() {
    let (before, rest) = TINY.split_once("bands = [").unwrap();
    let (_, after) = rest.split_once("\n]").unwrap();
    let fault = refusal(&format!("{before}bands = []{after}"));
    assert_eq!((fault.expected.as_str(), fault.found.as_str()), ("at least one band", "none"));
}

#[test]
fn a_worlds_hash_is_of_what_it_says_not_of_how() {
    let hash = |text: &str| World::parse(text, "tiny.toml").unwrap().hash;
    assert_eq!(hash(TINY), hash(&format!("# A comment.\n{TINY}\n")));
    assert_ne!(hash(TINY), hash(&TINY.replacen("seed = 7", "seed = 8", 1)));
    assert_eq!(hash(TINY).len(), 64);
}

fn rules() -> Rules {
    let autos = Autos {
        ego_box_m: None,
        taxonomy: "occ3d-nuscenes".into(),
        reference_lidar: "LIDAR_TOP".into(),
    };
    let small = ["grid.min_m=[-24, -24, -1]", "grid.max_m=[24, 24, 5.4]"].map(String::from);
    let precise = preset("precise").unwrap();
    let mut config = Config::from_layers("precise", precise, None, &small).unwrap();
    config.resolve(&autos, &taxonomy());
    Rules::new(&config, taxonomy().into()).unwrap()
}

#[test]
fn a_labelled_drive_has_its_wall_where_it_is_and_no_trail() {
    let every_sweep = format!("{TINY}\n[annotator]\npoint_labels = \"all\"\n");
    let (drive, rules) = (drive(&every_sweep), rules());
    let scene = drive.scene();
    let read = |header: &_| Ok::<_, Fault>(drive.sweep_number(header).map(|at| drive.points(at)));
    let aggregated = aggregate_scene(scene, &rules, read, |_| ()).unwrap();
    let keyframe = &scene.keyframes[2];
    let labels = label_keyframe(
        scene,
        &aggregated,
        &Lenses::default(),
        keyframe,
        &rules,
        &LabelOptions::with_evidence(2),
        |_| (),
    )
    .labels;

    let world_from_ego = scene.sweeps[keyframe.sweep].world_from_ego;
    let PointLabel::Class(car) = drive.label_of(What::Mover(mover(&drive, "car"))) else {
        panic!()
    };
    let boxed = drive.world().movers[mover(&drive, "car")].box_at(1.0, &drive.world().ground);
    let manmade = taxonomy().class_named("manmade").unwrap();
    let (mut wall, mut car_voxels) = (0, 0);
    for (at, &class) in labels.semantics.values().iter().enumerate() {
        let centre = world_from_ego * rules.spec.centre(rules.spec.voxel_at(at));
        if class == car.0 {
            let p = boxed.world_from_box.inverse() * centre;
            assert!((0..3).all(|a| p[a].abs() < boxed.size_m[a] / 2.0 + 0.5), "trail at {p:?}");
            car_voxels += 1;
        }
        if class == manmade.0 {
            // The near face, less half a voxel's diagonal.
            assert!((9.5 - 0.35..11.0).contains(&centre.y), "{centre:?}");
            wall += 1;
        }
    }
    assert!(wall > 200 && car_voxels > 30, "{wall} {car_voxels}");
}
