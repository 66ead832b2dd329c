//! ROS messages: ROS 2's CDR, and ROS 1's serialization. Sources: OMG, "DDS Interoperability Wire
//! Protocol" 10 (plain CDR); wiki.ros.org, "Message Serialization Overview".

use occlabel_core::Timestamp;

use super::messages::{
    Boxes, Cloud, Cube, Defect, Field, Header, Link, NumberKind, Optics, Picture, RawPose,
    frame_name, timestamp,
};

/// How numbers and texts follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// ROS 2: numbers stand at multiples of their size, texts end in a zero.
    Cdr,
    /// ROS 1: no gaps, a sequence number in each header.
    Ros1,
}

/// A place in a message.
pub(super) struct Reader<'a> {
    data: &'a [u8],
    at: usize,
    layout: Layout,
    big_endian: bool,
    /// Of numbers, at most.
    alignment: usize,
}

impl<'a> Reader<'a> {
    /// Begins a message.
    ///
    /// # Errors
    /// If it has no head of plain CDR.
    pub(super) fn new(data: &'a [u8], layout: Layout) -> Result<Self, Defect> {
        let ros1 = Self { data, at: 0, layout, big_endian: false, alignment: 1 };
        if layout == Layout::Ros1 {
            return Ok(ros1);
        }
        let (big_endian, alignment) = match data {
            [0, 0, _, _, ..] => (true, 8),
            [0, 1, _, _, ..] => (false, 8),
            [0, 6, _, _, ..] => (true, 4),
            [0, 7, _, _, ..] => (false, 4),
            _ => {
                let found = format!("{:02x?}", &data[..data.len().min(4)]);
                return Err(Defect::new("the head of plain CDR", found));
            }
        };
        Ok(Self { data: &data[4..], big_endian, alignment, ..ros1 })
    }

    fn bytes(&mut self, count: usize) -> Result<&'a [u8], Defect> {
        let left = &self.data[self.at..];
        let bytes = left.get(..count).ok_or_else(|| {
            let expected = format!("{count} bytes at byte {} of the message", self.at);
            Defect::new(expected, format!("{}", left.len()))
        })?;
        self.at += count;
        Ok(bytes)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N], Defect> {
        let gap = self.at.next_multiple_of(N.min(self.alignment)) - self.at;
        self.bytes(gap)?;
        let mut number: [u8; N] = self.bytes(N)?.try_into().unwrap_or([0; N]);
        if self.big_endian {
            number.reverse();
        }
        Ok(number)
    }

    fn u8(&mut self) -> Result<u8, Defect> {
        self.number().map(u8::from_le_bytes)
    }

    fn u32(&mut self) -> Result<u32, Defect> {
        self.number().map(u32::from_le_bytes)
    }

    fn i32(&mut self) -> Result<i32, Defect> {
        self.number().map(i32::from_le_bytes)
    }

    fn f64(&mut self) -> Result<f64, Defect> {
        self.number().map(f64::from_le_bytes)
    }

    fn doubles<const N: usize>(&mut self) -> Result<[f64; N], Defect> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Ok(numbers)
    }

    fn blob(&mut self) -> Result<&'a [u8], Defect> {
        let length = self.u32()? as usize;
        self.bytes(length)
    }

    fn text(&mut self) -> Result<String, Defect> {
        let bytes = self.blob()?;
        let bytes = match self.layout {
            Layout::Cdr => bytes.strip_suffix(&[0]).unwrap_or(bytes),
            Layout::Ros1 => bytes,
        };
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }

    /// A list; its declared length is believed as far as the message goes on.
    fn list<T>(
        &mut self,
        mut item: impl FnMut(&mut Self) -> Result<T, Defect>,
    ) -> Result<Vec<T>, Defect> {
        let count = self.u32()?;
        let mut items = Vec::new();
        for _ in 0..count {
            items.push(item(self)?);
        }
        Ok(items)
    }

    fn time(&mut self) -> Result<Timestamp, Defect> {
        let seconds = match self.layout {
            Layout::Cdr => i64::from(self.i32()?),
            Layout::Ros1 => i64::from(self.u32()?),
        };
        Ok(timestamp(seconds, self.u32()?.into()))
    }

    fn header(&mut self) -> Result<Header, Defect> {
        if self.layout == Layout::Ros1 {
            self.u32()?;
        }
        Ok(Header { time: self.time()?, frame: frame_name(&self.text()?) })
    }

    fn pose(&mut self) -> Result<RawPose, Defect> {
        Ok(RawPose { translation: self.doubles()?, rotation: self.doubles()? })
    }

    /// Whether the message is over, but for what fills it up.
    fn finish(&self) -> Result<(), Defect> {
        match self.data.len() - self.at {
            0..8 => Ok(()),
            left => Err(Defect::new("the end of the message", format!("{left} more bytes"))),
        }
    }
}

/// `sensor_msgs/PointCloud2`.
pub(super) fn cloud(reader: &mut Reader<'_>) -> Result<Cloud, Defect> {
    let header = reader.header()?;
    let (rows, width) = (reader.u32()? as usize, reader.u32()? as usize);
    let fields = reader.list(point_field)?;
    let big_endian = reader.u8()? != 0;
    let (point_step, row_step) = (reader.u32()? as usize, reader.u32()? as usize);
    let data = reader.blob()?.to_vec();
    let pose = RawPose::IDENTITY;
    Ok(Cloud { header, pose, fields, rows, width, row_step, point_step, big_endian, data })
}

