//! What belongs to the clouds of a scene.

use std::fmt::Write;

use occlabel_core::{BoxTrack, Exposure, Fault, NamedCamera, Pose};
use serde_json::{Map, Value, json};

use crate::Drive;
use crate::write::files::Output;
use crate::write::nuscenes::add_optics;
use crate::write::png::mask_png;
use crate::write::raw_names::RawNames;

/// Names by number.
pub(super) fn classes(names: &RawNames) -> Value {
    let named = names.all().iter().enumerate();
    Value::Object(named.map(|(number, name)| (number.to_string(), json!(name))).collect())
}

/// The poses of keyframes, a line each.
pub(super) fn poses(drive: &Drive) -> String {
    let mut lines = String::from("# timestamp tx ty tz qx qy qz qw\n");
    for keyframe in &drive.scene().keyframes {
        let time_ns = keyframe.time.0;
        let pose = drive.scene().reference_sweep(keyframe).world_from_ego;
        let ([x, y, z], [qx, qy, qz, qw]): ([f64; 3], [f64; 4]) =
            (pose.translation.vector.into(), pose.rotation.coords.into());
        let (seconds, part) = (time_ns / 1_000_000_000, time_ns % 1_000_000_000);
        let time = format!("{seconds}.{part:09}");
        writeln!(lines, "{time} {x} {y} {z} {qx} {qy} {qz} {qw}").expect("text takes all");
    }
    lines
}

/// The cameras with all their exposures; writes their masks.
pub(super) fn cameras(drive: &Drive, output: &Output) -> Result<Value, Fault> {
    let mountings = &drive.poses().ego_from_camera;
    let cameras = drive.scene().cameras.iter().zip(mountings).enumerate();
    let row = |(at, (named, ego_from_camera))| camera(drive, at, named, ego_from_camera, output);
    cameras.map(row).collect()
}

fn camera(
    drive: &Drive,
    at: usize,
    named: &NamedCamera,
    ego_from_camera: &Pose,
    output: &Output,
) -> Result<Value, Fault> {
    let NamedCamera { name, camera } = named;
    let mut row = placement(ego_from_camera);
    add_optics(&mut row, &camera.model);
    row["name"] = json!(name);
    row["width"] = json!(camera.width);
    row["height"] = json!(camera.height);
    row["exposures"] = drive.exposures(at).iter().map(exposure).collect();
    if let Some(mask) = &camera.body_mask {
        let file = format!("masks/{name}.png");
        output.write(&format!("{}/{file}", drive.scene().name), &mask_png(mask))?;
        row["mask"] = json!(file);
    }
    Ok(row)
}

fn exposure(exposure: &Exposure) -> Value {
    let mut row = placement(&exposure.world_from_camera);
    row["time_ns"] = json!(exposure.time.0);
    row
}

/// The tracks with their boxes.
pub(super) fn tracks(drive: &Drive) -> Value {
    drive.scene().tracks.iter().map(track).collect()
}

fn track(track: &BoxTrack) -> Value {
    let boxes = track.boxes.iter().map(|(time, boxed)| {
        let mut row = placement(&boxed.world_from_box);
        row["time_ns"] = json!(time.0);
        row["size"] = json!(<[f64; 3]>::from(boxed.size_m));
        row
    });
    json!({ "id": track.source_id, "category": track.category, "boxes": boxes.collect::<Value>() })
}

fn placement(pose: &Pose) -> Value {
    let [x, y, z, w]: [f64; 4] = pose.rotation.coords.into();
    let translation: [f64; 3] = pose.translation.vector.into();
    let fields = [("translation", json!(translation)), ("rotation", json!([w, x, y, z]))];
    Value::Object(
        fields.map(|(key, value)| (key.to_owned(), value)).into_iter().collect::<Map<_, _>>(),
    )
}
