//! A tiny drive, written as a nuScenes log and read back.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::{
    Fault, OccupancyLabels, PointCloud, PointLabel, Pose, Scene, SweepHeader, Taxonomy,
};
use occlabel_logs::{NuScenesLog, NuScenesOptions, QuaternionOrder, ReadOptions, SceneSource};
use occlabel_pipeline::{
    Autos, Config, LabelOptions, Lenses, Rules, aggregate_scene, label_keyframe, parse_taxonomy,
    preset, shipped_taxonomy,
};
use occlabel_simulate::{Drive, Images, Output, Return, World, render, write_nuscenes};
use tempfile::TempDir;

const TINY: &str = include_str!("tiny.toml");

/// A camera of each other model, coarsely.
const CAMERAS: &str = r#"
[[camera]]
name = "CAM_BACK"
mounting = { position_m = [0.0, 0.0, 1.5], yaw_rad = 3.0 }
model.brown-conrady = { matrix = [[40.0, 0.1, 40.0], [0.0, 41.0, 22.0], [0.0, 0.0, 1.0]], distortion = [0.1, -0.05, 0.001, 0.002, 0.01, 0.02, 0.0, 0.003] }
width = 80
height = 45
rate_hz = 12.0

[[camera]]
name = "CAM_DOME"
mounting = { position_m = [0.5, 0.0, 1.9], pitch_rad = 0.3 }
model.ocam = { polynomial = [-30.0, 0.0, 0.01, -0.0001], centre = [40.0, 40.5], affine = [1.0, 0.001, -0.002], max_angle_rad = 1.8 }
width = 80
height = 81
rate_hz = 5.0

[[camera]]
name = "CAM_FISH"
mounting = { position_m = [0.5, 0.4, 1.5], yaw_rad = 1.5 }
model.kannala-brandt = { matrix = [[30.0, 0.0, 40.0], [0.0, 30.0, 30.0], [0.0, 0.0, 1.0]], distortion = [0.05, -0.01, 0.002, 0.0] }
width = 80
height = 60
rate_hz = 4.0

[[camera]]
name = "CAM_MEI"
mounting = { position_m = [0.5, -0.4, 1.5], yaw_rad = -1.5 }
model.mei = { matrix = [[60.0, 0.0, 40.0], [0.0, 60.0, 30.0], [0.0, 0.0, 1.0]], distortion = [1.1, -0.1, 0.01, 0.0002, 0.0001] }
width = 80
height = 60
rate_hz = 2.0
"#;

fn taxonomy() -> Taxonomy {
    parse_taxonomy(shipped_taxonomy("occ3d-nuscenes").unwrap(), "occ3d-nuscenes").unwrap()
}

fn drive(text: &str) -> Drive {
    let world = World::parse(text, "tiny.toml").unwrap_or_else(|fault| panic!("{fault}"));
    Drive::new(world, &taxonomy()).unwrap_or_else(|fault| panic!("{fault}"))
}

fn write(drives: &[Drive], root: &Path) {
    let output = Output::create(root).unwrap();
    let (written, last) = write_nuscenes(drives, &taxonomy(), Images::None, &output).unwrap();
    assert_eq!(written.scenes, drives.len());
    output.finish(last).unwrap();
}

fn open(root: &Path) -> NuScenesLog {
    let options = NuScenesOptions {
        read: ReadOptions::of(taxonomy()),
        version: None,
        quaternion_order: QuaternionOrder::default(),
        columns: None,
    };
    NuScenesLog::open(root, options).unwrap_or_else(|fault| panic!("{fault}"))
}

/// A drive with a camera of every model, as written, and its log.
fn logged() -> (TempDir, Drive, NuScenesLog) {
    let folder = tempfile::tempdir().unwrap();
    let drive = drive(&format!("{TINY}{CAMERAS}"));
    write(std::slice::from_ref(&drive), folder.path());
    let log = open(folder.path());
    (folder, drive, log)
}

