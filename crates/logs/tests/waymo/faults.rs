//! Faults of v1, case by case: what says where, and what it costs.

use occlabel_core::{ClassId, Fault, Loss, PointLabel, Scene};
use occlabel_logs::{ReadOptions, SceneSource, WaymoLog};

use crate::log::{MICROS, SEGMENT, first_sweep, folder, folder_of, frames, load, options};
use crate::message::{compressed, edit, recompressed, record, with_double, without};

/// The first frame, changed at a path, and the others.
fn first_changed(path: &[(u64, usize)], mut change: impl FnMut(&[u8]) -> Vec<u8>) -> Vec<Vec<u8>> {
    let mut frames = frames();
    frames[0] = edit(&frames[0], path, &mut change);
    frames
}

/// What the only scene of a file is refused for.
fn refusal(bytes: &[u8]) -> Fault {
    let root = folder_of(bytes);
    let log = WaymoLog::open(root.path(), options());
    log.and_then(|log| log.load(&log.scene_names()[0])).unwrap_err()
}

/// Rules of what a scene lost.
fn lost(scene: &Scene) -> Vec<(Loss, &'static str)> {
    scene.refused.iter().map(|refusal| (refusal.loss, refusal.fault.rule)).collect()
}

fn file() -> Vec<u8> {
    frames().iter().flat_map(|frame| record(frame)).collect()
}

#[test]
fn a_record_that_is_cut_off_says_where() {
    let file = file();
    let fault = refusal(&file[..file.len() - 100]);
    let third = (file.len() - frames()[2].len() - 4) as u64;
    assert_eq!((fault.rule, fault.offset), ("record-cut-off", Some(third)));
    assert_eq!(refusal(&file[..file.len() - frames()[2].len() - 10]).rule, "record-cut-off");
    assert_eq!(refusal(&file[..7]).rule, "record-cut-off", "nothing but half a head");
}

#[test]
fn a_length_that_is_no_length_says_where() {
    let mut bytes = file();
    let second = frames()[0].len() + 16;
    bytes[second + 9] ^= 1;
    let fault = refusal(&bytes);
    assert_eq!((fault.rule, fault.offset), ("record-length", Some(second as u64)));
    assert!(fault.to_string().starts_with("drive.tfrecord (at byte "), "{fault}");
}

#[test]
fn fault_34_a_giant_length_is_not_believed() {
    for length in [u64::MAX, 1 << 62, (1 << 30) + 1, 1 << 29] {
        let bytes = length.to_le_bytes();
        let checksum = crc32c::crc32c(&bytes).rotate_right(15).wrapping_add(0xa282_ead8);
        let fault = refusal(&[&bytes[..], &checksum.to_le_bytes(), &[0; 64]].concat());
        assert!(["record-length", "record-cut-off"].contains(&fault.rule), "{fault}");
    }
}

#[test]
fn a_flipped_bit_is_found_when_the_points_are_read() {
    let mut bytes = file();
    let place = bytes.len() - 30;
    bytes[place] ^= 0x10;
    let root = folder_of(&bytes);
    let log = WaymoLog::open(root.path(), options()).unwrap();
    let scene = log.load(SEGMENT).unwrap();
    let faults: Vec<Fault> =
        scene.sweeps.iter().filter_map(|sweep| log.read_sweep(sweep).err()).collect();
    assert_eq!(faults.len(), 5, "all lidars of the third frame");
    assert!(faults.iter().all(|fault| fault.rule == "record-checksum" && fault.offset.is_some()));
}

#[test]
fn a_record_that_is_no_frame_spoils_its_file() {
    let fault = refusal(&[record(&frames()[0]), record(&[0x0b, 1, 2])].concat());
    assert_eq!(fault.rule, "frame-message");
    assert_eq!(fault.offset, Some(frames()[0].len() as u64 + 16 + 12));
    let nameless = edit(&frames()[0], &[(1, 0)], &mut |context| without(context, 1));
    assert_eq!(refusal(&record(&nameless)).expected, "a context with a name");
}

