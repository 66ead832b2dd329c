//! Parsers of meshes, to knock at.

use super::{arrays, obj, ply};

pub(crate) fn read_obj(bytes: &[u8]) -> bool {
    obj::decode(bytes).is_ok()
}

pub(crate) fn read_ply(bytes: &[u8]) -> bool {
    ply::decode(bytes).is_ok()
}

pub(crate) fn read_arrays(bytes: &[u8]) -> bool {
    arrays::decode(bytes).is_ok()
}

pub(crate) fn objs() -> Vec<Vec<u8>> {
    vec![b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf -4/1/1 -3//2 -1/3\nf 1 2 3 4\n".to_vec()]
}

pub(crate) fn plys() -> Vec<Vec<u8>> {
    let text: &[u8] =
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 1 0 0 0 1 0 3 0 1 2\n";
    let head =
        b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty char y\n\
        property ushort z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n";
    let binary = [&head[..], &[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 3, 0, 1, 2]].concat();
    vec![text.to_vec(), binary]
}

pub(crate) fn archives() -> Vec<Vec<u8>> {
    use std::io::{Cursor, Write};

    let array = |descr: &str, shape: &str, data: &[u8]| {
        let header =
            format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
        [b"\x93NUMPY\x01\0", &[header.len() as u8, 0][..], header.as_bytes(), data].concat()
    };
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    for (name, bytes) in [
        ("vertices.npy", array("<f4", "(1, 3, 3)", &[0; 36])),
        ("faces.npy", array("<i4", "(1, 3)", &[0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0])),
        ("track_ids.npy", array("<U1", "(1,)", &[65, 0, 0, 0])),
    ] {
        archive.start_file(name, options).unwrap();
        archive.write_all(&bytes).unwrap();
    }
    vec![archive.finish().unwrap().into_inner()]
}
