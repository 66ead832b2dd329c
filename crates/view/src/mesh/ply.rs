//! PLY files, binary little-endian.
//!
//! Source: G. Turk, "The PLY Polygon File Format", 1994. The format is a few lines of text before the
//! packed numbers, which point clouds of MCAP files share: no crate is needed to write it.

use occlabel_core::printable;

use crate::rows::{COLOR, Kind, POSITION, Rows, occupied_rows};
use crate::{ShownKeyframe, ShownScene};

use super::corner_m;
use super::quads::{Quad, quads};

/// The centres of a keyframe's occupied voxels, in the grid frame, metres: with class, colour, and track,
/// hits and crossings where they are known.
pub fn ply_points(keyframe: &ShownKeyframe, scene: &ShownScene) -> Vec<u8> {
    let rows = occupied_rows(keyframe, scene);
    let mut bytes = header(keyframe, scene, &rows, None).into_bytes();
    bytes.extend(rows.bytes);
    bytes
}

/// The occupied voxels of a keyframe as closed solids, one a class and track, made of rectangles that
/// look outwards. Each corner has its class, colour and track.
pub fn ply_cubes(keyframe: &ShownKeyframe, scene: &ShownScene) -> Vec<u8> {
    let kind = |voxel| {
        let class = *keyframe.semantics.at(voxel);
        let track = keyframe.instances.as_ref().map_or(0, |instances| *instances.at(voxel));
        scene.is_occupied(class).then_some((class, track))
    };
    let quads = quads(keyframe.spec.shape(), kind);
    let rows = corner_rows(&quads, keyframe, scene);
    let mut bytes = header(keyframe, scene, &rows, Some(quads.len())).into_bytes();
    bytes.extend(rows.bytes);
    for first in (0..quads.len() as u32).map(|quad| 4 * quad) {
        bytes.push(4);
        bytes.extend((first..first + 4).flat_map(u32::to_le_bytes));
    }
    bytes
}

fn corner_rows(quads: &[Quad<(u8, u16)>], keyframe: &ShownKeyframe, scene: &ShownScene) -> Rows {
    let columns = POSITION.into_iter().chain([("class", Kind::U8)]).chain(COLOR);
    let mut rows = Rows::new(columns.chain([("track", Kind::U16)]));
    for quad in quads {
        let (class, track) = quad.kind;
        for corner in quad.corners() {
            rows.position(corner_m(&keyframe.spec, corner));
            rows.byte(class);
            rows.color(scene.palette.color(class));
            rows.short(track);
        }
    }
    rows
}

/// Up to the numbers. What a class is called stands in comments.
fn header(
    keyframe: &ShownKeyframe,
    scene: &ShownScene,
    rows: &Rows,
    faces: Option<usize>,
) -> String {
    let mut lines = vec!["ply".to_owned(), "format binary_little_endian 1.0".to_owned()];
    lines.push(format!("comment keyframe {}", printable(&keyframe.token)));
    lines.push(format!("comment metres in the {} frame", printable(&scene.frame)));
    let classes = (0..scene.free).map(|id| (id, scene.palette.label(id)));
    lines.extend(classes.map(|(id, name)| format!("comment class {id} {}", printable(&name))));
    lines.push(format!("element vertex {}", rows.len()));
    let property = |(name, kind): &(&str, Kind)| format!("property {} {name}", type_name(*kind));
    lines.extend(rows.columns.iter().map(property));
    if let Some(faces) = faces {
        lines.push(format!("element face {faces}"));
        lines.push("property list uchar int vertex_indices".to_owned());
    }
    lines.push("end_header\n".to_owned());
    lines.join("\n")
}

fn type_name(kind: Kind) -> &'static str {
    match kind {
        Kind::U8 => "uchar",
        Kind::U16 => "ushort",
        Kind::F32 => "float",
    }
}
