//! LAS files (ASPRS LAS 1.0 to 1.4).

use std::io::{BufRead, Read};

use super::columns::{Column, Columns, Kind, Order, Row};

/// Bytes of a header that every version has.
const HEADER_BYTES: usize = 227;
/// Bytes of a header of version 1.4, which counts points in 64 bits.
const HEADER_1_4_BYTES: u16 = 375;
/// The bit of a point format that says that points are packed.
const PACKED: u8 = 0x80;

/// A LAS file that was read up to its first point.
#[derive(Debug)]
pub(super) struct Las {
    points: u64,
    format: u8,
    record_bytes: usize,
    scale: [f64; 3],
    offset: [f64; 3],
    /// What stands before the first point.
    head: Vec<u8>,
}

impl Las {
    /// Reads up to the first point.
    ///
    /// # Errors
    /// What was found, if it is no such file.
    pub(super) fn open(reader: &mut impl BufRead) -> Result<Self, String> {
        let mut head = Vec::new();
        read_up_to(reader, HEADER_BYTES as u64, &mut head)?;
        if !head.starts_with(b"LASF") {
            return Err("another beginning than `LASF`".into());
        }
        let number = |at: usize, kind: Kind| kind.read(&head[at..], Order::Little);
        let three = |at: usize| [0, 8, 16].map(|axis| number(at + axis, Kind::F64));
        let (begin, format) = (number(96, Kind::U32) as u64, head[104]);
        let record_bytes = number(105, Kind::U16) as usize;
        let (scale, offset) = (three(131), three(155));
        let (header_bytes, points) = (number(94, Kind::U16) as u16, number(107, Kind::U32) as u64);
        if begin < HEADER_BYTES as u64 {
            return Err(format!("points at byte {begin}"));
        }
        if record_bytes < least_bytes(format) {
            return Err(format!("records of {record_bytes} bytes of point format {format}"));
        }
        read_up_to(reader, begin, &mut head)?;
        let long = head.get(247..).and_then(|bytes| bytes.first_chunk());
        let points = match long.filter(|_| header_bytes >= HEADER_1_4_BYTES) {
            Some(long) => u64::from_le_bytes(*long),
            None => points,
        };
        Ok(Self { points, format, record_bytes, scale, offset, head })
    }

    /// How many points the header declares.
    pub(super) fn points(&self) -> u64 {
        self.points
    }

    /// Bytes that a point takes at least; packed, hardly any.
    pub(super) fn point_bytes(&self) -> u64 {
        if self.is_packed() { 1 } else { self.record_bytes as u64 }
    }

    pub(super) fn columns(&self) -> Columns {
        [Column::X, Column::Y, Column::Z, Column::Class].map(|column| (column, 0)).into()
    }

    fn is_packed(&self) -> bool {
        self.format & PACKED != 0
    }

    /// Reads the points.
    ///
    /// # Errors
    /// What was found, if it is less than the header declares, or packed and this program cannot unpack.
    pub(super) fn read(
        self,
        reader: &mut impl BufRead,
        mut visit: impl FnMut(&Row),
    ) -> Result<(), String> {
        if self.is_packed() {
            return self.unpack(reader, visit);
        }
        let mut record = vec![0; self.record_bytes];
        for number in 0..self.points {
            reader
                .read_exact(&mut record)
                .map_err(|error| format!("{error} at point {number} of {}", self.points))?;
            visit(&self.row(&record));
        }
        Ok(())
    }

    #[cfg(feature = "laz")]
    fn unpack(&self, reader: &mut impl Read, mut visit: impl FnMut(&Row)) -> Result<(), String> {
        let mut packed = Vec::new();
        reader.read_to_end(&mut packed).map_err(|error| error.to_string())?;
        let size = [self.points, self.record_bytes as u64];
        super::laz::unpack(&self.head, packed, size, |record| visit(&self.row(record)))
    }

    #[cfg(not(feature = "laz"))]
    fn unpack(&self, _: &mut impl Read, _: impl FnMut(&Row)) -> Result<(), String> {
        let found = "packed points (LAZ), which a program with the cargo feature `laz` reads";
        Err(format!("{found}, and `laszip` makes LAS of ({} bytes before them)", self.head.len()))
    }

    fn row(&self, record: &[u8]) -> Row {
        let mut row = Row::empty();
        for (axis, column) in [Column::X, Column::Y, Column::Z].into_iter().enumerate() {
            let steps = Kind::I32.read(&record[4 * axis..], Order::Little);
            row.set(column, steps * self.scale[axis] + self.offset[axis]);
        }
        let class = match self.format & !PACKED {
            0..=5 => record[15] & 31,
            _ => record[16],
        };
        row.set(Column::Class, class.into());
        row
    }
}

/// Place and class of a point take so many bytes.
fn least_bytes(format: u8) -> usize {
    if format & !PACKED <= 5 { 20 } else { 30 }
}

/// Reads until there are so many bytes.
fn read_up_to(reader: &mut impl Read, bytes: u64, head: &mut Vec<u8>) -> Result<(), String> {
    let missing = bytes.saturating_sub(head.len() as u64);
    let read = reader.take(missing).read_to_end(head).map_err(|error| error.to_string())?;
    match read as u64 == missing {
        true => Ok(()),
        false => Err(format!("the end of the file at byte {}", head.len())),
    }
}

/// A file of two points of a format.
#[cfg(any(test, fuzzing))]
pub(super) fn sample(format: u8) -> Vec<u8> {
    let bytes = least_bytes(format) as u16 + 2;
    let mut head = vec![0; HEADER_BYTES];
    head[..4].copy_from_slice(b"LASF");
    head[94..96].copy_from_slice(&(HEADER_BYTES as u16).to_le_bytes());
    head[96..100].copy_from_slice(&(HEADER_BYTES as u32 + 3).to_le_bytes());
    head[104] = format;
    head[105..107].copy_from_slice(&bytes.to_le_bytes());
    head[107..111].copy_from_slice(&2_u32.to_le_bytes());
    for axis in 0..3 {
        head[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&0.01_f64.to_le_bytes());
        head[155 + 8 * axis..163 + 8 * axis].copy_from_slice(&1000_f64.to_le_bytes());
    }
    head.extend([9; 3]);
    for (steps, class) in [([100, -200, 0_i32], 2), ([0, 1, 2], 6)] {
        let mut record = steps.map(i32::to_le_bytes).concat();
        record.resize(usize::from(bytes), 0);
        record[if format <= 5 { 15 } else { 16 }] = class;
        head.extend(record);
    }
    head
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Vec<[f64; 4]>, String> {
        let (mut reader, mut rows) = (bytes, Vec::new());
        let las = Las::open(&mut reader)?;
        las.read(&mut reader, |row| {
            rows.push(row.all([Column::X, Column::Y, Column::Z, Column::Class]));
        })?;
        Ok(rows)
    }

    #[test]
    fn steps_become_metres_and_classes_stand_where_the_format_has_them() {
        for format in [0, 3, 6, 7] {
            let points = read(&sample(format)).unwrap();
            assert_eq!(points[0], [1001.0, 998.0, 1000.0, 2.0]);
            assert_eq!(points[1][3], 6.0);
        }
    }

    #[test]
    fn cut_packed_and_hostile_files_are_refused() {
        let sound = sample(6);
        assert!((0..sound.len()).all(|end| read(&sound[..end]).is_err()));
        assert!(read(&sample(0x80 | 6)).unwrap_err().contains("LAS"));
        let mut short = sound.clone();
        short[105] = 4;
        assert!(read(&short).unwrap_err().contains("4 bytes"));
    }
}
