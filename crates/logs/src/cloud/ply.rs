//! PLY files: text, or binary in either order of bytes.

use std::io::{self, BufRead, Read};

use super::columns::{Column, Columns, Kind, Layout, Order, Row};
use super::text::{read_line, words};

/// The element whose records are points.
const POINTS: &str = "vertex";

/// A PLY file whose header was read.
#[derive(Debug)]
pub(super) struct Ply {
    /// None is text.
    order: Option<Order>,
    /// Elements up to the points, which are the last.
    elements: Vec<Element>,
}

#[derive(Debug, Default)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

#[derive(Debug)]
enum Property {
    Number(String, Kind),
    /// A count, and so many numbers: never read.
    List(Kind, Kind),
}

impl Ply {
    /// Reads the header.
    ///
    /// # Errors
    /// What was found, if it is none.
    pub(super) fn open(reader: &mut impl BufRead) -> Result<Self, String> {
        if read_line(reader)? != "ply" {
            return Err("another beginning than `ply`".into());
        }
        let (mut format, mut elements) = (None, Vec::new());
        loop {
            let line = read_line(reader)?;
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                ["format", name, ..] => format = Some(order(name)?),
                ["element", name, count] => elements.push(Element::new(name, count)?),
                ["property", ref of @ ..] => {
                    let element = elements.last_mut().ok_or("a property before any element")?;
                    element.properties.push(property(of)?);
                }
                ["end_header"] => break,
                ["comment" | "obj_info", ..] | [] => {}
                _ => return Err(format!("a line `{line}`")),
            }
        }
        if let Some(element) = elements.iter().find(|element| element.properties.is_empty()) {
            return Err(format!("an element `{}` without properties", element.name));
        }
        let at = elements.iter().position(|element| element.name == POINTS);
        elements.truncate(at.ok_or("no element `vertex`")? + 1);
        Ok(Self { order: format.ok_or("no line `format`")?, elements })
    }

    /// How many points the header declares.
    pub(super) fn points(&self) -> u64 {
        self.elements.last().map_or(0, |points| points.count)
    }

    /// Bytes that a point takes at least.
    pub(super) fn point_bytes(&self) -> u64 {
        let properties = self.elements.last().map_or(&[][..], |points| &points.properties);
        let least = |property: &Property| match (property, self.order) {
            (_, None) => 2,
            (Property::Number(_, kind) | Property::List(kind, _), Some(_)) => kind.bytes() as u64,
        };
        properties.iter().map(least).sum()
    }

    pub(super) fn columns(&self) -> Columns {
        self.elements
            .last()
            .map_or_else(Columns::new, |points| points.layout(Order::Little).columns())
    }

    /// Reads the points.
    ///
    /// # Errors
    /// What was found, if it is less than the header declares.
    pub(super) fn read(
        self,
        reader: &mut impl BufRead,
        mut visit: impl FnMut(&Row),
    ) -> Result<(), String> {
        for element in &self.elements {
            let is_points = element.name == POINTS;
            match self.order {
                Some(order) => element.read_bytes(reader, order, is_points, &mut visit)?,
                None => element.read_text(reader, is_points, &mut visit)?,
            }
        }
        Ok(())
    }
}

fn order(format: &str) -> Result<Option<Order>, String> {
    match format {
        "ascii" => Ok(None),
        "binary_little_endian" => Ok(Some(Order::Little)),
        "binary_big_endian" => Ok(Some(Order::Big)),
        other => Err(format!("a format `{other}`")),
    }
}

fn property(words: &[&str]) -> Result<Property, String> {
    match words {
        ["list", count, item, _] => Ok(Property::List(kind(count)?, kind(item)?)),
        [number, name] => Ok(Property::Number((*name).to_owned(), kind(number)?)),
        other => Err(format!("a property `{}`", other.join(" "))),
    }
}

fn kind(name: &str) -> Result<Kind, String> {
    Ok(match name {
        "char" | "int8" => Kind::I8,
        "uchar" | "uint8" => Kind::U8,
        "short" | "int16" => Kind::I16,
        "ushort" | "uint16" => Kind::U16,
        "int" | "int32" => Kind::I32,
        "uint" | "uint32" => Kind::U32,
        "float" | "float32" => Kind::F32,
        "double" | "float64" => Kind::F64,
        other => return Err(format!("a property of type `{other}`")),
    })
}

impl Element {
    fn new(name: &str, count: &str) -> Result<Self, String> {
        let count = count.parse().map_err(|_| format!("`{count}` of `{name}`"))?;
        Ok(Self { name: name.to_owned(), count, properties: Vec::new() })
    }

    /// Of its numbers, lists left out.
    fn layout(&self, order: Order) -> Layout {
        let numbers = self.properties.iter().filter_map(|property| match property {
            Property::Number(name, kind) => Some((name.as_str(), *kind, 1)),
            Property::List(..) => None,
        });
        Layout::new(order, numbers)
    }

    fn read_bytes(
        &self,
        reader: &mut impl Read,
        order: Order,
        is_points: bool,
        visit: &mut impl FnMut(&Row),
    ) -> Result<(), String> {
        let layout = self.layout(order);
        let mut record = vec![0; layout.bytes()];
        for number in 0..self.count {
            self.read_record(reader, order, &mut record)
                .map_err(|error| self.ends(number, &error))?;
            if is_points {
                visit(&layout.row(&record));
            }
        }
        Ok(())
    }

