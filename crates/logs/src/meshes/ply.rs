//! PLY, as text or binary: the vertices and the faces of it.

use nalgebra::Point3;
use occlabel_core::{Fault, TriangleMesh};

use super::polygon::fan;

/// Longer headers are refused.
const MAX_HEADER_BYTES: usize = 1 << 16;

/// The mesh of a PLY file: `x y z` of `vertex`, `vertex_indices` (or `vertex_index`) of `face`; all else
/// is passed over. Nothing is reserved that a header declares.
///
/// Source: G. Turk, "The PLY Polygon File Format", 1994.
///
/// # Errors
/// If it is no such file, or no mesh.
pub(super) fn decode(bytes: &[u8]) -> Result<TriangleMesh, Fault> {
    let fault = |found: &str| {
        let expected = "PLY with x, y, z of vertices, and vertex_indices of faces";
        Fault::new("mesh-file", "a PLY file", expected, found)
    };
    let (header, body) = header(bytes).ok_or_else(|| fault("another header"))?;
    let (mut numbers, elements) = parse(header, body).ok_or_else(|| fault("another header"))?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for element in &elements {
        let read = match element.name {
            "vertex" => element.vertices(&mut numbers, &mut vertices),
            "face" => element.faces(&mut numbers, &mut faces),
            _ => element.pass(&mut numbers),
        };
        read.ok_or_else(|| fault(&format!("other data of `{}`", element.name)))?;
    }
    TriangleMesh::new(vertices, faces)
}

/// Things of a kind, one after the other.
struct Element<'a> {
    name: &'a str,
    count: u64,
    properties: Vec<Property<'a>>,
}

struct Property<'a> {
    name: &'a str,
    number: Number,
    /// Of a list: how its length is written.
    length: Option<Number>,
}

/// How a number is written.
#[derive(Clone, Copy)]
struct Number {
    bytes: usize,
    kind: Kind,
}

#[derive(Clone, Copy)]
enum Kind {
    Signed,
    Unsigned,
    Float,
}

/// Numbers that are still to be read.
enum Numbers<'a> {
    Text(std::str::SplitAsciiWhitespace<'a>),
    Binary { bytes: &'a [u8], is_big_endian: bool },
}

/// The text of the header, and what follows it.
fn header(bytes: &[u8]) -> Option<(&str, &[u8])> {
    const END: &[u8] = b"end_header";
    let start = &bytes[..bytes.len().min(MAX_HEADER_BYTES)];
    let end = start.windows(END.len()).position(|word| word == END)?;
    let line = end + END.len();
    let body = match bytes.get(line..)? {
        [b'\r', b'\n', body @ ..] | [b'\n' | b'\r', body @ ..] => body,
        _ => return None,
    };
    Some((std::str::from_utf8(&bytes[..end]).ok()?, body))
}

fn parse<'a>(header: &'a str, body: &'a [u8]) -> Option<(Numbers<'a>, Vec<Element<'a>>)> {
    let mut lines = header.lines().map(|line| line.split_ascii_whitespace().collect::<Vec<_>>());
    if lines.next()? != ["ply"] {
        return None;
    }
    let (mut numbers, mut elements) = (None, Vec::<Element>::new());
    for line in lines {
        match line[..] {
            [] | ["comment" | "obj_info", ..] => {}
            ["format", format, "1.0"] => numbers = Some(Numbers::new(format, body)?),
            ["element", name, count] => {
                elements.push(Element { name, count: count.parse().ok()?, properties: Vec::new() });
            }
            ["property", "list", length, number, name] => {
                let length = Some(Number::named(length)?);
                let number = Number::named(number)?;
                elements.last_mut()?.properties.push(Property { name, number, length });
            }
            ["property", number, name] => {
                let number = Number::named(number)?;
                elements.last_mut()?.properties.push(Property { name, number, length: None });
            }
            _ => return None,
        }
    }
    // What takes no bytes could be there any number of times.
    let takes_bytes = elements.iter().all(|element| !element.properties.is_empty());
    Some((numbers?, elements)).filter(|_| takes_bytes)
}

impl Element<'_> {
    fn vertices(&self, numbers: &mut Numbers, vertices: &mut Vec<Point3<f64>>) -> Option<()> {
        let place = |name| self.properties.iter().position(|property| property.name == name);
        let places = [place("x")?, place("y")?, place("z")?];
        for _ in 0..self.count {
            let mut vertex = Point3::origin();
            for (at, property) in self.properties.iter().enumerate() {
                let value = property.read(numbers)?;
                if let Some(axis) = places.iter().position(|&place| place == at) {
                    vertex[axis] = *value.first().filter(|_| property.length.is_none())?;
                }
            }
            vertices.push(vertex);
        }
        Some(())
    }

    fn faces(&self, numbers: &mut Numbers, faces: &mut Vec<[u32; 3]>) -> Option<()> {
        let is_corners = |name| ["vertex_indices", "vertex_index"].contains(&name);
        let corners = self.properties.iter().position(|property| is_corners(property.name))?;
        for _ in 0..self.count {
            for (at, property) in self.properties.iter().enumerate() {
                let values = property.read(numbers)?;
                if at == corners {
                    let numbers: Option<Vec<u32>> = values.into_iter().map(whole).collect();
                    fan(&numbers?, faces)?;
                }
            }
        }
        Some(())
    }

    fn pass(&self, numbers: &mut Numbers) -> Option<()> {
        for _ in 0..self.count {
            self.properties.iter().try_for_each(|property| property.read(numbers).map(drop))?;
        }
        Some(())
    }
}

