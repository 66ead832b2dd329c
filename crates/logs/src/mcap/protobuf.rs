//! Foxglove's schemas, protobuf encoded. Source: foxglove.dev, "Message schemas".

use std::io::Cursor;

use occlabel_core::Timestamp;

use super::messages::{
    Boxes, Cloud, Cube, Defect, Field, Header, Link, NumberKind, Optics, Picture, RawPose,
    frame_name, timestamp,
};
use crate::wire::{self, Fields, Span};

/// A message in memory.
struct Message<'a> {
    data: &'a [u8],
    fields: Fields,
}

impl<'a> Message<'a> {
    fn of(data: &'a [u8]) -> Result<Self, Defect> {
        let span = Span { start: 0, end: data.len() as u64 };
        let fields = Fields::read(&mut Cursor::new(data), span).map_err(defect)?;
        Ok(Self { data, fields })
    }

    fn slice(&self, span: Span) -> &'a [u8] {
        &self.data[span.start as usize..span.end as usize]
    }

    fn bytes(&self, number: u32) -> &'a [u8] {
        self.fields.bytes(number).map_or(&[], |span| self.slice(span))
    }

    fn text(&self, number: u32) -> String {
        String::from_utf8_lossy(self.bytes(number)).into_owned()
    }

    fn message(&self, number: u32) -> Result<Message<'a>, Defect> {
        Message::of(self.bytes(number))
    }

    fn messages(&self, number: u32) -> impl Iterator<Item = Result<Message<'a>, Defect>> {
        self.fields.all(number).map(|span| Message::of(self.slice(span)))
    }

    fn double(&self, number: u32) -> f64 {
        self.fields.double(number).unwrap_or(0.0)
    }

    fn integer(&self, number: u32) -> i64 {
        self.fields.integer(number).unwrap_or(0)
    }

    fn fixed32(&self, number: u32) -> u32 {
        self.fields.fixed32(number).unwrap_or(0)
    }

    fn doubles(&self, number: u32) -> Result<Vec<f64>, Defect> {
        self.fields.doubles(&mut Cursor::new(self.data), number).map_err(defect)
    }

    fn time(&self, number: u32) -> Result<Timestamp, Defect> {
        let time = self.message(number)?;
        Ok(timestamp(time.integer(1), time.integer(2)))
    }

    fn header(&self, time: u32, frame: u32) -> Result<Header, Defect> {
        Ok(Header { time: self.time(time)?, frame: frame_name(&self.text(frame)) })
    }

    fn vector(&self, number: u32) -> Result<[f64; 3], Defect> {
        let vector = self.message(number)?;
        Ok([1, 2, 3].map(|axis| vector.double(axis)))
    }

    /// A translation and a quaternion in these fields.
    fn pose(&self, translation: u32, rotation: u32) -> Result<RawPose, Defect> {
        let quaternion = self.message(rotation)?;
        Ok(RawPose {
            translation: self.vector(translation)?,
            rotation: [1, 2, 3, 4].map(|axis| quaternion.double(axis)),
        })
    }
}

/// `foxglove.PointCloud`.
pub(super) fn cloud(data: &[u8]) -> Result<Cloud, Defect> {
    let message = Message::of(data)?;
    let pose = match message.bytes(3) {
        [] => RawPose::IDENTITY,
        _ => message.message(3)?.pose(1, 2)?,
    };
    let fields = message.messages(5).map(|field| point_field(&field?));
    let points = message.bytes(6);
    let step = message.fixed32(4) as usize;
    Ok(Cloud {
        header: message.header(1, 2)?,
        pose,
        fields: fields.collect::<Result<_, _>>()?,
        rows: 1,
        width: points.len().checked_div(step).unwrap_or(0),
        row_step: points.len(),
        point_step: step,
        big_endian: false,
        data: points.to_vec(),
    })
}

