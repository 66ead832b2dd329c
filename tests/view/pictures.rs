//! The command `view`, where it makes pictures.

use std::fs;
use std::path::{Path, PathBuf};

use crate::street::street;
use crate::support::{Ended, Label, copy, manifest, occlabel, text};

/// A street of few rays, its log with images, and its labels.
struct Street {
    folder: tempfile::TempDir,
}

impl Street {
    fn new() -> Self {
        let street = Self { folder: tempfile::tempdir().expect("a folder") };
        let log = street.path("log");
        let line = ["simulate", "--world", "street", "--format", "nuscenes", "--output"];
        let coarse = ["--set", "lidar.*.pattern.spinning.azimuths=60"];
        occlabel(&[&line[..], &[text(&log)], &coarse].concat()).exits(0);
        Label::new(&log, &street.path("labels")).small().run().exits(0);
        street
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn view(&self, output: &Path, flags: &[&str]) -> Ended {
        let line =
            ["view", text(&self.path("labels")), "--output", text(output)].map(str::to_owned);
        let line: Vec<&str> =
            line.iter().map(String::as_str).chain(flags.iter().copied()).collect();
        occlabel(&line)
    }

    /// The picture's bytes.
    fn picture(&self, flags: &[&str]) -> Vec<u8> {
        let output = self.path("picture.png");
        let told = self.view(&output, flags).exits(0).stdout;
        assert_eq!(told.trim(), text(&output));
        fs::read(output).expect("a picture")
    }
}

/// Width and height, of the file's first chunk.
fn size(png: &[u8]) -> [u32; 2] {
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));
    [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes")))
}

#[test]
fn every_kind_of_picture_is_drawn_in_its_size() {
    let street = Street::new();
    let (log, labels) = (street.path("log"), street.path("labels"));
    let with_log = ["--format", "nuscenes", "--input", text(&log)];
    let kinds: [&[&str]; 9] = [
        &[],
        &["--picture", "birds-eye"],
        &["--picture", "perspective", "--azimuth-deg", "-20", "--distance-m", "30"],
        &["--picture", "perspective", "--camera", "CAM_FRONT"],
        &["--picture", "overlay"],
        &["--picture", "overlay", "--camera", "CAM_BACK"],
        &["--picture", "slices", "--across", "y"],
        &["--picture", "strip"],
        &["--picture", "difference", "--against", text(&labels)],
    ];
    let mut drawn: Vec<Vec<u8>> = Vec::new();
    for kind in kinds {
        let flags = [kind, &["--size", "640x360"], &with_log].concat();
        let picture = street.picture(&flags);
        assert_eq!(size(&picture), [640, 360], "{kind:?}");
        assert!(!drawn.contains(&picture), "{kind:?} looks like another");
        drawn.push(picture);
    }
    assert_eq!(drawn.len(), 9);
    assert_eq!(size(&street.picture(&[])), [1600, 900]);
    let again = street.picture(&["--size", "640x360"]);
    assert_eq!(again, drawn[0], "the same bytes");
    let other = street.picture(&["--size", "640x360", "--colors", "color-blind"]);
    assert_ne!(other, drawn[0]);
}

#[test]
fn flags_that_a_picture_does_not_use_are_refused() {
    let street = Street::new();
    let lines: [(&[&str], &str); 9] = [
        (&["--picture", "birds-eye", "--azimuth-deg", "9"], "--azimuth-deg"),
        (&["--picture", "strip", "--across", "x"], "--across"),
        (&["--picture", "overlay"], "--format F --input LOG"),
        (&["--picture", "perspective", "--camera", "CAM_FRONT"], "--format F --input LOG"),
        (&["--picture", "difference"], "--against DIR"),
        (&["--against", "elsewhere"], "--against"),
        (&["--size", "8x9"], "expected WxH"),
        (&["--size", "1600"], "expected WxH"),
        (&["--elevation-deg", "nan"], "expected degrees"),
    ];
    for (flags, told) in lines {
        let ended = street.view(&street.path("none.png"), flags).exits(2);
        assert!(ended.stderr.contains(told), "{flags:?}: {}", ended.stderr);
    }
    assert!(!street.path("none.png").exists());
}

#[test]
fn a_camera_that_the_log_does_not_have_is_told_those_that_it_has() {
    let street = Street::new();
    let log = street.path("log");
    let flags = ["--picture", "overlay", "--camera", "CAM_TOP", "--format", "nuscenes", "--input"];
    let ended = street.view(&street.path("none.png"), &[&flags[..], &[text(&log)]].concat());
    let told = ended.exits(2).stderr;
    assert!(told.contains("CAM_BACK, CAM_FRONT") && told.contains("`CAM_TOP`"), "{told}");
}

#[test]
fn a_broken_image_is_told_by_its_file() {
    let street = Street::new();
    let folder = street.path("log").join("samples/CAM_FRONT");
    for file in fs::read_dir(folder).expect("images") {
        fs::write(file.expect("a file").path(), b"\x89PNG\r\n\x1a\nnothing").expect("written");
    }
    let log = street.path("log");
    let flags = ["--picture", "overlay", "--format", "nuscenes", "--input", text(&log)];
    let told = street.view(&street.path("none.png"), &flags).exits(1).stderr;
    assert!(told.contains("CAM_FRONT") && told.contains("expected a JPEG or PNG"), "{told}");
}

#[test]
fn labels_without_keyframes_are_refused_by_every_output() {
    let street = street();
    let bare = street.beside("no-keyframes");
    copy(&street.labels, &bare);
    let mut manifest = manifest(&bare);
    manifest["scenes"]["street"]["keyframes"] = serde_json::json!([]);
    fs::write(bare.join("manifest.json"), manifest.to_string()).expect("written");
    for name in ["bare.png", "bare.html", "bare.mcap", "bare.ply", "bare.glb"] {
        let output = street.beside(name);
        occlabel(&["view", text(&bare), "--output", text(&output)]).exits(2).tells(&["none"]);
        assert!(!output.exists(), "{name}");
    }
    let file = bare.join("manifest.json");
    let line = ["view", text(&file), "--output", "a.png"];
    occlabel(&line).exits(2).tells(&["a folder of labels", "hint"]);
}

#[test]
fn a_grid_in_the_frame_of_a_turned_lidar_is_seen_from_behind_the_ego() {
    let street = street();
    let turned = street.beside("turned");
    copy(&street.labels, &turned);
    let mut manifest = manifest(&turned);
    manifest["grid"]["frame"] = "lidar".into();
    let poses = manifest["scenes"]["street"]["poses"].as_array_mut().expect("poses");
    // The lidar's x looks to the right: the ego's forward is its y.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    poses.iter_mut().for_each(|pose| {
        pose["ego_from_lidar"]["rotation"] = serde_json::json!([half, 0.0, 0.0, -half])
    });
    fs::write(turned.join("manifest.json"), manifest.to_string()).expect("written");
    let page = street.beside("turned.html");
    occlabel(&["view", text(&turned), "--output", text(&page)]).exits(0);
    let html = fs::read_to_string(page).expect("a page");
    let (_, rest) = html.split_once("\"heading_rad\":").expect("a heading");
    let heading_rad: f64 =
        rest.split(&[',', '}'][..]).next().and_then(|n| n.parse().ok()).expect("a number");
    assert!((heading_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12, "{heading_rad}");
}
