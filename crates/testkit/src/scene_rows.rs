//! The rows of one scene.

use crate::drive::Drive;
use crate::log_spec::SweepSlot;
use crate::pose::{rotation_of, translation_of};
use crate::rig::{Camera, cameras};
use crate::shared_rows::{VISIBLE, attribute_tokens, calibration_token, category_token};
use crate::table_set::TableSet;
use crate::tables::{
    EgoPose, Instance, Lidarseg, Log, Map, Sample, SampleAnnotation, SampleData, Scene,
};
use std::io;

/// How many returns each track has in the key sweep of each keyframe: `[keyframe][track]`.
pub(crate) type PointCounts = Vec<Vec<usize>>;

pub(crate) fn push_scene_rows(
    tables: &mut TableSet,
    drive: &Drive,
    counts: &PointCounts,
) -> io::Result<()> {
    tables.log.push(&log(drive))?;
    tables.map.push(&map(drive))?;
    tables.scene.push(&scene(drive))?;
    tables.sample.extend(drive.key_slots().map(|(_, slot)| sample(drive, slot)))?;
    push_lidar(tables, drive)?;
    if drive.spec.cameras {
        push_cameras(tables, drive)?;
    }
    push_boxes(tables, drive, counts)
}

fn log(drive: &Drive) -> Log {
    Log {
        token: drive.token("log", 0, 0),
        logfile: drive.logfile(),
        vehicle: "sim",
        date_captured: "2020-09-13",
        location: "straight-street",
    }
}

fn map(drive: &Drive) -> Map {
    let token = drive.token("map", 0, 0);
    Map {
        filename: format!("maps/{token}.png"),
        token,
        category: "semantic_prior",
        log_tokens: vec![drive.token("log", 0, 0)],
    }
}

fn scene(drive: &Drive) -> Scene {
    Scene {
        token: drive.token("scene", 0, 0),
        log_token: drive.token("log", 0, 0),
        nbr_samples: drive.spec.keyframes,
        first_sample_token: drive.token("sample", 0, 0),
        last_sample_token: drive.token("sample", 0, drive.spec.keyframes - 1),
        name: format!("scene-{:04}", drive.number + 1),
        description: "Simulated drive down a straight street",
    }
}

fn sample(drive: &Drive, slot: &SweepSlot) -> Sample {
    let [prev, next] = drive.neighbours("sample", 0, slot.keyframe, drive.spec.keyframes);
    Sample {
        token: drive.token("sample", 0, slot.keyframe),
        timestamp: drive.timestamp_us(slot.offset_us),
        prev,
        next,
        scene_token: drive.token("scene", 0, 0),
    }
}

fn push_lidar(tables: &mut TableSet, drive: &Drive) -> io::Result<()> {
    for (sweep, slot) in drive.slots.iter().enumerate() {
        tables.ego_pose.push(&ego_pose(drive, 0, sweep, slot.offset_us))?;
        tables.sample_data.push(&lidar_data(drive, sweep, slot))?;
    }
    if let Some(lidarseg) = &mut tables.lidarseg {
        lidarseg.extend(drive.key_slots().map(|(sweep, _)| labels(drive, sweep)))?;
    }
    Ok(())
}

fn push_cameras(tables: &mut TableSet, drive: &Drive) -> io::Result<()> {
    for (camera, channel) in cameras().iter().zip(1..) {
        for (_, slot) in drive.key_slots() {
            let exposure_us = slot.offset_us + camera.delay_us;
            tables.ego_pose.push(&ego_pose(drive, channel, slot.keyframe, exposure_us))?;
            let row = camera_data(drive, camera, channel, slot.keyframe, exposure_us);
            tables.sample_data.push(&row)?;
        }
    }
    Ok(())
}

fn ego_pose(drive: &Drive, channel: usize, step: usize, offset_us: i64) -> EgoPose {
    let world_from_ego = drive.world_from_ego(offset_us);
    EgoPose {
        token: drive.token("ego_pose", channel, step),
        timestamp: drive.timestamp_us(offset_us),
        rotation: rotation_of(&world_from_ego),
        translation: translation_of(&world_from_ego),
    }
}