#[track_caller]
fn assert_near(a: &Pose, b: &Pose) {
    let off =
        (a.translation.vector - b.translation.vector).norm() + a.rotation.angle_to(&b.rotation);
    assert!(off < 1e-9, "{a} {b}");
}

#[test]
fn the_log_holds_the_scene_of_the_drive() {
    let (_folder, drive, log) = logged();
    assert_eq!(log.scene_names(), ["tiny"]);
    let (read, told) = (log.load("tiny").unwrap(), drive.scene());
    assert!(read.refused.is_empty() && read.warnings.is_empty(), "{:?}", read.warnings);
    assert_eq!(read.sweeps.len(), told.sweeps.len());
    for (a, b) in read.sweeps.iter().zip(&told.sweeps) {
        assert_eq!((a.time, &a.lidar, a.labelled), (b.time, &b.lidar, b.labelled));
        assert_near(&a.world_from_ego, &b.world_from_ego);
        assert_near(&a.ego_from_lidar, &b.ego_from_lidar);
    }
    assert_same_tracks(&read, told);
    assert_eq!(read.cameras.len(), 5);
    for (a, b) in read.cameras.iter().zip(&told.cameras) {
        assert_eq!((&a.name, &a.camera), (&b.name, &b.camera));
    }
}

fn assert_same_tracks(read: &Scene, told: &Scene) {
    assert_eq!(read.tracks.len(), told.tracks.len());
    for (a, b) in read.tracks.iter().zip(&told.tracks) {
        assert_eq!((a.id, &a.category, a.meaning), (b.id, &b.category, b.meaning));
        assert_eq!(a.source_id, format!("tiny-{}", b.source_id));
        assert_eq!(a.boxes.len(), b.boxes.len());
        for ((time, boxed), (told_time, told_box)) in a.boxes.iter().zip(&b.boxes) {
            assert_eq!((time, boxed.size_m), (told_time, told_box.size_m));
            assert_near(&boxed.world_from_box, &told_box.world_from_box);
        }
    }
}

#[test]
fn keyframes_are_found_again_by_their_tokens() {
    let (_folder, drive, log) = logged();
    let read = log.load("tiny").unwrap();
    let mut exposures = 0;
    assert_eq!(read.keyframes.len(), drive.scene().keyframes.len());
    for key in &read.keyframes {
        let told = drive.keyframe(&key.token).unwrap();
        assert_eq!((key.time, key.sweep), (told.time, told.sweep));
        assert_eq!(key.token, format!("tiny-{}", told.time.0));
        assert_eq!(key.exposures.len(), told.exposures.len());
        for (a, b) in key.exposures.iter().zip(&told.exposures) {
            assert_eq!((a.camera, a.time), (b.camera, b.time));
            assert_near(&a.world_from_camera, &b.world_from_camera);
            exposures += 1;
        }
    }
    assert!(exposures > 15, "{exposures}");
}

#[test]
fn any_sweep_of_the_reference_lidar_is_found_by_its_token() {
    let (_folder, drive, log) = logged();
    let mut between = 0;
    for (at, sweep) in log.load("tiny").unwrap().sweeps.iter().enumerate() {
        if sweep.lidar == "LIDAR_TOP" {
            assert_eq!(drive.keyframe(&sweep.source_id).unwrap().sweep, at);
            between += usize::from(drive.scene().keyframes.iter().all(|key| key.sweep != at));
        }
    }
    assert!(between > 10, "{between}");
    assert!(drive.keyframe("tiny-LIDAR_TOP-1").is_none() && drive.keyframe("tiny").is_none());
}

/// A cloud as a file of 32-bit numbers keeps it; the format knows one origin only.
fn as_logged(mut cloud: PointCloud<PointLabel>) -> PointCloud<PointLabel> {
    cloud.positions.iter_mut().for_each(|p| *p = p.cast::<f32>().cast::<f64>());
    PointCloud::from_one_origin(occlabel_core::LIDAR_ORIGIN, cloud.positions, cloud.labels)
}

