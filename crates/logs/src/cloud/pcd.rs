//! PCD files: text, binary, and binary packed by LZF.

use std::io::{BufRead, Read};

use super::columns::{Column, Columns, Kind, Layout, Order, Row};
use super::lzf;
use super::text::{read_line, words};

/// A packed file of more bytes is refused: it is unpacked as a whole.
const MOST_PACKED_BYTES: usize = 1 << 30;

/// A PCD file whose header was read.
#[derive(Debug)]
pub(super) struct Pcd {
    fields: Vec<Field>,
    points: u64,
    data: Data,
}

#[derive(Debug)]
struct Field {
    name: String,
    kind: Option<Kind>,
    bytes: usize,
    count: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Data {
    Text,
    Binary,
    Packed,
}

/// The header's lists, one entry a field.
#[derive(Default)]
struct Header {
    names: Vec<String>,
    sizes: Vec<String>,
    kinds: Vec<String>,
    counts: Vec<String>,
    points: Option<u64>,
}

impl Pcd {
    /// Reads the header.
    ///
    /// # Errors
    /// What was found, if it is none.
    pub(super) fn open(reader: &mut impl BufRead) -> Result<Self, String> {
        let mut header = Header::default();
        loop {
            let line = read_line(reader)?;
            let mut words = line.split_whitespace().map(str::to_owned);
            let key = words.next().unwrap_or_default();
            match key.as_str() {
                "FIELDS" => header.names = words.collect(),
                "SIZE" => header.sizes = words.collect(),
                "TYPE" => header.kinds = words.collect(),
                "COUNT" => header.counts = words.collect(),
                "POINTS" => header.points = words.next().and_then(|word| word.parse().ok()),
                "DATA" => return header.finish(&words.next().unwrap_or_default()),
                "VERSION" | "WIDTH" | "HEIGHT" | "VIEWPOINT" | "" => {}
                _ if key.starts_with('#') => {}
                _ => return Err(format!("a line `{line}`")),
            }
        }
    }

    /// How many points the header declares.
    pub(super) fn points(&self) -> u64 {
        self.points
    }

    /// Bytes that a point takes at least; packed, LZF makes at most 264 bytes of 3.
    pub(super) fn point_bytes(&self) -> u64 {
        match self.data {
            Data::Text => 2 * self.fields.iter().map(|field| field.count as u64).sum::<u64>(),
            Data::Binary => self.layout().bytes() as u64,
            Data::Packed => (self.layout().bytes() / lzf::MOST_A_BYTE) as u64,
        }
    }

    pub(super) fn columns(&self) -> Columns {
        self.layout().columns()
    }

    fn layout(&self) -> Layout {
        let fields = self.fields.iter().map(|field| match field.kind {
            Some(kind) => (field.name.as_str(), kind, field.count),
            // 64-bit integers: nothing that is read.
            None => ("_", Kind::U8, field.bytes.saturating_mul(field.count)),
        });
        Layout::new(Order::Little, fields)
    }

    /// Reads the points.
    ///
    /// # Errors
    /// What was found, if it is less than the header declares.
    pub(super) fn read(
        self,
        reader: &mut impl BufRead,
        visit: impl FnMut(&Row),
    ) -> Result<(), String> {
        match self.data {
            Data::Text => self.read_text(reader, visit),
            Data::Binary => self.read_bytes(reader, visit),
            Data::Packed => self.read_packed(reader, visit),
        }
    }

    fn read_text(
        &self,
        reader: &mut impl BufRead,
        mut visit: impl FnMut(&Row),
    ) -> Result<(), String> {
        for number in 0..self.points {
            let line = read_line(reader).map_err(|found| self.found(number, &found))?;
            visit(&self.row(&line).map_err(|found| self.found(number, &found))?);
        }
        Ok(())
    }

    fn row(&self, line: &str) -> Result<Row, String> {
        let (mut words, mut row) = (words(line), Row::empty());
        for field in &self.fields {
            let column = Column::named(&field.name).filter(|of| row.get(*of).is_nan());
            for part in 0..field.count {
                let number = words.next().ok_or("too few numbers")??;
                if let Some(column) = column.filter(|_| part == 0) {
                    row.set(column, number);
                }
            }
        }
        Ok(row)
    }

    fn read_bytes(
        &self,
        reader: &mut impl Read,
        mut visit: impl FnMut(&Row),
    ) -> Result<(), String> {
        let layout = self.layout();
        let mut record = Vec::new();
        for number in 0..self.points {
            record.clear();
            let read = reader.by_ref().take(layout.bytes() as u64).read_to_end(&mut record);
            match read {
                Ok(bytes) if bytes == layout.bytes() => visit(&layout.row(&record)),
                Ok(_) => return Err(self.found(number, "the end of the file")),
                Err(error) => return Err(self.found(number, &error.to_string())),
            }
        }
        Ok(())
    }

    /// Field by field, each of all points.
    fn read_packed(
        &self,
        reader: &mut impl Read,
        mut visit: impl FnMut(&Row),
    ) -> Result<(), String> {
        let layout = self.layout();
        let plain = unpacked(reader)?;
        let points = usize::try_from(self.points).unwrap_or(usize::MAX);
        if points.saturating_mul(layout.bytes()) != plain.len() {
            let (bytes, each) = (plain.len(), layout.bytes());
            return Err(format!("{bytes} bytes of {points} points of {each} bytes"));
        }
        let mut record = vec![0; if points > 0 { layout.bytes() } else { 0 }];
        for point in 0..points {
            let mut begin = 0;
            for field in &self.fields {
                let bytes = field.bytes * field.count;
                let at = begin * points + point * bytes;
                record[begin..begin + bytes].copy_from_slice(&plain[at..at + bytes]);
                begin += bytes;
            }
            visit(&layout.row(&record));
        }
        Ok(())
    }

