//! Images of the tiny world: what stands where, pixel by pixel.

use occlabel_core::camera::{RollingShutter, ShutterDirection};
use occlabel_core::{Fault, Palette, PointLabel, Taxonomy, Timestamp};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_simulate::{ClassImage, Drive, NO_CLASS, What, World, render};

const WORLD: &str = r#"
name = "room"
duration_s = 2.0
taxonomy = "occ3d-nuscenes"
keyframe_hz = 2.0
ground.bands = [{ class = "flat.driveable_surface" }]

[ego]
trajectory.straight = { start = { x_m = 0.0, y_m = 0.0 }, speed_mps = 4.0 }
body = { min_m = [-1.0, -0.9, 0.2], max_m = [3.6, 0.9, 1.7], class = "vehicle.ego" }

# A wall ahead, 4 m high, its near face at x = 20 m.
[[static]]
class = "static.manmade"
pose = { position_m = [20.5, 0.0, 2.0] }
shape.box.size_m = [1.0, 60.0, 4.0]

# A car that crosses: at 1 s its near side stands at x = 12 m, its middle at y = 0.
[[mover]]
name = "car"
category = "vehicle.car"
size_m = [4.0, 2.0, 1.5]
trajectory.straight = { start = { x_m = 13.0, y_m = -8.0, yaw_rad = 1.5707963267948966 }, speed_mps = 8.0 }

[[lidar]]
name = "LIDAR_TOP"
mounting = { position_m = [0.9, 0.0, 2.0] }
pattern.spinning = { beams.even = { count = 4, min_rad = -0.4, max_rad = 0.0 }, azimuths = 60 }
rate_hz = 10.0
max_range_m = 40.0

[[camera]]
name = "CAM_FRONT"
mounting = { position_m = [1.7, 0.0, 1.5] }
model.pinhole.matrix = [[60.0, 0.0, 80.5], [0.0, 60.0, 45.5], [0.0, 0.0, 1.0]]
width = 161
height = 91
rate_hz = 12.0
"#;

fn try_drive(text: &str) -> Result<Drive, Fault> {
    let text_of = |name| shipped_taxonomy(name).unwrap();
    let taxonomy: Taxonomy = parse_taxonomy(text_of("occ3d-nuscenes"), "occ3d-nuscenes").unwrap();
    Drive::new(World::parse(text, "room.toml")?, &taxonomy)
}

fn drive(text: &str) -> Drive {
    try_drive(text).unwrap_or_else(|fault| panic!("{fault}"))
}

/// The image at a second: the camera stands at x = 5.7 m.
fn image(drive: &Drive) -> ClassImage {
    let exposure = drive.exposures(0).into_iter().find(|e| e.time == Timestamp(1_000_000_000));
    render(drive, &exposure.unwrap())
}

fn at(image: &ClassImage, column: usize, row: usize) -> (u8, u16, f32) {
    let pixel = row * image.width as usize + column;
    (image.classes[pixel], image.instances[pixel], image.distances_m[pixel])
}

fn class(drive: &Drive, what: What) -> u8 {
    let PointLabel::Class(class) = drive.label_of(what) else { panic!("{what:?}") };
    class.0
}

#[test]
fn pixels_show_what_stands_there_at_its_distance() {
    let drive = drive(WORLD);
    let image = image(&drive);
    let [wall, car, road] = [What::Static(0), What::Mover(0), What::Ground(0)];
    for (column, row, what, instance, expected_m) in [
        // 3 columns a metre at 20 m: the car is 2 m to either side, so column 130 is beside it.
        (130, 45, wall, 0, 14.3 * libm::hypot(1.0, 50.0 / 60.0)),
        (80, 41, wall, 0, 14.3 * libm::hypot(1.0, 4.0 / 60.0)),
        (80, 50, car, 1, 6.3 * libm::hypot(1.0, 5.0 / 60.0)),
        // The ray that falls 1.5 m over 60 / 40 of it.
        (80, 85, road, 0, 1.5 * libm::hypot(1.0, 60.0 / 40.0)),
    ] {
        let (found, number, distance_m) = at(&image, column, row);
        assert_eq!((found, number), (class(&drive, what), instance), "{column} {row}");
        assert!((f64::from(distance_m) - expected_m).abs() < 1e-5, "{distance_m}, {expected_m}");
    }
    assert_eq!(at(&image, 80, 20), (NO_CLASS, 0, f32::INFINITY), "sky above the wall");
}