    /// Reads the numbers of a record, and passes over its lists.
    fn read_record(
        &self,
        reader: &mut impl Read,
        order: Order,
        record: &mut [u8],
    ) -> io::Result<()> {
        if !self.properties.iter().any(|property| matches!(property, Property::List(..))) {
            return reader.read_exact(record);
        }
        let mut rest = record;
        for property in &self.properties {
            match property {
                Property::Number(_, kind) => {
                    let (number, behind) = rest.split_at_mut(kind.bytes());
                    reader.read_exact(number)?;
                    rest = behind;
                }
                Property::List(count, item) => skip_list(reader, *count, *item, order)?,
            }
        }
        Ok(())
    }

    fn read_text(
        &self,
        reader: &mut impl BufRead,
        is_points: bool,
        visit: &mut impl FnMut(&Row),
    ) -> Result<(), String> {
        for number in 0..self.count {
            let line = read_line(reader).map_err(|found| self.found(number, &found))?;
            let row = self.row(&line).map_err(|found| self.found(number, &found))?;
            if is_points {
                visit(&row);
            }
        }
        Ok(())
    }

    /// The numbers of a line, lists passed over.
    fn row(&self, line: &str) -> Result<Row, String> {
        let (mut words, mut row) = (words(line), Row::empty());
        let mut next = || words.next().ok_or_else(|| "too few numbers".to_owned())?;
        for property in &self.properties {
            match property {
                Property::Number(name, _) => {
                    let number = next()?;
                    if let Some(column) = Column::named(name).filter(|of| row.get(*of).is_nan()) {
                        row.set(column, number);
                    }
                }
                Property::List(..) => {
                    for _ in 0..next()? as u64 {
                        next()?;
                    }
                }
            }
        }
        Ok(row)
    }

    fn ends(&self, number: u64, error: &io::Error) -> String {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => self.found(number, "the end of the file"),
            _ => self.found(number, &error.to_string()),
        }
    }

    fn found(&self, number: u64, found: &str) -> String {
        format!("{found} at `{}` {number} of {}", self.name, self.count)
    }
}

/// A list whose count is none, such as NaN or -1, is empty.
fn skip_list(reader: &mut impl Read, count: Kind, item: Kind, order: Order) -> io::Result<()> {
    let mut bytes = [0; 8];
    let count_bytes = &mut bytes[..count.bytes()];
    reader.read_exact(count_bytes)?;
    let length = (count.read(count_bytes, order) as u64).saturating_mul(item.bytes() as u64);
    match io::copy(&mut reader.take(length), &mut io::sink())? == length {
        true => Ok(()),
        false => Err(io::ErrorKind::UnexpectedEof.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Vec<[f64; 4]>, String> {
        let (mut reader, mut rows) = (bytes, Vec::new());
        let ply = Ply::open(&mut reader)?;
        ply.read(&mut reader, |row| {
            rows.push(row.all([Column::X, Column::Y, Column::Z, Column::Class]));
        })?;
        Ok(rows)
    }

    const HEADER: &str = "comment made by hand\nelement camera 1\nproperty list uchar int lens\n\
        property float f\nelement vertex 2\nproperty double x\nproperty uchar red\nproperty float y\n\
        property list uchar short faces\nproperty float z\nproperty short class\n\
        element face 1\nproperty list uchar int i\nend_header\n";

    fn header(format: &str) -> Vec<u8> {
        format!("ply\nformat {format} 1.0\n{HEADER}").into_bytes()
    }

    /// The same two points in each of the three ways to write them.
    pub(crate) fn samples() -> [Vec<u8>; 3] {
        let text = "2 7 8 0.5\n1.5 255 -2 1 9 0.25 3\n1e3 0 0.5 0 1 -1\n3 0 0 0\n";
        let mut samples =
            [header("ascii"), header("binary_little_endian"), header("binary_big_endian")];
        samples[0].extend(text.as_bytes());
        macro_rules! write {
            ($to:expr, $bytes:ident) => {
                $to.push(2);
                $to.extend([7_i32.$bytes(), 8_i32.$bytes(), 0.5_f32.$bytes()].concat());
                for (x, y, faces, z, class) in
                    [(1.5_f64, -2_f32, &[9_i16][..], 0.25_f32, 3_i16), (1e3, 0.5, &[], 1.0, -1)]
                {
                    $to.extend(x.$bytes());
                    $to.push(255);
                    $to.extend(y.$bytes());
                    $to.push(faces.len() as u8);
                    faces.iter().for_each(|face| $to.extend(face.$bytes()));
                    $to.extend(z.$bytes());
                    $to.extend(class.$bytes());
                }
            };
        }
        write!(samples[1], to_le_bytes);
        write!(samples[2], to_be_bytes);
        samples
    }

    #[test]
    fn text_and_both_orders_of_bytes_are_the_same_points() {
        for sample in samples() {
            let points = read(&sample).unwrap();
            assert_eq!(points, [[1.5, -2.0, 0.25, 3.0], [1e3, 0.5, 1.0, -1.0]]);
        }
    }

    #[test]
    fn what_is_cut_off_is_refused_with_its_place() {
        for sample in samples() {
            let cut = &sample[..sample.len() - 12];
            if cut.starts_with(b"ply\nformat ascii") {
                assert!(read(&sample[..sample.len() - 16]).unwrap_err().contains("vertex"));
            } else {
                assert!(read(cut).unwrap_err().contains("`vertex` 1 of 2"), "{:?}", read(cut));
            }
        }
        let many =
            String::from_utf8(header("ascii")).unwrap().replace("vertex 2", "vertex 99999999999");
        assert!(read(many.as_bytes()).is_err());
        for broken in [
            "",
            "plx\n",
            "ply\nelement vertex 1\nend_header\n",
            "ply\nformat ascii 1.0\nend_header\n",
        ] {
            assert!(read(broken.as_bytes()).is_err(), "{broken}");
        }
    }
}