    fn found(&self, number: u64, found: &str) -> String {
        format!("{found} at point {number} of {}", self.points)
    }
}

/// What stands behind two sizes: packed and plain.
fn unpacked(reader: &mut impl Read) -> Result<Vec<u8>, String> {
    let mut sizes = [0; 8];
    reader.read_exact(&mut sizes).map_err(|error| error.to_string())?;
    let [packed_bytes, plain_bytes] = [&sizes[..4], &sizes[4..]]
        .map(|size| size.first_chunk().map_or(0, |size| u32::from_le_bytes(*size) as usize));
    if packed_bytes.max(plain_bytes) > MOST_PACKED_BYTES {
        return Err(format!("{packed_bytes} bytes of {plain_bytes} packed ones"));
    }
    let mut packed = Vec::new();
    let read = reader.by_ref().take(packed_bytes as u64).read_to_end(&mut packed);
    match read {
        Ok(bytes) if bytes == packed_bytes => {}
        Ok(bytes) => return Err(format!("{bytes} of {packed_bytes} packed bytes")),
        Err(error) => return Err(error.to_string()),
    }
    lzf::unpack(&packed, plain_bytes)
}

impl Header {
    fn finish(self, data: &str) -> Result<Pcd, String> {
        let data = match data {
            "ascii" => Data::Text,
            "binary" => Data::Binary,
            "binary_compressed" => Data::Packed,
            other => return Err(format!("`DATA {other}`")),
        };
        let points = self.points.ok_or("no number of POINTS")?;
        let fields: Vec<Field> = (0..self.names.len())
            .map(|at| self.field(at))
            .collect::<Option<_>>()
            .ok_or("no SIZE, TYPE or COUNT of each of FIELDS")?;
        if fields.iter().map(|field| field.bytes * field.count).sum::<usize>() == 0 {
            return Err("no FIELDS".into());
        }
        Ok(Pcd { fields, points, data })
    }

    fn field(&self, at: usize) -> Option<Field> {
        let bytes: usize = self.sizes.get(at)?.parse().ok()?;
        let count = self.counts.get(at).map_or(Some(1), |count| count.parse().ok())?;
        let kind = match (self.kinds.get(at)?.as_str(), bytes) {
            ("I", 1) => Some(Kind::I8),
            ("U", 1) => Some(Kind::U8),
            ("I", 2) => Some(Kind::I16),
            ("U", 2) => Some(Kind::U16),
            ("I", 4) => Some(Kind::I32),
            ("U", 4) => Some(Kind::U32),
            ("F", 4) => Some(Kind::F32),
            ("F", 8) => Some(Kind::F64),
            ("I" | "U", 8) => None,
            _ => return None,
        };
        // Fields of more numbers are none that is read, and none that exists.
        (count <= 1 << 16).then(|| Field { name: self.names[at].clone(), kind, bytes, count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) const HEADER: &str = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb label\nSIZE 4 4 4 1 2\n\
        TYPE F F F U U\nCOUNT 1 1 1 3 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";

    fn read(bytes: &[u8]) -> Result<Vec<[f64; 4]>, String> {
        let (mut reader, mut rows) = (bytes, Vec::new());
        let pcd = Pcd::open(&mut reader)?;
        pcd.read(&mut reader, |row| {
            rows.push(row.all([Column::X, Column::Y, Column::Z, Column::Class]));
        })?;
        Ok(rows)
    }

    fn record(place: [f32; 3], label: u16) -> Vec<u8> {
        let place = place.map(f32::to_le_bytes).concat();
        [&place[..], &[1, 2, 3], &label.to_le_bytes()].concat()
    }

    /// The same two points in each of the three ways to write them.
    pub(crate) fn samples() -> [Vec<u8>; 3] {
        let text = format!("{HEADER}ascii\n1.5 -2 0.25 1 2 3 40\nnan 0.5 1 1 2 3 0\n").into_bytes();
        let records = [record([1.5, -2.0, 0.25], 40), record([f32::NAN, 0.5, 1.0], 0)];
        let binary = [format!("{HEADER}binary\n").as_bytes(), &records.concat()].concat();
        let mut plain = Vec::new();
        for (begin, bytes) in [(0, 4), (4, 4), (8, 4), (12, 3), (15, 2)] {
            records.iter().for_each(|record| plain.extend(&record[begin..begin + bytes]));
        }
        // One literal run: its length less 1, then its bytes.
        let packed: Vec<u8> =
            plain.chunks(32).flat_map(|run| [&[run.len() as u8 - 1], run].concat()).collect();
        let sizes = [packed.len() as u32, plain.len() as u32].map(u32::to_le_bytes).concat();
        let packed = [format!("{HEADER}binary_compressed\n").as_bytes(), &sizes, &packed].concat();
        [text, binary, packed]
    }

    #[test]
    fn text_binary_and_packed_files_are_the_same_points() {
        for sample in samples() {
            let points = read(&sample).unwrap();
            assert_eq!(points[0], [1.5, -2.0, 0.25, 40.0]);
            assert!(points[1][0].is_nan() && points[1][1..] == [0.5, 1.0, 0.0]);
        }
    }

    #[test]
    fn what_is_cut_off_is_refused() {
        for sample in samples() {
            assert!((0..sample.len() - 4).all(|end| read(&sample[..end]).is_err()));
        }
        let huge = HEADER.replace("POINTS 2", "POINTS 99999999999");
        assert!(read(format!("{huge}binary\n").as_bytes()).is_err());
    }
}