#[test]
fn fault_14_a_mirrored_extrinsic_is_refused() {
    let path = [(1, 0), (3, 0), (5, 0)];
    let mirrored = |numbers: &[u8]| {
        (8..11).fold(numbers.to_vec(), |bytes, place| {
            let number =
                f64::from_le_bytes(bytes[9 * place + 1..9 * place + 9].try_into().unwrap());
            with_double(&bytes, place, -number)
        })
    };
    let bent = first_changed(&path, mirrored);
    assert_eq!(lost(&load(&bent).unwrap()), [(Loss::Keyframe, "lidar-extrinsic")]);
    let fault = load(&bent[..1]).unwrap_err();
    assert_eq!(fault.rule, "lidar-extrinsic");
    assert!(fault.found.starts_with("a determinant of -"), "{fault}");
    for number in [f64::NAN, f64::INFINITY, 7.0] {
        let bent = first_changed(&path, |bytes| with_double(bytes, 0, number));
        let fault = load(&bent[..1]).unwrap_err();
        assert_eq!(fault.rule, "lidar-extrinsic", "{fault}");
    }
}

#[test]
fn fault_14_a_frame_with_a_broken_pose_is_lost_alone() {
    let mut bent = frames();
    bent[1] = edit(&bent[1], &[(3, 0)], &mut |numbers| with_double(numbers, 5, 3.0));
    let scene = load(&bent).unwrap();
    assert_eq!(lost(&scene), [(Loss::Keyframe, "frame-pose")]);
    assert_eq!((scene.sweeps.len(), scene.keyframes.len()), (10, 2));
    assert!(scene.refused[0].fault.to_string().contains(&MICROS[1].to_string()));
}

#[test]
fn a_camera_that_no_camera_can_be_is_lost_alone() {
    let nan = first_changed(&[(1, 0), (2, 1), (3, 0)], |bytes| with_double(bytes, 3, f64::NAN));
    let scene = load(&nan).unwrap();
    assert_eq!(lost(&scene), [(Loss::Camera, "camera-extrinsic")]);
    assert_eq!(scene.cameras.len(), 4);
    let short = first_changed(&[(1, 0), (2, 0)], |bytes| without(bytes, 2));
    assert_eq!(lost(&load(&short).unwrap()), [(Loss::Camera, "camera-model")]);
    let flat = first_changed(&[(1, 0), (2, 0)], |bytes| without(bytes, 5));
    assert_eq!(lost(&load(&flat).unwrap()), [(Loss::Camera, "camera-size")]);
    let unmoved = first_changed(&[(4, 0), (3, 0)], |bytes| with_double(bytes, 0, f64::NAN));
    assert_eq!(lost(&load(&unmoved).unwrap()), [(Loss::Camera, "camera-pose")]);
}

#[test]
fn fault_23_a_box_without_size_pose_or_id_is_refused_alone() {
    let changed = |field| first_changed(&[(6, 0), (1, 0)], move |bytes| without(bytes, field));
    assert_eq!(lost(&load(&changed(4)).unwrap()), [(Loss::Annotation, "box-size")]);
    assert_eq!(lost(&load(&changed(7)).unwrap()), [(Loss::Annotation, "box-pose")]);
    let nameless = load(&first_changed(&[(6, 0)], |bytes| without(bytes, 4))).unwrap();
    assert_eq!(lost(&nameless), [(Loss::Annotation, "box-id")]);
    assert_eq!(nameless.tracks[1].boxes.len(), 2);
}

#[test]
fn section_2_two_boxes_of_a_track_in_a_frame_are_a_fault() {
    let again = first_changed(&[(6, 1), (4, 0)], |_| b"b-car".to_vec());
    let scene = load(&again).unwrap();
    assert_eq!(lost(&scene), [(Loss::Annotation, "track-category")], "a walker is no car");
    let twice = first_changed(&[(6, 1)], |_| {
        let mut car = Vec::new();
        edit(&frames()[0], &[(6, 0)], &mut |bytes| {
            car = bytes.to_vec();
            car.clone()
        });
        car
    });
    assert_eq!(load(&twice).unwrap_err().rule, "track-time");
}

