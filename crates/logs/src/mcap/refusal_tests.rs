//! Messages that cannot be used: they are told, and hide no others.

use std::collections::BTreeSet;
use std::path::Path;

use occlabel_core::{Fault, Scene};

use super::samples::{LOOK_NS, Sample, Told, drive, file, options};
use super::{McapLog, McapOptions};
use crate::SceneSource;

fn write(folder: &Path, name: &str, samples: &[Sample]) {
    std::fs::write(folder.join(name), file(samples, None)).unwrap();
}

fn load(samples: &[Sample], options: McapOptions) -> Result<Scene, Fault> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.mcap", samples);
    McapLog::open(folder.path(), options)?.load("a")
}

/// The drive in JSON with these words replaced in its cloud.
fn changed(from: &str, to: &str) -> Vec<Sample> {
    let mut samples = drive(Told::Json);
    for sample in samples.iter_mut().filter(|sample| sample.topic == "/points") {
        let text = String::from_utf8(sample.data.clone()).unwrap();
        assert!(text.contains(from), "{text}");
        sample.data = text.replace(from, to).into_bytes();
    }
    samples
}

#[test]
fn a_first_cloud_that_cannot_be_read_is_told_and_hides_no_other() {
    let broken = changed(r#""data":""#, r#""data":"?"#);
    let fault = load(&broken, options()).unwrap_err();
    assert_eq!((fault.rule, fault.found.as_str()), ("mcap-message", "`?`"));
    let both = [broken, drive(Told::Json)].concat();
    let scene = load(&both, options()).unwrap_or_else(|fault| panic!("{fault}"));
    assert_eq!((scene.sweeps.len(), scene.refused.len()), (1, 1));
    assert_eq!(scene.refused[0].fault, fault);
}

#[test]
fn fault_17_clouds_beyond_the_transforms_are_told_with_the_clocks() {
    let (second, late) = (LOOK_NS / 1_000_000_000, LOOK_NS / 1_000_000_000 + 5);
    let late = changed(&format!(r#""sec":{second}"#), &format!(r#""sec":{late}"#));
    let fault = load(&late, options()).unwrap_err();
    assert_eq!(fault.rule, "no-sweeps");
    for part in ["no sweeps: 1 records refused", "no more pose of `base`", "5.000 s"] {
        assert!(fault.found.contains(part), "{fault}");
    }
    assert!(fault.hint.unwrap().contains("--time-source log"));
}

#[test]
fn only_wanted_scenes_choose_the_reference_lidar() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.mcap", &drive(Told::Json));
    let renamed = changed(r#""frame_id":"lidar""#, r#""frame_id":"eye""#);
    write(folder.path(), "b.mcap", &renamed);
    for (scene, lidar) in [("a", "lidar"), ("b", "eye")] {
        let mut options = options();
        options.read.scenes = Some(BTreeSet::from([scene.to_owned()]));
        let wanted = options.read.scenes.as_ref();
        let (defaults, _) = McapLog::resolve(folder.path(), wanted, &options.settings).unwrap();
        assert_eq!(defaults.reference_lidar, lidar);
        let log = McapLog::open(folder.path(), options).unwrap();
        assert_eq!(log.scene_names(), [scene]);
        assert_eq!(log.load(scene).unwrap().keyframes.len(), 1);
    }
    let absent = BTreeSet::from(["c".to_owned()]);
    let fault = McapLog::resolve(folder.path(), Some(&absent), &options().settings).unwrap_err();
    assert_eq!(fault.rule, "scene-unknown");
}

#[test]
fn a_description_names_the_raw_labels_of_the_first_clouds() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.mcap", &drive(Told::Json));
    let lines = McapLog::open(folder.path(), options()).unwrap().describe("a").unwrap();
    let at = lines.iter().position(|line| line == "[reader.mcap.classes]").unwrap();
    assert_eq!(lines[at + 1..at + 3], ["7 = \"rock\"", "9 = \"9\""]);
}
