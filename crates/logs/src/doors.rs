//! Every parser of this crate that meets bytes of a log, behind one signature: what fuzzing and the
//! tests with mutations knock at.

use std::io::{Cursor, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use occlabel_testkit::{Door, in_folder};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::kitti_labels::{class_name, decode_labels};
use crate::nuscenes::{Records, decode_mask, read_data};
use crate::points::{PointColumns, decode_points};
use crate::raw_labels::RawLabels;
use crate::semantickitti::{label_name, line_of_pose, line_of_time};
use crate::waymo::compressed;
use crate::{
    ImageFile, ReadOptions, SceneSource, WaymoLog, check_images, cloud, coda, kitti360, mcap,
    meshes, nuscenes, semantickitti,
};

/// All of them.
pub const DOORS: &[Door] = &[
    Door { name: "mcap_file", knock: mcap::doors::read_file, seeds: mcap::doors::files },
    Door { name: "mcap_message", knock: mcap::doors::read_message, seeds: mcap::doors::messages },
    Door { name: "tfrecord", knock: tfrecord, seeds: || vec![DRIVE.to_vec()] },
    Door { name: "waymo_frame", knock: waymo_frame, seeds: frames },
    Door { name: "range_image", knock: range_image, seeds: || vec![MATRIX.to_vec()] },
    Door { name: "zlib", knock: zlib, seeds: || vec![deflated(MATRIX)] },
    Door { name: "points", knock: points, seeds: || vec![vec![0; 41], vec![1; 33], vec![2; 21]] },
    Door { name: "panoptic", knock: panoptic, seeds: || vec![npz(&npy(), true)] },
    Door { name: "npy", knock: |bytes| panoptic(&npz(bytes, false)), seeds: || vec![npy()] },
    Door { name: "table", knock: table, seeds: || vec![TABLE.to_vec()] },
    Door { name: "nuscenes", knock: nuscenes::doors::drive, seeds: nuscenes::doors::files },
    Door { name: "image_header", knock: image_header, seeds: || vec![png()] },
    Door { name: "body_mask", knock: body_mask, seeds: || vec![png()] },
    Door {
        name: "kitti_labels",
        knock: kitti_labels,
        seeds: || vec![vec![40, 0, 1, 0, 10, 0, 0, 0]],
    },
    Door { name: "kitti_text", knock: kitti_text, seeds: || vec![TEXT.to_vec()] },
    Door {
        name: "semantickitti",
        knock: semantickitti::doors::sequence,
        seeds: semantickitti::doors::files,
    },
    Door { name: "cloud", knock: cloud::doors::scene, seeds: cloud::doors::files },
    #[cfg(feature = "av2")]
    Door {
        name: "argoverse2",
        knock: crate::argoverse2::doors::log,
        seeds: crate::argoverse2::doors::files,
    },
    #[cfg(feature = "waymo-v2")]
    Door {
        name: "waymo_parquet",
        knock: crate::waymo::doors::segment,
        seeds: crate::waymo::doors::files,
    },
    Door { name: "coda", knock: coda::doors::sequence, seeds: coda::doors::files },
    Door { name: "mesh_obj", knock: meshes::doors::read_obj, seeds: meshes::doors::objs },
    Door { name: "mesh_ply", knock: meshes::doors::read_ply, seeds: meshes::doors::plys },
    Door { name: "mesh_npz", knock: meshes::doors::read_arrays, seeds: meshes::doors::archives },
    Door { name: "kitti360_text", knock: kitti360::doors::text, seeds: kitti360::doors::texts },
    Door { name: "kitti360_boxes", knock: kitti360::doors::boxes, seeds: kitti360::doors::objects },
    Door { name: "kitti360_fused", knock: kitti360::doors::fused, seeds: kitti360::doors::clouds },
];

const DRIVE: &[u8] = include_bytes!("../tests/waymo/fixtures/v1/drive.tfrecord");
/// 2 x 2 x 1 floats: a packed field, and the shape.
const MATRIX: &[u8] =
    b"\x0a\x10\0\0\0\0\0\0\x80\x3f\0\0\0\x40\0\0\x40\x40\x12\x05\x0a\x03\x02\x02\x01";
const TABLE: &[u8] = br#"[ {"token": "a\"]", "size": [1.5, 2]},{"token":"b","list":[{"x":{}}]} ]"#;
const TEXT: &[u8] = b"1 0 0 1.5 0 1 0 -2e-3 0 0 1 3\n0.103736\n-1 0 0 0 0 1 0 0 0 0 -1 0\n9e8";
/// Points of a fixed file.
const POINTS: usize = 4;

pub(crate) fn read_options() -> ReadOptions {
    mcap::samples::options().read
}

fn tfrecord(bytes: &[u8]) -> bool {
    in_folder(&[("a.tfrecord", bytes)], |root| {
        let Ok(log) = WaymoLog::open(root, read_options()) else { return false };
        log.scene_names().iter().all(|name| {
            let Ok(scene) = log.load(name) else { return false };
            let read = scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count();
            scene.refused.is_empty() && read == scene.sweeps.len()
        })
    })
}

/// A frame behind a record's head, its checksums right.
fn waymo_frame(frame: &[u8]) -> bool {
    let length = (frame.len() as u64).to_le_bytes();
    let masked = |bytes: &[u8]| {
        crc32c::crc32c(bytes).rotate_right(15).wrapping_add(0xa282_ead8).to_le_bytes()
    };
    tfrecord(&[&length[..], &masked(&length), frame, &masked(frame)].concat())
}

/// The first frame of the fixture.
fn frames() -> Vec<Vec<u8>> {
    let length = DRIVE.first_chunk().map_or(0, |length| u64::from_le_bytes(*length));
    vec![DRIVE[12..12 + length as usize].to_vec()]
}

fn range_image(plain: &[u8]) -> bool {
    zlib(&deflated(plain))
}

fn zlib(bytes: &[u8]) -> bool {
    let integers = compressed::integers(bytes, 2, 1 << 10);
    compressed::floats(bytes, 1, 1 << 10).is_ok() | integers.is_ok()
}

fn deflated(plain: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(plain).unwrap();
    encoder.finish().unwrap()
}

/// The first byte tells the columns.
fn points(bytes: &[u8]) -> bool {
    let Some((columns, bytes)) = bytes.split_first() else { return false };
    let columns =
        [None, Some(PointColumns::Four), Some(PointColumns::Five)][usize::from(columns % 3)];
    decode_points(bytes, "", columns).is_ok()
}

fn panoptic(bytes: &[u8]) -> bool {
    read_data(Cursor::new(bytes), POINTS).is_ok()
}

fn npz(npy: &[u8], is_packed: bool) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let method = if is_packed { CompressionMethod::Deflated } else { CompressionMethod::Stored };
    let options = SimpleFileOptions::default().compression_method(method);
    writer.start_file("data.npy", options).unwrap();
    writer.write_all(npy).unwrap();
    writer.finish().unwrap().into_inner()
}

