//! What is read of a point, and where it stands in a record.

use std::collections::BTreeMap;

/// A number of a point that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Column {
    X,
    Y,
    Z,
    NormalX,
    NormalY,
    NormalZ,
    Opacity,
    Scale0,
    Scale1,
    Rot0,
    Rot1,
    Rot2,
    Rot3,
    Class,
    Track,
}

/// Each column by the names that files give it; what has another name is not read.
const NAMES: [(Column, &[&str]); COLUMNS] = [
    (Column::X, &["x"]),
    (Column::Y, &["y"]),
    (Column::Z, &["z"]),
    (Column::NormalX, &["nx", "normal_x"]),
    (Column::NormalY, &["ny", "normal_y"]),
    (Column::NormalZ, &["nz", "normal_z"]),
    (Column::Opacity, &["opacity"]),
    (Column::Scale0, &["scale_0"]),
    (Column::Scale1, &["scale_1"]),
    (Column::Rot0, &["rot_0"]),
    (Column::Rot1, &["rot_1"]),
    (Column::Rot2, &["rot_2"]),
    (Column::Rot3, &["rot_3"]),
    (Column::Class, &["class", "label"]),
    (Column::Track, &["track"]),
];

/// How many there are.
const COLUMNS: usize = Column::Track as usize + 1;

/// The numbers of a point; NaN where a file has none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row([f64; COLUMNS]);

/// Which columns a file has.
pub(super) type Columns = BTreeMap<Column, usize>;

/// How a number is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// Which byte of a number comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    Little,
    Big,
}

/// Where the numbers of a point stand in its bytes.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    order: Order,
    bytes: usize,
    places: Vec<(Column, usize, Kind)>,
}

impl Column {
    /// The column that a file calls so.
    pub(super) fn named(name: &str) -> Option<Self> {
        NAMES.iter().find(|(_, names)| names.contains(&name)).map(|(column, _)| *column)
    }
}

impl Row {
    /// Of a point of which nothing is known.
    pub(super) fn empty() -> Self {
        Self([f64::NAN; COLUMNS])
    }

    pub(super) fn set(&mut self, column: Column, number: f64) {
        self.0[column as usize] = number;
    }

    pub(super) fn get(&self, column: Column) -> f64 {
        self.0[column as usize]
    }

    pub(super) fn all<const N: usize>(&self, columns: [Column; N]) -> [f64; N] {
        columns.map(|column| self.get(column))
    }
}

impl Kind {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number that some bytes begin with; NaN if there are too few of them.
    pub(super) fn read(self, bytes: &[u8], order: Order) -> f64 {
        macro_rules! number {
            ($kind:ty) => {
                bytes.first_chunk().map_or(f64::NAN, |bytes| match order {
                    Order::Little => <$kind>::from_le_bytes(*bytes).into(),
                    Order::Big => <$kind>::from_be_bytes(*bytes).into(),
                })
            };
        }
        match self {
            Self::I8 => number!(i8),
            Self::U8 => number!(u8),
            Self::I16 => number!(i16),
            Self::U16 => number!(u16),
            Self::I32 => number!(i32),
            Self::U32 => number!(u32),
            Self::F32 => number!(f32),
            Self::F64 => number!(f64),
        }
    }
}

impl Layout {
    /// Of records whose fields stand one behind the other: the name of each, how its numbers are written,
    /// and how many they are. Of several fields of one column the first counts.
    pub(super) fn new<'a>(
        order: Order,
        fields: impl IntoIterator<Item = (&'a str, Kind, usize)>,
    ) -> Self {
        let mut layout = Self { order, bytes: 0, places: Vec::new() };
        for (name, kind, count) in fields {
            let known = Column::named(name).filter(|column| !layout.has(*column));
            layout.places.extend(known.map(|column| (column, layout.bytes, kind)));
            layout.bytes = layout.bytes.saturating_add(kind.bytes().saturating_mul(count));
        }
        layout
    }

    /// Bytes of a record.
    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }

    pub(super) fn has(&self, column: Column) -> bool {
        self.places.iter().any(|(known, ..)| *known == column)
    }

    pub(super) fn columns(&self) -> Columns {
        self.places.iter().map(|(column, place, _)| (*column, *place)).collect()
    }

    /// The numbers of a record.
    pub(super) fn row(&self, record: &[u8]) -> Row {
        let mut row = Row::empty();
        for (column, place, kind) in &self.places {
            row.set(*column, kind.read(record.get(*place..).unwrap_or_default(), self.order));
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_at_their_numbers() {
        assert!(NAMES.iter().enumerate().all(|(at, (column, _))| *column as usize == at));
    }

    #[test]
    fn numbers_are_read_in_either_order_and_never_beyond_a_record() {
        let fields = [("x", Kind::F64, 1), ("rgb", Kind::U8, 3), ("label", Kind::I16, 1)];
        for (order, label) in [(Order::Little, 258.0), (Order::Big, 513.0)] {
            let layout = Layout::new(order, fields);
            let x = match order {
                Order::Little => 1.5_f64.to_le_bytes(),
                Order::Big => 1.5_f64.to_be_bytes(),
            };
            let record = [&x[..], &[9, 9, 9, 2, 1]].concat();
            assert_eq!((layout.bytes(), layout.has(Column::Y)), (13, false));
            assert_eq!(layout.row(&record).all([Column::X, Column::Class]), [1.5, label]);
            assert!(layout.row(&record[..12]).get(Column::Class).is_nan());
            assert!(layout.row(&record).get(Column::Y).is_nan());
        }
    }
}