fn point_field(field: &Message<'_>) -> Result<Field, Defect> {
    Ok(Field {
        name: field.text(1),
        offset: field.fixed32(2) as usize,
        kind: number_kind(field.integer(3))?,
    })
}

/// A number of `foxglove.PackedElementField`.
pub(super) fn number_kind(number: i64) -> Result<NumberKind, Defect> {
    Ok(match number {
        1 => NumberKind::U8,
        2 => NumberKind::I8,
        3 => NumberKind::U16,
        4 => NumberKind::I16,
        5 => NumberKind::U32,
        6 => NumberKind::I32,
        7 => NumberKind::F32,
        8 => NumberKind::F64,
        _ => return Err(Defect::new("a type of numbers from 1 to 8", number.to_string())),
    })
}

/// `foxglove.FrameTransform`.
pub(super) fn link(data: &[u8]) -> Result<Link, Defect> {
    frame_transform(&Message::of(data)?)
}

/// `foxglove.FrameTransforms`.
pub(super) fn links(data: &[u8]) -> Result<Vec<Link>, Defect> {
    Message::of(data)?.messages(1).map(|link| frame_transform(&link?)).collect()
}

fn frame_transform(message: &Message<'_>) -> Result<Link, Defect> {
    Ok(Link {
        header: message.header(1, 2)?,
        child: frame_name(&message.text(3)),
        parent_from_child: message.pose(4, 5)?,
    })
}

/// `foxglove.CameraCalibration`.
pub(super) fn optics(data: &[u8]) -> Result<Optics, Defect> {
    let message = Message::of(data)?;
    Ok(Optics {
        header: message.header(1, 9)?,
        width: message.fixed32(2),
        height: message.fixed32(3),
        model: message.text(4),
        distortion: message.doubles(5)?,
        matrix: message.doubles(6)?,
    })
}

/// `foxglove.SceneUpdate`.
pub(super) fn boxes(data: &[u8]) -> Result<Boxes, Defect> {
    const ALL: i64 = 1;
    let message = Message::of(data)?;
    let mut boxes = Boxes::default();
    for deletion in message.messages(1) {
        let deletion = deletion?;
        if deletion.integer(2) == ALL {
            boxes.cleared.push(deletion.time(1)?);
        }
    }
    for entity in message.messages(2) {
        boxes.cubes.extend(cubes(&entity?)?);
    }
    Ok(boxes)
}

/// The cubes of a `foxglove.SceneEntity`; of several, each is a track of its own.
fn cubes(entity: &Message<'_>) -> Result<Vec<Cube>, Defect> {
    let (header, id) = (entity.header(1, 2)?, entity.text(3));
    let mut category = String::new();
    for pair in entity.messages(6) {
        let pair = pair?;
        if pair.text(1) == "category" {
            category = pair.text(2);
        }
    }
    let several = entity.fields.all(8).count() > 1;
    let cube = |(place, cube): (usize, Result<Message<'_>, Defect>)| {
        let cube = cube?;
        Ok(Cube {
            header: header.clone(),
            track: if several { format!("{id}/{place}") } else { id.clone() },
            category: category.clone(),
            pose: cube.message(1)?.pose(1, 2)?,
            size_m: cube.vector(2)?,
        })
    };
    entity.messages(8).enumerate().map(cube).collect()
}

/// `foxglove.CompressedImage`, or `foxglove.RawImage` without its pixels.
pub(super) fn picture(data: &[u8], is_compressed: bool) -> Result<Picture, Defect> {
    let message = Message::of(data)?;
    let (frame, pixels) = if is_compressed { (4, message.bytes(2)) } else { (2, &[][..]) };
    Ok(Picture { header: message.header(1, frame)?, data: pixels.to_vec() })
}

fn defect(defect: wire::Defect) -> Defect {
    let wire::Defect { at, expected, found } = defect;
    Defect::new(format!("{expected} at byte {at} of the message"), found)
}