fn point_field(reader: &mut Reader<'_>) -> Result<Field, Defect> {
    let (name, offset) = (reader.text()?, reader.u32()? as usize);
    let kind = match reader.u8()? {
        1 => NumberKind::I8,
        2 => NumberKind::U8,
        3 => NumberKind::I16,
        4 => NumberKind::U16,
        5 => NumberKind::I32,
        6 => NumberKind::U32,
        7 => NumberKind::F32,
        8 => NumberKind::F64,
        kind => return Err(Defect::new("a type of numbers from 1 to 8", kind.to_string())),
    };
    reader.u32()?;
    Ok(Field { name, offset, kind })
}

/// `tf2_msgs/TFMessage`, `tf/tfMessage`.
pub(super) fn links(reader: &mut Reader<'_>) -> Result<Vec<Link>, Defect> {
    reader.list(link)
}

/// `geometry_msgs/TransformStamped`.
pub(super) fn link(reader: &mut Reader<'_>) -> Result<Link, Defect> {
    let (header, child) = (reader.header()?, frame_name(&reader.text()?));
    Ok(Link { header, child, parent_from_child: reader.pose()? })
}

/// `sensor_msgs/CameraInfo`.
pub(super) fn optics(reader: &mut Reader<'_>) -> Result<Optics, Defect> {
    let header = reader.header()?;
    let (height, width) = (reader.u32()?, reader.u32()?);
    let (model, distortion) = (reader.text()?, reader.list(Reader::f64)?);
    let matrix = reader.doubles::<9>()?.to_vec();
    Ok(Optics { header, width, height, model, distortion, matrix })
}

/// `vision_msgs/Detection3DArray` of ROS 2 since Galactic.
pub(super) fn detections(reader: &mut Reader<'_>) -> Result<Boxes, Defect> {
    let header = reader.header()?;
    let mut cubes = reader.list(detection)?;
    reader.finish()?;
    for cube in &mut cubes {
        if cube.header.frame.is_empty() {
            cube.header = header.clone();
        }
    }
    let cleared = vec![header.time];
    Ok(Boxes { cubes, cleared })
}

fn detection(reader: &mut Reader<'_>) -> Result<Cube, Defect> {
    let header = reader.header()?;
    let hypotheses = reader.list(|reader| {
        let (class, score) = (reader.text()?, reader.f64()?);
        reader.pose()?;
        reader.doubles::<36>()?;
        Ok((class, score))
    })?;
    let best = hypotheses.into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a });
    let (pose, size_m) = (reader.pose()?, reader.doubles()?);
    let (track, category) = (reader.text()?, best.map(|(class, _)| class).unwrap_or_default());
    Ok(Cube { header, track, category, pose, size_m })
}

/// What later versions of `visualization_msgs/Marker` have, by the schema's text.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MarkerParts {
    texture: bool,
    mesh_file: bool,
}

impl MarkerParts {
    /// By the schema's text.
    pub(super) fn of_schema(text: &[u8]) -> Self {
        let text = String::from_utf8_lossy(text);
        Self { texture: text.contains("texture_resource"), mesh_file: text.contains("mesh_file") }
    }
}

/// `visualization_msgs/MarkerArray`: its cubes, a track each by name space and number.
pub(super) fn markers(reader: &mut Reader<'_>, parts: MarkerParts) -> Result<Boxes, Defect> {
    let mut boxes = Boxes::default();
    for marker in reader.list(|reader| marker(reader, parts))? {
        match marker {
            Marker::Cube(cube) => boxes.cubes.push(cube),
            Marker::Clear(time) => boxes.cleared.push(time),
            Marker::Other => {}
        }
    }
    reader.finish()?;
    Ok(boxes)
}

enum Marker {
    Cube(Cube),
    Clear(Timestamp),
    Other,
}

fn marker(reader: &mut Reader<'_>, parts: MarkerParts) -> Result<Marker, Defect> {
    const CUBE: i32 = 1;
    const ADD: i32 = 0;
    const DELETE_ALL: i32 = 3;
    let (header, space, number) = (reader.header()?, reader.text()?, reader.i32()?);
    let (kind, action) = (reader.i32()?, reader.i32()?);
    let (pose, size_m) = (reader.pose()?, reader.doubles()?);
    skip_appearance(reader)?;
    if parts.texture {
        skip_texture(reader)?;
    }
    let text = reader.text()?;
    reader.text()?;
    if parts.mesh_file {
        reader.text()?;
        reader.blob()?;
    }
    reader.u8()?;
    let category = if text.is_empty() { space.clone() } else { text };
    let track = format!("{space}/{number}");
    Ok(match (kind, action) {
        (CUBE, ADD) => Marker::Cube(Cube { header, track, category, pose, size_m }),
        (_, DELETE_ALL) => Marker::Clear(header.time),
        _ => Marker::Other,
    })
}

/// Colour, lifetime, whether its frame is locked, points and their colours.
fn skip_appearance(reader: &mut Reader<'_>) -> Result<(), Defect> {
    colour(reader)?;
    reader.time()?;
    reader.u8()?;
    reader.list(Reader::doubles::<3>)?;
    reader.list(colour).map(drop)
}

fn colour(reader: &mut Reader<'_>) -> Result<(), Defect> {
    (0..4).try_for_each(|_| reader.u32().map(drop))
}

/// The texture's name, image and coordinates.
fn skip_texture(reader: &mut Reader<'_>) -> Result<(), Defect> {
    reader.text()?;
    reader.header()?;
    reader.text()?;
    reader.blob()?;
    reader.list(|reader| reader.u32().and_then(|_| reader.u32())).map(drop)
}

/// `sensor_msgs/CompressedImage`, or `sensor_msgs/Image` without its pixels.
pub(super) fn picture(reader: &mut Reader<'_>, is_compressed: bool) -> Result<Picture, Defect> {
    let header = reader.header()?;
    if !is_compressed {
        return Ok(Picture { header, data: Vec::new() });
    }
    reader.text()?;
    Ok(Picture { header, data: reader.blob()?.to_vec() })
}