#[test]
fn a_car_covers_the_columns_it_should() {
    let image = image(&drive(WORLD));
    // Its near side: 2 m to either side, 6.3 m away, 60 px focal length.
    let covered: Vec<usize> = (0..161).filter(|&column| at(&image, column, 50).1 == 1).collect();
    let half = (60.0_f64 * 2.0 / 6.3).floor() as usize;
    assert_eq!((covered[0], covered.len()), (80 - half, 2 * half + 1));
}

#[test]
fn colours_are_the_classes_own_dimmed_by_the_light() {
    let drive = drive(WORLD);
    let image = image(&drive);
    let road = (85 * 161 + 80) * 3;
    // Straight up: 0.4 + 0.6 * (1 + 0.8) / 2 of the colour.
    let expected =
        Palette::of(&["driveable_surface"]).color(0).map(|c| (f64::from(c) * 0.94).round() as u8);
    assert_eq!(image.rgb[road..road + 3], expected);
    assert_eq!(image.rgb.len(), 161 * 91 * 3);
}

#[test]
fn the_picture_is_true_whatever_the_log_says() {
    let faults = "[annotator]\npose_drift = 0.1\ncalibration_m = 1.0\nmissing_boxes = 1.0\n";
    assert!(image(&drive(WORLD)) == image(&drive(&format!("{WORLD}{faults}"))));
}

#[test]
fn the_same_picture_on_any_number_of_threads() {
    let drive = drive(WORLD);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| image(&drive))
    };
    assert!(on(1) == on(2));
}

#[test]
fn the_own_body_is_seen_where_the_mask_says() {
    let masked = WORLD.replace(
        "width = 161",
        "body_mask = [{ from-row = 80 }]\nwidth = 161\n\
         rolling_shutter = { direction = \"top-to-bottom\", readout_s = 0.02 }",
    );
    let drive = drive(&masked);
    let image = image(&drive);
    assert_eq!(at(&image, 80, 80), (NO_CLASS, 0, f32::INFINITY));
    assert_eq!(at(&image, 80, 79).0, class(&drive, What::Ground(0)));
    let camera = &drive.scene().cameras[0].camera;
    assert!(camera.is_body(0, 90) && !camera.is_body(0, 79));
    let direction = ShutterDirection::TopToBottom;
    assert_eq!(camera.rolling_shutter, Some(RollingShutter { direction, readout_s: 0.02 }));
}

#[test]
fn bad_cameras_are_refused_by_their_key() {
    for (line, key) in [
        ("body_mask = [{ from-row = -1 }]", "camera[0].body_mask[0]"),
        ("body_mask = [{ circle = 3 }]", "camera[0].body_mask[0]"),
        ("body_mask = [{ rectangle = { columns = [3, 2], rows = [0, 1] } }]", "rectangle.columns"),
        ("rolling_shutter = { direction = \"inwards\", readout_s = 0.02 }", "rolling_shutter"),
        (
            "rolling_shutter = { direction = \"left-to-right\", readout_s = -1.0 }",
            "camera[0].rolling_shutter.readout_s",
        ),
    ] {
        let text = WORLD.replace("width = 161", &format!("{line}\nwidth = 161"));
        let fault = try_drive(&text).unwrap_err();
        assert!(fault.record.clone().unwrap_or_default().contains(key), "{key}: {fault}");
    }
}