#[test]
fn fault_26_unknown_types_and_classes_are_told_with_their_counts() {
    let strange: Vec<Vec<u8>> = frames()
        .iter()
        .map(|frame| edit(frame, &[(6, 0)], &mut |label| [label, &[0x18, 9]].concat()))
        .collect();
    let fault = load(&strange).unwrap_err();
    assert_eq!((fault.rule, fault.found.as_str()), ("unknown-category", "`9` of 3 boxes"));
    // All 8 x 36 pixels of class 40: each label is a pair of instance 0 and class 40.
    let classes = first_changed(&[(5, 0), (2, 0), (6, 0)], |_| labels([0, 40].repeat(8 * 36), 8));
    let fault = first_sweep(&classes, "TOP").unwrap_err();
    assert_eq!(fault.rule, "unknown-label");
    assert!(fault.found.starts_with("40 (40) of "), "{fault}");
    let root = folder(&classes);
    let taken = ReadOptions { unknown_as: Some(ClassId(3)), ..options() };
    let log = WaymoLog::open(root.path(), taken).unwrap();
    let sweep = &log.load(SEGMENT).unwrap().sweeps[4];
    let points = log.read_sweep(sweep).unwrap();
    assert!(points.cloud.labels.contains(&PointLabel::Class(ClassId(3))));
    let [warning] = &points.warnings[..] else { panic!("{:?}", points.warnings) };
    assert_eq!(warning.found, format!("{}, taken as `BUS`", points.unknown));
    assert_eq!(warning.record.as_deref(), Some(sweep.source_id.as_str()));
}

/// A matrix of labels of 36 columns.
fn labels(values: Vec<u8>, rows: u8) -> Vec<u8> {
    let length = [values.len() as u8 & 0x7f | 0x80, (values.len() >> 7) as u8];
    let shape = [0x12, 6, 0x08, rows, 0x08, 36, 0x08, 2];
    compressed(&[&[0x0a], &length[..], &values, &shape].concat())
}

#[test]
fn fault_15_a_copied_frame_counts_once_and_a_different_one_is_refused() {
    let [first, second, _] = <[Vec<u8>; 3]>::try_from(frames()).unwrap();
    let scene = load(&[first.clone(), first.clone(), second.clone()]).unwrap();
    assert_eq!((scene.sweeps.len(), scene.refused.len()), (10, 0));
    assert_eq!(scene.warnings[0].rule, "frame-time");
    let other = without(&first, 7);
    let scene = load(&[first, other, second]).unwrap();
    assert_eq!(lost(&scene), [(Loss::Keyframe, "frame-time")]);
    assert_eq!(scene.sweeps.len(), 10);
}

#[test]
fn fault_27_images_of_the_wrong_shape_are_refused() {
    let top = |field, change: fn(Vec<u8>) -> Vec<u8>| {
        let path = [(5, 0), (2, 0), (field, 0)];
        first_sweep(&first_changed(&path, |bytes| recompressed(bytes, change)), "TOP")
    };
    let rows = |mut bytes: Vec<u8>| {
        let place = bytes.len() - 5;
        bytes[place] += 1;
        bytes
    };
    for field in [2, 4, 6] {
        let fault = top(field, rows).unwrap_err();
        assert_eq!(fault.rule, "range-image", "{fault}");
        assert!(fault.record.as_deref().unwrap().ends_with("/TOP"), "{fault}");
    }
    assert!(top(2, |bytes| bytes).is_ok());
    assert_eq!(
        top(2, |bytes| bytes[..bytes.len() - 8].to_vec()).unwrap_err().found,
        "a matrix without a shape"
    );
    let other = first_changed(&[(5, 0), (2, 0), (6, 0)], |_| labels([0, 4].repeat(7 * 36), 7));
    assert_eq!(first_sweep(&other, "TOP").unwrap_err().rule, "range-image", "7 rows, not 8");
}