impl Property<'_> {
    fn read(&self, numbers: &mut Numbers) -> Option<Vec<f64>> {
        let count = match self.length {
            None => 1,
            Some(length) => whole(numbers.next(length)?)?,
        };
        (0..count).map(|_| numbers.next(self.number)).collect()
    }
}

impl Number {
    fn named(name: &str) -> Option<Self> {
        let (bytes, kind) = match name {
            "char" | "int8" => (1, Kind::Signed),
            "uchar" | "uint8" => (1, Kind::Unsigned),
            "short" | "int16" => (2, Kind::Signed),
            "ushort" | "uint16" => (2, Kind::Unsigned),
            "int" | "int32" => (4, Kind::Signed),
            "uint" | "uint32" => (4, Kind::Unsigned),
            "float" | "float32" => (4, Kind::Float),
            "double" | "float64" => (8, Kind::Float),
            _ => return None,
        };
        Some(Self { bytes, kind })
    }
}

impl<'a> Numbers<'a> {
    fn new(format: &str, body: &'a [u8]) -> Option<Self> {
        match format {
            "ascii" => Some(Self::Text(std::str::from_utf8(body).ok()?.split_ascii_whitespace())),
            "binary_little_endian" => Some(Self::Binary { bytes: body, is_big_endian: false }),
            "binary_big_endian" => Some(Self::Binary { bytes: body, is_big_endian: true }),
            _ => None,
        }
    }

    fn next(&mut self, number: Number) -> Option<f64> {
        match self {
            Self::Text(words) => words.next()?.parse().ok(),
            Self::Binary { bytes, is_big_endian } => {
                let (own, rest) = bytes.split_at_checked(number.bytes)?;
                *bytes = rest;
                let mut word = [0; 8];
                word[..own.len()].copy_from_slice(own);
                if *is_big_endian {
                    word[..own.len()].reverse();
                }
                Some(number.of_word(u64::from_le_bytes(word)))
            }
        }
    }
}

impl Number {
    /// The number whose bits are the last ones of a word.
    fn of_word(self, word: u64) -> f64 {
        let unused = 64 - 8 * self.bytes as u32;
        match (self.kind, self.bytes) {
            (Kind::Float, 4) => f64::from(f32::from_bits(word as u32)),
            (Kind::Float, _) => f64::from_bits(word),
            (Kind::Unsigned, _) => word as f64,
            (Kind::Signed, _) => ((word << unused) as i64 >> unused) as f64,
        }
    }
}

fn whole(number: f64) -> Option<u32> {
    let cut = number as u32;
    (f64::from(cut) == number).then_some(cut)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A triangle and a square, with what nobody asked for between.
    pub(in crate::meshes) fn file(format: &str) -> Vec<u8> {
        let header = format!(
            "ply\nformat {format} 1.0\ncomment by hand\nelement vertex 5\nproperty float x\n\
             property double y\nproperty uchar red\nproperty float z\nelement edge 1\n\
             property short a\nproperty list uchar float b\nelement face 2\n\
             property list uchar int vertex_indices\nend_header\n"
        );
        let mut file = header.into_bytes();
        let mut put = |bytes: &[u8], number: f64| match format {
            "ascii" => file.extend(format!("{number} ").bytes()),
            "binary_big_endian" => file.extend(bytes.iter().rev()),
            _ => file.extend(bytes),
        };
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 2.5)] {
            put(&(x as f32).to_le_bytes(), x);
            put(&f64::to_le_bytes(y), y);
            put(&[200], 200.0);
            put(&(-1.5_f32).to_le_bytes(), -1.5);
        }
        put(&(-7_i16).to_le_bytes(), -7.0);
        put(&[1], 1.0);
        put(&0.25_f32.to_le_bytes(), 0.25);
        for corners in [&[3, 2, 4][..], &[0, 1, 2, 3]] {
            put(&[corners.len() as u8], corners.len() as f64);
            corners.iter().for_each(|&at: &i32| put(&at.to_le_bytes(), f64::from(at)));
        }
        file
    }

    #[test]
    fn text_and_both_binary_forms_are_read_alike() {
        let text = decode(&file("ascii")).unwrap();
        assert_eq!(text.faces(), [[3, 2, 4], [0, 1, 2], [0, 2, 3]]);
        assert_eq!(text.vertices()[4], Point3::new(0.5, 2.5, -1.5));
        assert_eq!(decode(&file("binary_little_endian")).unwrap(), text);
        assert_eq!(decode(&file("binary_big_endian")).unwrap(), text);
    }

    #[test]
    fn fault_34_declared_counts_reserve_nothing_and_end() {
        let with = |from: &str, to: &str| {
            let text = String::from_utf8(file("ascii")).unwrap();
            assert!(text.contains(from));
            decode(text.replace(from, to).as_bytes())
        };
        assert!(with("vertex 5", "vertex 18446744073709551615").is_err());
        assert!(with("face 2", "face 99999999999").is_err());
        let nothing = "element edge 18446744073709551615\nelement face 2";
        assert!(with("element face 2", nothing).is_err(), "elements without properties");
        assert!(with("ascii", "latin").is_err() && with("end_header", "end").is_err());
        assert!(with("float z", "float w").is_err() && with("vertex_indices", "corners").is_err());
        let cut = file("binary_little_endian");
        assert!((0..cut.len()).all(|end| decode(&cut[..end]).is_err()));
    }
}
