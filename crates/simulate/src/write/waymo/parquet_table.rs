//! A Parquet file that grows by rows.
//!
//! Lists are written as Arrow writes them: a group `list` of `element`s, none of them null.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::sync::Arc;

use occlabel_core::Fault;
use parquet::basic::{Compression, ConvertedType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{
    ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type,
};
use parquet::errors::{ParquetError, Result};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};

use crate::write::files::OutputFile;

/// What a column holds.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Text,
    Long,
    /// A number of an enumeration.
    Byte,
    Integer,
    Real,
    Integers,
    Floats,
    Reals,
}

/// A column's value in a row.
#[derive(Debug)]
pub(super) enum Cell {
    Text(String),
    Long(i64),
    Integer(i32),
    Real(f64),
    Integers(Vec<i32>),
    Floats(Vec<f32>),
    Reals(Vec<f64>),
}

/// A file, and the rows that are not in it yet.
pub(super) struct Table {
    path: PathBuf,
    writer: SerializedFileWriter<BufWriter<File>>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// Begins a file of these columns.
    pub(super) fn create(file: OutputFile, columns: &[(&str, Kind)]) -> Result<Self, Fault> {
        let (path, file) = file.into_parts();
        let writer = begin(file, columns).map_err(|error| refused(&path, error))?;
        Ok(Self { path, writer, rows: Vec::new() })
    }

    /// Adds a row: a cell for each column.
    pub(super) fn push(&mut self, row: Vec<Cell>) {
        self.rows.push(row);
    }

    /// Writes the rows so far, as a row group.
    pub(super) fn flush(&mut self) -> Result<(), Fault> {
        let rows = std::mem::take(&mut self.rows);
        write_group(&mut self.writer, &rows).map_err(|error| refused(&self.path, error))
    }

    /// Writes what is left.
    pub(super) fn finish(mut self) -> Result<(), Fault> {
        self.flush()?;
        let finished = self.writer.into_inner().and_then(|mut file| Ok(file.flush()?));
        finished.map_err(|error| refused(&self.path, error))
    }
}

fn refused(path: &std::path::Path, error: ParquetError) -> Fault {
    Fault::new("write", path.display().to_string(), "to write here", error.to_string())
}

fn begin(
    file: BufWriter<File>,
    columns: &[(&str, Kind)],
) -> Result<SerializedFileWriter<BufWriter<File>>> {
    let fields = columns.iter().map(|(name, kind)| field(name, *kind).map(Arc::new));
    let schema = Type::group_type_builder("schema").with_fields(fields.collect::<Result<_>>()?);
    let properties = WriterProperties::builder()
        .set_created_by("occlabel".into())
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(1)?))
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None);
    SerializedFileWriter::new(file, Arc::new(schema.build()?), Arc::new(properties.build()))
}

fn field(name: &str, kind: Kind) -> Result<Type> {
    let (physical, converted) = match kind {
        Kind::Text => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
        Kind::Long => (Physical::INT64, ConvertedType::NONE),
        Kind::Byte => (Physical::INT32, ConvertedType::INT_8),
        Kind::Integer | Kind::Integers => (Physical::INT32, ConvertedType::NONE),
        Kind::Floats => (Physical::FLOAT, ConvertedType::NONE),
        Kind::Real | Kind::Reals => (Physical::DOUBLE, ConvertedType::NONE),
    };
    let leaf = |name| {
        let leaf = Type::primitive_type_builder(name, physical);
        leaf.with_repetition(Repetition::REQUIRED).with_converted_type(converted).build()
    };
    match kind {
        Kind::Integers | Kind::Floats | Kind::Reals => list(name, Arc::new(leaf("element")?)),
        _ => leaf(name),
    }
}

fn list(name: &str, element: TypePtr) -> Result<Type> {
    let repeated = Type::group_type_builder("list").with_repetition(Repetition::REPEATED);
    let repeated = repeated.with_fields(vec![element]).build()?;
    Type::group_type_builder(name)
        .with_repetition(Repetition::REQUIRED)
        .with_converted_type(ConvertedType::LIST)
        .with_fields(vec![Arc::new(repeated)])
        .build()
}

fn write_group(
    writer: &mut SerializedFileWriter<BufWriter<File>>,
    rows: &[Vec<Cell>],
) -> Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    let mut group = writer.next_row_group()?;
    let mut column = 0;
    while let Some(mut writer) = group.next_column()? {
        write_column(&mut writer, rows, column)?;
        writer.close()?;
        column += 1;
    }
    group.close().map(drop)
}

/// The cells of a column are of one kind: the first row's.
fn write_column(
    writer: &mut SerializedColumnWriter,
    rows: &[Vec<Cell>],
    column: usize,
) -> Result<()> {
    macro_rules! cells {
        ($kind:ident) => {
            rows.iter().filter_map(|row| match &row[column] {
                Cell::$kind(value) => Some(value),
                _ => None,
            })
        };
    }
    match rows[0][column] {
        Cell::Text(_) => {
            let texts = cells!(Text).map(|text| ByteArray::from(text.as_str()));
            write_values::<ByteArrayType>(writer, texts.collect())
        }
        Cell::Long(_) => write_values::<Int64Type>(writer, cells!(Long).copied().collect()),
        Cell::Integer(_) => write_values::<Int32Type>(writer, cells!(Integer).copied().collect()),
        Cell::Real(_) => write_values::<DoubleType>(writer, cells!(Real).copied().collect()),
        Cell::Integers(_) => write_lists::<Int32Type>(writer, cells!(Integers)),
        Cell::Floats(_) => write_lists::<FloatType>(writer, cells!(Floats)),
        Cell::Reals(_) => write_lists::<DoubleType>(writer, cells!(Reals)),
    }
}

fn write_values<T: DataType>(writer: &mut SerializedColumnWriter, values: Vec<T::T>) -> Result<()> {
    writer.typed::<T>().write_batch(&values, None, None).map(drop)
}

/// Levels (parquet.apache.org, "Nested Encoding"): an element is defined at 1; the first of a row
/// repeats at 0, others at 1. An empty list is one place, defined at 0.
fn write_lists<'a, T: DataType>(
    writer: &mut SerializedColumnWriter,
    lists: impl Iterator<Item = &'a Vec<T::T>>,
) -> Result<()> {
    let (mut values, mut defined, mut repeats) = (Vec::new(), Vec::new(), Vec::new());
    for list in lists {
        repeats.push(0);
        repeats.extend(std::iter::repeat_n(1, list.len().saturating_sub(1)));
        defined.extend(std::iter::repeat_n(i16::from(!list.is_empty()), list.len().max(1)));
        values.extend_from_slice(list);
    }
    writer.typed::<T>().write_batch(&values, Some(&defined), Some(&repeats)).map(drop)
}