#[test]
fn points_and_labels_are_those_of_the_drive() {
    let (_folder, drive, log) = logged();
    let (mut points, mut labelled) = (0, 0);
    for (sweep, header) in log.load("tiny").unwrap().sweeps.iter().enumerate() {
        let read = log.read_sweep(header).unwrap().cloud;
        let told = as_logged(drive.points(sweep));
        assert_eq!(read, told, "sweep {sweep}");
        points += read.len();
        labelled += usize::from(header.labelled);
    }
    assert!(points > 50_000 && labelled >= 5, "{points} points, {labelled} labelled");
}

#[test]
fn labels_are_numbered_as_nuscenes_does_even_where_the_annotator_is_wrong() {
    let text = TINY.replace("[ground]", "[annotator]\nmislabelled_points = 0.1\n\n[ground]");
    let drive = drive(&text);
    let folder = tempfile::tempdir().unwrap();
    write(std::slice::from_ref(&drive), folder.path());
    let log = open(folder.path());
    let (mut count, mut wrong) = (0, 0);
    for (sweep, header) in log.load("tiny").unwrap().sweeps.iter().enumerate() {
        let (read, told) = (log.read_sweep(header).unwrap().cloud, drive.points(sweep));
        assert_eq!(read.labels, told.labels);
        let returns = drive.returns(sweep);
        let right =
            |(found, label): &(&Return, &PointLabel)| drive.label_of(found.hit.what) == **label;
        if header.labelled {
            wrong += returns.iter().zip(&told.labels).filter(|pair| !right(pair)).count();
            count += returns.len();
        }
    }
    assert!(wrong > count / 20 && wrong < count / 6, "{wrong} of {count}");
    let file = folder.path().join("lidarseg/v1.0-sim/tiny-LIDAR_TOP-0_lidarseg.bin");
    let road = std::fs::read(file).unwrap().into_iter().filter(|label| *label == 24).count();
    assert!(road > 400, "{road} points of flat.driveable_surface");
}

fn rules() -> Rules {
    let autos = Autos {
        ego_box_m: None,
        taxonomy: "occ3d-nuscenes".into(),
        reference_lidar: "LIDAR_TOP".into(),
    };
    let small = ["grid.min_m=[-16, -16, -1]", "grid.max_m=[16, 16, 5.4]"].map(String::from);
    let precise = preset("precise").unwrap();
    let mut config = Config::from_layers("precise", precise, None, &small).unwrap();
    config.resolve(&autos, &taxonomy());
    Rules::new(&config, taxonomy().into()).unwrap()
}

fn labels(
    scene: &Scene,
    rules: &Rules,
    points: impl Fn(&SweepHeader) -> PointCloud<PointLabel> + Sync,
) -> OccupancyLabels {
    let read = |header: &_| Ok::<_, Fault>(Some(points(header)));
    let aggregated = aggregate_scene(scene, rules, read, |_| ()).unwrap();
    label_keyframe(
        scene,
        &aggregated,
        &Lenses::default(),
        &scene.keyframes[1],
        rules,
        &LabelOptions::with_evidence(1),
        |_| (),
    )
    .labels
}

#[test]
fn labels_of_the_log_are_those_of_the_drive() {
    let (_folder, drive, log) = logged();
    let (read, rules) = (log.load("tiny").unwrap(), rules());
    let from_log = labels(&read, &rules, |header| log.read_sweep(header).unwrap().cloud);
    let in_memory = labels(drive.scene(), &rules, |header| {
        as_logged(drive.points(drive.sweep_number(header).unwrap()))
    });
    let occupied = in_memory.semantics.values().iter().filter(|class| **class != 17).count();
    assert!(occupied > 500, "{occupied}");
    assert!(from_log.semantics == in_memory.semantics);
    assert!(from_log.mask_lidar == in_memory.mask_lidar);
    assert!(from_log.mask_camera == in_memory.mask_camera);
    assert!(from_log.evidence().instances == in_memory.evidence().instances);
}