fn npy() -> Vec<u8> {
    let header = b"{'descr': '<u2', 'fortran_order': False, 'shape': (4,), }\n";
    [b"\x93NUMPY\x01\0", &[header.len() as u8, 0][..], header, &[1; 2 * POINTS]].concat()
}

fn table(bytes: &[u8]) -> bool {
    let mut records = Records::new(Cursor::new(bytes), "");
    loop {
        match records.next_record() {
            Ok(Some(record)) => {
                let _ = serde_json::from_slice::<serde_json::Value>(record.bytes);
            }
            Ok(None) => return true,
            Err(_) => return false,
        }
    }
}

fn body_mask(bytes: &[u8]) -> bool {
    decode_mask(bytes.to_vec(), 4, 4).is_ok()
}

fn image_header(bytes: &[u8]) -> bool {
    let image = ImageFile { file: "a".into(), size: [4, 4] };
    in_folder(&[("a", bytes)], |root| check_images(root, &[image]).is_empty())
}

fn png() -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let image = image::GrayImage::from_raw(4, 4, (0..16).collect()).unwrap();
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn kitti_labels(bytes: &[u8]) -> bool {
    let Ok(raw) = decode_labels(bytes, "", POINTS / 2) else { return false };
    let options = read_options();
    let mut labels = RawLabels::new(&options, |raw| class_name(raw, label_name));
    labels.labels(raw);
    labels.finish("", &mut Vec::new()).is_ok()
}

/// Lines of poses and times.
fn kitti_text(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.lines();
    lines.all(|line| line_of_pose(line).is_ok() | line_of_time(line).is_ok())
}