fn lidar_data(drive: &Drive, sweep: usize, slot: &SweepSlot) -> SampleData {
    let [prev, next] = drive.neighbours("sample_data", 0, sweep, drive.slots.len());
    SampleData {
        token: drive.token("sample_data", 0, sweep),
        sample_token: drive.token("sample", 0, slot.keyframe),
        ego_pose_token: drive.token("ego_pose", 0, sweep),
        calibrated_sensor_token: calibration_token(0),
        timestamp: drive.timestamp_us(slot.offset_us),
        fileformat: "pcd",
        is_key_frame: slot.is_key,
        height: 0,
        width: 0,
        filename: drive.cloud_file(slot),
        prev,
        next,
    }
}

fn camera_data(
    drive: &Drive,
    camera: &Camera,
    channel: usize,
    keyframe: usize,
    exposure_us: i64,
) -> SampleData {
    let [prev, next] = drive.neighbours("sample_data", channel, keyframe, drive.spec.keyframes);
    SampleData {
        token: drive.token("sample_data", channel, keyframe),
        sample_token: drive.token("sample", 0, keyframe),
        ego_pose_token: drive.token("ego_pose", channel, keyframe),
        calibrated_sensor_token: calibration_token(channel),
        timestamp: drive.timestamp_us(exposure_us),
        fileformat: "jpg",
        is_key_frame: true,
        height: Camera::HEIGHT,
        width: Camera::WIDTH,
        filename: drive.image_file(camera, exposure_us),
        prev,
        next,
    }
}

fn labels(drive: &Drive, sweep: usize) -> Lidarseg {
    // nuScenes gives the row the token of the sample_data it labels.
    let token = drive.token("sample_data", 0, sweep);
    Lidarseg { sample_data_token: token.clone(), token, filename: drive.label_file(sweep) }
}

/// Track after track until the scene's annotations are spent; the last one may leave early.
fn push_boxes(tables: &mut TableSet, drive: &Drive, counts: &PointCounts) -> io::Result<()> {
    let keyframes = drive.spec.keyframes;
    let starts = (0..drive.annotation_count).step_by(keyframes);
    starts.enumerate().try_for_each(|(track, spent)| {
        let length = keyframes.min(drive.annotation_count - spent);
        tables.instance.push(&instance(drive, track, length))?;
        tables.sample_annotation.extend(
            drive.key_slots().take(length).map(|(_, slot)| {
                annotation(drive, track, slot, length, counts[slot.keyframe][track])
            }),
        )
    })
}

fn instance(drive: &Drive, track: usize, length: usize) -> Instance {
    Instance {
        token: instance_token(drive, track),
        category_token: category_token(drive.street.tracks[track].category),
        nbr_annotations: length,
        first_annotation_token: drive.token("sample_annotation", track, 0),
        last_annotation_token: drive.token("sample_annotation", track, length - 1),
    }
}

fn annotation(
    drive: &Drive,
    track: usize,
    slot: &SweepSlot,
    length: usize,
    num_lidar_pts: usize,
) -> SampleAnnotation {
    let thing = &drive.street.tracks[track];
    let world_from_box = thing.world_from_box(slot.time_s());
    let [box_length, width, height] = thing.size_m;
    let [prev, next] = drive.neighbours("sample_annotation", track, slot.keyframe, length);
    SampleAnnotation {
        token: drive.token("sample_annotation", track, slot.keyframe),
        sample_token: drive.token("sample", 0, slot.keyframe),
        instance_token: instance_token(drive, track),
        visibility_token: VISIBLE,
        attribute_tokens: attribute_tokens(thing.category, thing.path.speed_mps > 0.0),
        translation: translation_of(&world_from_box),
        size: [width, box_length, height],
        rotation: rotation_of(&world_from_box),
        prev,
        next,
        num_lidar_pts,
        num_radar_pts: 0,
    }
}

fn instance_token(drive: &Drive, track: usize) -> String {
    drive.token("instance", track, 0)
}
