//! Images of polarization beside labels.

use std::fs;
use std::path::{Path, PathBuf};

use image::{GrayImage, ImageBuffer, Luma};
use tempfile::TempDir;

use crate::support::{SMALL, files_under, occlabel, text};

/// Four cameras behind polarizers, and a lidar.
const WORLD: &str = r#"
    name = "glass"
    duration_s = 0.6
    seed = 1
    taxonomy = "occ3d-nuscenes"
    keyframe_hz = 5.0
    ground.bands = [{ class = "flat.driveable_surface" }]
    ego.trajectory.straight = { start = { x_m = 0.0, y_m = 0.0 }, speed_mps = 5.0 }
    [[lidar]]
    name = "LIDAR_TOP"
    mounting.position_m = [0.9, 0.0, 1.84]
    rate_hz = 10.0
    max_range_m = 50.0
    pattern.spinning = { azimuths = 90, beams.even = { count = 8, min_rad = -0.42, max_rad = 0.15 } }
"#;
const CAMERA: &str = r#"
    [[camera]]
    name = "NAME"
    mounting.position_m = [1.7, 0.0, 1.5]
    width = 4
    height = 3
    rate_hz = 10.0
    model.pinhole.matrix = [[3.0, 0.0, 2.0], [0.0, 3.0, 1.5], [0.0, 0.0, 1.0]]
"#;
const NAMES: [&str; 4] = ["CAM_0", "CAM_45", "CAM_90", "CAM_135"];
const CAMERAS: &str = "CAM_0,CAM_45,CAM_90,CAM_135";
/// Half of the light is polarized, at 0 degrees: Malus' law behind each polarizer.
const GREY: [u8; 4] = [150, 100, 50, 100];

/// A log with four grey pictures at each keyframe.
fn log() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let (world, log) = (folder.path().join("glass.toml"), folder.path().join("log"));
    let cameras: String = NAMES.iter().map(|name| CAMERA.replace("NAME", name)).collect();
    fs::write(&world, format!("{WORLD}{cameras}")).expect("a world");
    let line =
        ["simulate", "--world", text(&world), "--format", "nuscenes", "--output", text(&log)];
    occlabel(&line).exits(0);
    for (name, grey) in NAMES.into_iter().zip(GREY) {
        for file in fs::read_dir(log.join("samples").join(name)).expect("pictures") {
            let picture = GrayImage::from_pixel(4, 3, Luma([grey]));
            picture.save(file.expect("a picture").path()).expect("written");
        }
    }
    (folder, log)
}

fn polarization<'a>(log: &'a Path, output: &'a Path) -> Vec<&'a str> {
    let line = ["polarization", "--format", "nuscenes", "--input", text(log), "--cameras", CAMERAS];
    [&line[..], &["--output", text(output)]].concat()
}

/// The one value of a picture of 16 bits.
fn value(path: &Path) -> u16 {
    let picture = image::open(path).expect("a picture");
    let image::DynamicImage::ImageLuma16(grey) = picture else { panic!("not grey of 16 bits") };
    assert!(grey.pixels().all(|pixel| pixel == grey.get_pixel(0, 0)));
    grey.get_pixel(0, 0).0[0]
}

#[test]
fn images_of_polarization_stand_beside_the_labels_and_verify_knows_them() {
    let (folder, log) = log();
    let tree = folder.path().join("labels");
    let label = ["label", "--format", "nuscenes", "--input", text(&log), "--output", text(&tree)];
    occlabel(&[&label[..], &SMALL].concat()).exits(0);
    let labels = files_under(&tree);
    let told = occlabel(&polarization(&log, &tree)).exits(0).stdout;
    assert!(
        told.contains("keyframes  3, 0 without") && told.contains("36, 0 dark, 0 clamped"),
        "{told}"
    );
    let keyframe = tree.join("gts/glass/glass-200000000");
    assert_eq!(value(&keyframe.join("polarization_dolp.png")), 32_768, "half of 65535");
    assert_eq!(value(&keyframe.join("polarization_aolp.png")), 0);
    let verify = ["verify", text(&tree)];
    occlabel(&verify).exits(0);
    let files = files_under(&tree);
    assert!(labels.iter().all(|(name, bytes)| files.get(name) == Some(bytes)));
    assert_eq!(files.len(), labels.len() + 2 * 3 + 1);
    occlabel(&polarization(&log, &tree)).exits(0);
    assert!(files_under(&tree) == files, "the same bytes again");
    fs::write(keyframe.join("polarization_dolp.png"), "x").expect("written");
    let told = occlabel(&verify).exits(1).stdout;
    assert!(told.contains("glass-200000000/polarization_dolp.png: expected "), "{told}");
    assert!(told.contains("found 1 bytes") && told.contains("; 0 keyframes to redo"), "{told}");
    fs::write(keyframe.join("stray.png"), "x").expect("written");
    let told = occlabel(&verify).exits(1).stdout;
    assert!(told.contains("stray.png: expected a file that the manifest lists"), "{told}");
}

