//! Points of a cloud, decoded.

use nalgebra::Point3;

use super::messages::{Cloud, Defect, Field, NumberKind};

/// A cloud's bytes, checked against what they are said to hold.
pub(super) struct Points<'a> {
    cloud: &'a Cloud,
    axes: [&'a Field; 3],
}

impl NumberKind {
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl<'a> Points<'a> {
    /// The points of a cloud.
    ///
    /// # Errors
    /// If they have no x, y, z, a field does not lie within its point, or there are fewer or more
    /// bytes than points.
    pub(super) fn new(cloud: &'a Cloud) -> Result<Self, Defect> {
        let (step, data) = (cloud.point_step, cloud.data.len());
        let row_bytes = cloud.width.checked_mul(step);
        let all_bytes = cloud.rows.checked_mul(cloud.row_step);
        let is_whole = match (row_bytes, all_bytes) {
            (Some(row), Some(all)) => row <= cloud.row_step && all == data,
            _ => false,
        };
        if step == 0 {
            return Err(Defect::new("a stride of 1 byte or more a point", "0"));
        }
        if !is_whole || (cloud.rows == 1 && row_bytes != Some(data)) {
            let Cloud { rows, width, row_step, .. } = cloud;
            let expected =
                format!("{rows} x {width} points of {step} bytes in rows of {row_step} bytes");
            return Err(Defect::new(expected, format!("{data} bytes")));
        }
        let outside = |field: &&Field| {
            field.offset.checked_add(field.kind.size()).is_none_or(|end| end > step)
        };
        if let Some(field) = cloud.fields.iter().find(outside) {
            let expected = format!("field `{}` within {step} bytes a point", field.name);
            return Err(Defect::new(expected, format!("offset {}", field.offset)));
        }
        let axes = [axis(cloud, "x")?, axis(cloud, "y")?, axis(cloud, "z")?];
        Ok(Self { cloud, axes })
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.cloud.rows * self.cloud.width
    }

    /// Where they are, in the frame of the points, metres.
    pub(super) fn positions(&self) -> impl Iterator<Item = Point3<f64>> {
        (0..self.len()).map(|i| Point3::from(self.axes.map(|axis| self.number(i, axis))))
    }

    /// All numbers of a field.
    ///
    /// # Errors
    /// If there is no such field.
    pub(super) fn numbers(&self, name: &str) -> Result<impl Iterator<Item = f64>, Defect> {
        let field = axis(self.cloud, name)?;
        Ok((0..self.len()).map(move |i| self.number(i, field)))
    }

    fn number(&self, point: usize, field: &Field) -> f64 {
        let Cloud { width, row_step, point_step, .. } = *self.cloud;
        let start = point / width * row_step + point % width * point_step + field.offset;
        let stored = &self.cloud.data[start..start + field.kind.size()];
        let mut bytes = [0; 8];
        bytes[..stored.len()].copy_from_slice(stored);
        if self.cloud.big_endian {
            bytes[..stored.len()].reverse();
        }
        let [a, b, c, d, ..] = bytes;
        match field.kind {
            NumberKind::I8 => f64::from(a as i8),
            NumberKind::U8 => f64::from(a),
            NumberKind::I16 => f64::from(i16::from_le_bytes([a, b])),
            NumberKind::U16 => f64::from(u16::from_le_bytes([a, b])),
            NumberKind::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            NumberKind::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            NumberKind::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            NumberKind::F64 => f64::from_le_bytes(bytes),
        }
    }
}

fn axis<'a>(cloud: &'a Cloud, name: &str) -> Result<&'a Field, Defect> {
    cloud.fields.iter().find(|field| field.name == name).ok_or_else(|| {
        let names: Vec<_> = cloud.fields.iter().map(|field| field.name.as_str()).collect();
        Defect::new(format!("a field `{name}` of points"), names.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::super::messages::{Header, RawPose};
    use super::*;

    /// Two rows of two points, each row with 3 bytes too many: x as i16, y as u8, z as i8.
    fn cloud(big_endian: bool) -> Cloud {
        let field = |name: &str, offset, kind| Field { name: name.into(), offset, kind };
        let x = |x: i16| if big_endian { x.to_be_bytes() } else { x.to_le_bytes() };
        let point = |n: i16| [&x(-300 * n)[..], &[n as u8, (-n) as u8]].concat();
        let row = |n| [point(n), point(n + 1), vec![0xff; 3]].concat();
        Cloud {
            header: Header::default(),
            pose: RawPose::IDENTITY,
            fields: vec![
                field("x", 0, NumberKind::I16),
                field("y", 2, NumberKind::U8),
                field("z", 3, NumberKind::I8),
            ],
            rows: 2,
            width: 2,
            row_step: 11,
            point_step: 4,
            big_endian,
            data: [row(1), row(3)].concat(),
        }
    }

    #[test]
    fn points_are_read_by_rows_and_fields_in_either_order_of_bytes() {
        for big_endian in [false, true] {
            let cloud = cloud(big_endian);
            let points: Vec<_> = Points::new(&cloud).unwrap().positions().collect();
            let expected = [1.0, 2.0, 3.0, 4.0].map(|n| Point3::new(-300.0 * n, n, -n));
            assert_eq!(points, expected);
        }
    }

    #[test]
    fn sizes_that_do_not_fit_are_refused() {
        let broken: [fn(&mut Cloud); 7] = [
            |cloud| cloud.width = 3,
            |cloud| cloud.rows = 3,
            |cloud| cloud.point_step = 0,
            |cloud| (cloud.width, cloud.point_step) = (usize::MAX, 2),
            |cloud| cloud.data.truncate(21),
            |cloud| cloud.fields[0].offset = usize::MAX,
            |cloud| cloud.fields[2].name = "w".into(),
        ];
        for (number, breaking) in broken.into_iter().enumerate() {
            let mut cloud = cloud(false);
            breaking(&mut cloud);
            assert!(Points::new(&cloud).is_err(), "{number}");
        }
    }
}