/// Every file below a folder with its bytes.
fn files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(root).unwrap().display().to_string();
                found.insert(name, std::fs::read(path).unwrap());
            }
        }
    }
    found
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let on = |threads: usize| {
        let folder = tempfile::tempdir().unwrap();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| write(&[drive(TINY)], folder.path()));
        files(folder.path())
    };
    let alone = on(1);
    assert!(alone.len() > 50, "{} files", alone.len());
    assert!(alone == on(2));
}

#[test]
fn pictures_and_masks_stand_beside_each_other() {
    let drive = drive(&format!("{}{CAMERAS}", &TINY[..TINY.find("[[camera]]").unwrap()]));
    let folder = tempfile::tempdir().unwrap();
    let written = |images, at: &str| {
        let output = Output::create(&folder.path().join(at)).unwrap();
        let drives = std::slice::from_ref(&drive);
        let (written, last) = write_nuscenes(drives, &taxonomy(), images, &output).unwrap();
        output.finish(last).unwrap();
        written.images
    };
    let all: usize = (0..4).map(|camera| drive.exposures(camera).len()).sum();
    let some = written(Images::Keyframes, "some");
    assert!(some >= 17 && all > some, "{some} of {all}");
    assert_eq!((written(Images::None, "none"), written(Images::All, "all")), (0, all));
    let files = files(&folder.path().join("all"));
    let mut seen = 0;
    for exposure in (0..4).flat_map(|camera| drive.exposures(camera)) {
        let camera = &drive.scene().cameras[exposure.camera].name;
        let name = format!("{camera}/tiny__{camera}__{}.png", exposure.time.0 / 1000);
        let told = render(&drive, &exposure);
        let picture =
            ["samples", "sweeps"].iter().find_map(|at| files.get(&format!("{at}/{name}")));
        let picture = image::load_from_memory(picture.unwrap()).unwrap().into_rgb8();
        let mask = image::load_from_memory(&files[&format!("masks/{name}")]).unwrap().into_luma8();
        assert!(picture.into_raw() == told.rgb && mask.into_raw() == told.classes, "{name}");
        seen += usize::from(told.classes.iter().any(|class| *class != u8::MAX));
    }
    assert_eq!(seen, all);
}

#[test]
fn several_scenes_stand_in_one_log() {
    let folder = tempfile::tempdir().unwrap();
    let named = |name: &str| drive(&TINY.replace("name = \"tiny\"", &format!("name = \"{name}\"")));
    write(&[named("tiny-0001"), named("tiny-0002")], folder.path());
    let log = open(folder.path());
    assert_eq!(log.scene_names(), ["tiny-0001", "tiny-0002"]);
    assert!(log.scene_names().iter().all(|name| log.load(name).unwrap().keyframes.len() == 5));
    let refused = Output::create(&folder.path().join("new")).and_then(|output| {
        write_nuscenes(&[named("a"), named("a-b")], &taxonomy(), Images::None, &output)
    });
    assert!(refused.unwrap_err().found.contains("`a` and `a-b`"));
}

#[test]
fn a_log_appears_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let output = Output::create(folder.path()).unwrap();
    output.write("samples/a.bin", b"abc").unwrap();
    assert!(!folder.path().join("samples").exists());
    drop(output);
    assert_eq!(files(folder.path()), BTreeMap::new(), "given up");
    std::fs::create_dir_all(folder.path().join(".part/old")).unwrap();
    let output = Output::create(folder.path()).unwrap();
    output.write("b.bin", b"abc").unwrap();
    assert_eq!(output.finish("b.bin").unwrap(), (1, 3));
    assert_eq!(files(folder.path()), [("b.bin".into(), b"abc".to_vec())].into());
    let fault = Output::create(folder.path()).unwrap_err();
    assert_eq!((fault.rule, fault.found.as_str()), ("output", "`b.bin` in it"));
}
