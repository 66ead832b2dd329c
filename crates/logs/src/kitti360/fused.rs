//! Labels of what stands still, from a cloud that was fused of many scans.

use occlabel_core::Fault;

/// The side of a cell, metres: points of one cell share a label.
const CELL_M: f64 = 0.2;
/// What a header ends with.
const END: &[u8] = b"end_header\n";

/// By cell of the world: the class that most of its points have, of two the lower.
#[derive(Debug, Default)]
pub(super) struct FusedLabels {
    /// In order of cells.
    cells: Vec<([i32; 3], u16)>,
}

/// Where a point's numbers stand in its bytes.
struct Record {
    bytes: usize,
    /// x, y, z as f32, and the class as i32.
    offsets: [usize; 4],
}

impl FusedLabels {
    /// Reads a PLY file: binary, little-endian, one element of properties `x`, `y`, `z`, `semantic`
    /// and others.
    ///
    /// # Errors
    /// If it is no such file, or has another length than it says.
    pub(super) fn read(bytes: &[u8], file: &str) -> Result<Self, Fault> {
        let broken = |found: String| {
            let expected = "a binary PLY file of points with x, y, z, semantic";
            Fault::new("fused-labels", file, expected, found)
        };
        let end = bytes.windows(END.len()).take(4096).position(|part| part == END);
        let end = end.ok_or_else(|| broken("no header".into()))?;
        let record = Record::of_header(&String::from_utf8_lossy(&bytes[..end])).map_err(broken)?;
        let body = &bytes[end + END.len()..];
        if !body.len().is_multiple_of(record.bytes) {
            let (length, each) = (body.len(), record.bytes);
            return Err(broken(format!("{length} bytes of points of {each} bytes")));
        }
        Ok(Self::of_points(body.chunks_exact(record.bytes).filter_map(|point| record.read(point))))
    }

    fn of_points(points: impl Iterator<Item = ([f64; 3], u16)>) -> Self {
        let mut points: Vec<_> = points.map(|(place, class)| (cell(place), class)).collect();
        points.sort_unstable();
        let cells = points.chunk_by(|a, b| a.0 == b.0).map(|of_cell| {
            let classes = of_cell.chunk_by(|a, b| a.1 == b.1);
            // Of equal counts the first wins, which has the lower number.
            let most = classes.rev().max_by_key(|of_class| of_class.len());
            (of_cell[0].0, most.map_or(0, |of_class| of_class[0].1))
        });
        Self { cells: cells.collect() }
    }

    /// The class at a place in world, if any point was near.
    pub(super) fn class_at(&self, place: [f64; 3]) -> Option<u16> {
        let found = self.cells.binary_search_by_key(&cell(place), |(cell, _)| *cell);
        found.ok().map(|at| self.cells[at].1)
    }
}

/// Saturates; a place that is not finite falls into some cell, and no point lies there.
fn cell(place: [f64; 3]) -> [i32; 3] {
    place.map(|metres| (metres / CELL_M).floor() as i32)
}

impl Record {
    fn of_header(header: &str) -> Result<Self, String> {
        if !header.contains("format binary_little_endian") {
            return Err("another format".into());
        }
        let (mut bytes, mut properties) = (0, Vec::new());
        for line in header.lines().filter_map(|line| line.strip_prefix("property ")) {
            let (kind, name) = line.split_once(' ').ok_or("a property without a name")?;
            properties.push((name.trim(), kind, bytes));
            bytes += match kind {
                "char" | "uchar" | "int8" | "uint8" => 1,
                "short" | "ushort" | "int16" | "uint16" => 2,
                "int" | "uint" | "float" | "int32" | "uint32" | "float32" => 4,
                "double" | "float64" => 8,
                other => return Err(format!("a property of type `{other}`")),
            };
        }
        let offset = |name: &str, kinds: [&str; 2]| {
            let is_it = |of: &&(&str, &str, usize)| of.0 == name && kinds.contains(&of.1);
            let found = properties.iter().find(is_it).map(|of| of.2);
            found.ok_or_else(|| format!("no {} `{name}`", kinds[0]))
        };
        let (float, int) = (["float", "float32"], ["int", "int32"]);
        let offsets = [
            offset("x", float)?,
            offset("y", float)?,
            offset("z", float)?,
            offset("semantic", int)?,
        ];
        Ok(Self { bytes, offsets })
    }

    /// Place and class of a point; none if nobody labelled it.
    fn read(&self, point: &[u8]) -> Option<([f64; 3], u16)> {
        let word = |at: usize| point[self.offsets[at]..].first_chunk::<4>().copied();
        let metres = |at| word(at).map(|word| f64::from(f32::from_le_bytes(word)));
        let class = u16::try_from(i32::from_le_bytes(word(3)?)).ok().filter(|class| *class > 0)?;
        Some(([metres(0)?, metres(1)?, metres(2)?], class))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty float x\n\
        property float y\nproperty float z\nproperty uchar red\nproperty int semantic\n\
        property int instance\n";

    fn file(header: &str, points: &[([f32; 3], i32)]) -> Vec<u8> {
        let mut bytes = [header.as_bytes(), END].concat();
        for (place, class) in points {
            place.iter().for_each(|metres| bytes.extend(metres.to_le_bytes()));
            bytes.push(255);
            bytes.extend([class.to_le_bytes(), [9; 4]].concat());
        }
        bytes
    }

    #[test]
    fn a_cell_has_the_class_of_most_of_its_points_and_of_two_the_lower() {
        let here = [1000.05, -2.05, 0.0];
        let there = [1000.05, -2.25, 0.0];
        let points = [(here, 7), (here, 8), (here, 8), (there, 22), (there, 21), (there, -1)];
        let labels = FusedLabels::read(&file(HEADER, &points), "w").unwrap();
        assert_eq!(labels.class_at([1000.1, -2.1, 0.1]), Some(8));
        assert_eq!(labels.class_at([1000.1, -2.3, 0.1]), Some(21));
        assert_eq!(labels.class_at([1000.1, -2.1, -0.1]), None);
        assert_eq!(labels.class_at([f64::NAN, f64::INFINITY, 0.0]), None);
    }

    #[test]
    fn what_is_no_such_file_is_refused() {
        let whole = file(HEADER, &[([0.0; 3], 7)]);
        let broken = [
            whole[..whole.len() - 1].to_vec(),
            whole[..40].to_vec(),
            file(&HEADER.replace("int semantic", "float semantic"), &[]),
            file(&HEADER.replace("uchar red", "list red"), &[]),
            file(&HEADER.replace("binary_little_endian", "ascii"), &[]),
        ];
        assert!(broken.iter().all(|bytes| FusedLabels::read(bytes, "w").is_err()));
    }

    #[test]
    fn bent_files_are_read_or_refused() {
        let sound = file(HEADER, &[([1.0; 3], 7), ([2.0; 3], 8)]);
        let (mut read, mut refused) = (0, 0);
        for at in 0..sound.len() {
            for byte in [0, 0xff, b'9', b' ', b'\n'] {
                let mut bent = sound.clone();
                bent[at] = byte;
                let cut = FusedLabels::read(&bent[..at], "w");
                for labels in [FusedLabels::read(&bent, "w"), cut] {
                    let count = if labels.is_ok() { &mut read } else { &mut refused };
                    *count += 1;
                }
            }
        }
        assert!(read > 300 && refused > 600, "{read} read, {refused} refused");
    }
}