#[test]
fn an_absent_picture_costs_its_keyframe_and_is_counted() {
    let (folder, log) = log();
    let output = folder.path().join("out");
    let mut pictures: Vec<_> =
        fs::read_dir(log.join("samples/CAM_90")).expect("pictures").collect();
    fs::remove_file(pictures.pop().expect("one").expect("a picture").path()).expect("removed");
    let ended = occlabel(&polarization(&log, &output)).exits(0);
    assert!(ended.stdout.contains("keyframes  2, 1 without"), "{}", ended.stdout);
    ended.tells(&["glass", "four pictures at a keyframe", "1 of 3 without"]);
    assert_eq!(files_under(&output).len(), 2 * 2 + 1);
}

#[test]
fn what_are_no_four_grey_pictures_of_one_size_is_refused() {
    let (folder, log) = log();
    let output = folder.path().join("out");
    let line = polarization(&log, &output);
    let other = |cameras: &str| {
        let line: Vec<_> =
            line.iter().map(|word| if *word == CAMERAS { cameras } else { word }).collect();
        occlabel(&line).exits(2)
    };
    other("CAM_0,CAM_45,CAM_90").tells(&["--cameras", "four different cameras"]);
    other("CAM_0,CAM_45,CAM_90,CAM_0").tells(&["--cameras", "four different cameras"]);
    other("CAM_0,CAM_45,CAM_90,CAM_9").tells(&["CAM_135", "`CAM_9`"]);
    occlabel(&["polarization", "--output", text(&output)]).exits(2).tells(&["--images"]);
    let colour = log.join("samples/CAM_45");
    let file = fs::read_dir(&colour).expect("pictures").next().expect("one").expect("a picture");
    image::RgbImage::new(4, 3).save(file.path()).expect("written");
    occlabel(&line).exits(1).tells(&["samples/CAM_45", "a grey picture of 8 or 16 bits", "Rgb8"]);
    GrayImage::new(4, 4).save(file.path()).expect("written");
    occlabel(&line).exits(1).tells(&["samples/CAM_45", "4 x 3 pixels", "4 x 4"]);
}

#[test]
fn four_loose_files_are_enough() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = ["0", "45", "90", "135"].map(|name| folder.path().join(format!("{name}.png")));
    // All of it is polarized, at 135 degrees; one of 8 bits among those of 16.
    for (file, grey) in files.iter().zip([20_000_u16, 0, 20_000, 40_000]) {
        ImageBuffer::<Luma<u16>, _>::from_pixel(2, 2, Luma([grey])).save(file).expect("written");
    }
    GrayImage::new(2, 2).save(&files[1]).expect("written");
    let prefix = folder.path().join("light");
    let images: Vec<&str> = files.iter().map(|file| text(file)).collect();
    let line = [&["polarization", "--images"], &images[..], &["--output", text(&prefix)]].concat();
    let told = occlabel(&line).exits(0).stdout;
    assert!(told.contains("light_dolp.png") && told.contains("light_aolp.png"), "{told}");
    assert_eq!(value(&folder.path().join("light_dolp.png")), 65_535);
    assert_eq!(value(&folder.path().join("light_aolp.png")), 49_152, "135 of 180 degrees");
}
