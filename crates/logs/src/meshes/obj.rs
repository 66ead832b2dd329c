//! Wavefront OBJ: the vertices and the faces of it, as of one thing.

use nalgebra::Point3;
use occlabel_core::{Fault, TriangleMesh};

use super::polygon::fan;

/// The mesh of an OBJ file. Only `v` and `f` count; polygons are fanned.
///
/// Source: Wavefront, "Object Files (.obj)", appendix B1.
///
/// # Errors
/// If a line of these is no such line, or they are no mesh.
pub(super) fn decode(bytes: &[u8]) -> Result<TriangleMesh, Fault> {
    // What is no UTF-8 stands in names and comments, or is no number.
    let text = String::from_utf8_lossy(bytes);
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_ascii_whitespace();
        let is_read = match words.next() {
            Some("v") => vertex(words).map(|vertex| vertices.push(vertex)),
            Some("f") => face(words, vertices.len(), &mut faces),
            _ => continue,
        };
        if is_read.is_none() {
            let expected = "`v x y z`, or `f a b c …` of vertices above";
            let found = format!("`{}`", line.chars().take(60).collect::<String>());
            let fault = Fault::new("mesh-file", "an OBJ file", expected, found);
            return Err(fault.record(format!("line {}", number + 1)));
        }
    }
    TriangleMesh::new(vertices, faces)
}

fn vertex<'w>(mut words: impl Iterator<Item = &'w str>) -> Option<Point3<f64>> {
    let mut next = || words.next()?.parse().ok();
    Some(Point3::new(next()?, next()?, next()?))
}

/// `count` vertices stand above: corners count them from 1, or back from the last as -1.
fn face<'w>(
    words: impl Iterator<Item = &'w str>,
    count: usize,
    faces: &mut Vec<[u32; 3]>,
) -> Option<()> {
    let corner = |word: &str| {
        let number: i64 = word.split('/').next()?.parse().ok()?;
        let at = if number < 0 { number.checked_add(count as i64)? } else { number - 1 };
        u32::try_from(at).ok().filter(|&at| (at as usize) < count)
    };
    let corners: Option<Vec<u32>> = words.map(corner).collect();
    fan(&corners?, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "# a square\nmtllib a.mtl\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1e0 0\nvn 0 0 1\n";

    fn faces(lines: &str) -> Vec<[u32; 3]> {
        decode(format!("{SQUARE}{lines}").as_bytes()).unwrap().faces().to_vec()
    }

    #[test]
    fn corners_are_numbers_with_or_without_textures_and_normals() {
        assert_eq!(faces("f 1 2 3"), [[0, 1, 2]]);
        assert_eq!(faces("f 1/7 2/8 3/9\r\nf 1//1 3//1 4//1"), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(faces("g a\nusemtl b\ns off\nf -4/1/1 -3/2/1 -1/3/1"), [[0, 1, 3]]);
        assert_eq!(faces("f 1 2 3 4"), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn what_is_no_mesh_is_refused_with_its_line() {
        for line in ["f 1 2", "f 1 2 5", "f 0 1 2", "f 1 2 -5", "f a b c", "f", "v 1 2", "v 1 2 x"]
        {
            let fault = decode(format!("{SQUARE}f 1 2 3\n{line}").as_bytes()).unwrap_err();
            assert_eq!(fault.record.as_deref(), Some("line 9"), "{line}");
        }
        assert_eq!(decode(SQUARE.as_bytes()).unwrap_err().expected, "triangles");
        assert!(decode(b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").is_err());
        assert!(decode(&[0xff, 0xfe, 0, 1]).is_err());
    }
}