#[test]
fn fault_34_a_zlib_bomb_is_given_up_at_the_images_size() {
    let bomb = compressed(&vec![0; 200 << 20]);
    assert!(bomb.len() < 2 << 20);
    for (field, number) in [(2, "67109120"), (4, "7168"), (6, "6016")] {
        let changed = first_changed(&[(5, 0), (2, 0), (field, 0)], |_| bomb.clone());
        let fault = first_sweep(&changed, "TOP").unwrap_err();
        assert_eq!(fault.found, format!("more than {number} bytes behind zlib"));
    }
    let broken = first_changed(&[(5, 1), (2, 0), (2, 0)], |bytes| bytes[..40].to_vec());
    assert!(first_sweep(&broken, "FRONT").unwrap_err().found.starts_with("zlib: "));
}

#[test]
fn a_lidar_without_images_or_calibration_is_no_sweep() {
    let blind = first_changed(&[(5, 1)], |bytes| without(bytes, 2));
    assert_eq!(load(&blind).unwrap().sweeps.len(), 14);
    let all: Vec<Vec<u8>> = frames().iter().map(|frame| without(frame, 5)).collect();
    assert_eq!(load(&all).unwrap_err().rule, "no-sweeps");
    let strange: Vec<Vec<u8>> = frames()
        .iter()
        .map(|frame| edit(frame, &[(1, 0), (3, 1)], &mut |bytes| without(bytes, 1)))
        .collect();
    let scene = load(&strange).unwrap();
    assert_eq!(lost(&scene), [(Loss::Sweep, "lidar-calibration"); 3]);
    assert_eq!(scene.sweeps.len(), 12);
}

#[test]
fn calibrations_that_change_within_a_segment_are_refused() {
    let mut bent = frames();
    bent[2] = edit(&bent[2], &[(1, 0), (3, 0), (5, 0)], &mut |bytes| with_double(bytes, 3, 1.5));
    assert_eq!(lost(&load(&bent).unwrap()), [(Loss::Keyframe, "lidar-changed")]);
    let path = [(1, 0), (3, 0)];
    let rows = first_changed(&path, |bytes| [bytes, &[0x11, 0, 0, 0, 0, 0, 0, 0, 0]].concat());
    let fault = first_sweep(&rows[..1], "TOP").unwrap_err();
    assert_eq!(fault.found, "9 inclinations for 8 rows");
}

#[test]
fn fault_36_a_name_that_is_a_path_is_refused() {
    for name in ["../x", "a/b", "", "a\u{1b}[31m"] {
        let named = first_changed(&[(1, 0), (1, 0)], |_| name.as_bytes().to_vec());
        assert_eq!(load(&named[..1]).unwrap_err().rule, "scene-name", "{name:?}");
    }
}

#[test]
fn a_folder_of_neither_version_says_what_it_should_hold() {
    let root = tempfile::tempdir().unwrap();
    std::fs::write(root.path().join("README"), "frames are elsewhere").unwrap();
    let fault = WaymoLog::open(root.path(), options()).unwrap_err();
    assert_eq!((fault.rule, fault.found.as_str()), ("waymo-layout", "neither"));
    std::fs::write(root.path().join("frames"), record(&frames()[0])).unwrap();
    assert!(WaymoLog::open(root.path(), options()).is_ok(), "told by content, not by name");
}

#[cfg(not(feature = "waymo-v2"))]
#[test]
fn a_program_without_v2_says_which_feature_it_lacks() {
    let fault = WaymoLog::open(&crate::log::fixtures().join("v2"), options()).unwrap_err();
    assert_eq!(fault.rule, "waymo-v2");
    assert!(fault.expected.contains("`waymo-v2`"), "{fault}");
}
