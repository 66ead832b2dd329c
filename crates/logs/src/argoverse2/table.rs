//! A Feather file as columns.

use std::path::Path;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float16Type, Float32Type, Float64Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type,
    UInt64Type,
};
use arrow_array::{Array, RecordBatch};
use arrow_schema::DataType;
use occlabel_core::Fault;

use super::feather::Feather;
use crate::files::read_file;

/// The rows of a file.
pub(super) struct Table {
    file: String,
    batches: Vec<RecordBatch>,
}

impl Table {
    /// Reads a file of the log.
    ///
    /// # Errors
    /// If it is absent, no sound Arrow file, or unpacks to more than 1 GiB.
    pub(super) fn read(root: &Path, file: &str) -> Result<Self, Fault> {
        let feather = Feather::open(read_file(root, file)?);
        let batches = feather.and_then(Feather::unpack).map_err(|found| unsound(file, found))?;
        Ok(Self { file: file.to_owned(), batches })
    }

    /// How many rows a file of the log says that it has; they are not unpacked for it.
    ///
    /// # Errors
    /// If it is absent, or no sound Arrow file.
    pub(super) fn rows(root: &Path, file: &str) -> Result<u64, Fault> {
        let feather = Feather::open(read_file(root, file)?);
        feather.and_then(|feather| feather.rows()).map_err(|found| unsound(file, found))
    }

    /// A column of numbers of any type.
    pub(super) fn reals(&self, name: &str) -> Result<Vec<f64>, Fault> {
        self.column(name, "a column of numbers", reals)
    }

    /// A column of whole numbers.
    pub(super) fn integers(&self, name: &str) -> Result<Vec<i64>, Fault> {
        self.column(name, "a column of whole numbers", integers)
    }

    /// A column of texts.
    pub(super) fn texts(&self, name: &str) -> Result<Vec<String>, Fault> {
        self.column(name, "a column of texts", texts)
    }

    fn column<T>(
        &self,
        name: &str,
        expected: &str,
        read: impl Fn(&dyn Array) -> Option<Vec<T>>,
    ) -> Result<Vec<T>, Fault> {
        let mut values = Vec::new();
        for batch in &self.batches {
            let located = |found: String| fault(&self.file, expected, found).record(name);
            let column = batch.column_by_name(name).ok_or_else(|| located("none".into()))?;
            if column.null_count() > 0 {
                return Err(located(format!("{} nulls", column.null_count())));
            }
            let other = || located(format!("one of {}", column.data_type()));
            values.extend(read(column).ok_or_else(other)?);
        }
        Ok(values)
    }
}

fn unsound(file: &str, found: String) -> Fault {
    fault(file, "a sound Arrow file", found)
}

fn fault(file: &str, expected: &str, found: impl Into<String>) -> Fault {
    Fault::new("av2-table", file, expected, found)
}

fn reals(column: &dyn Array) -> Option<Vec<f64>> {
    Some(match column.data_type() {
        DataType::Float16 => {
            column.as_primitive::<Float16Type>().values().iter().map(|v| v.to_f64()).collect()
        }
        DataType::Float32 => {
            column.as_primitive::<Float32Type>().values().iter().map(|v| f64::from(*v)).collect()
        }
        DataType::Float64 => column.as_primitive::<Float64Type>().values().to_vec(),
        _ => integers(column)?.into_iter().map(|v| v as f64).collect(),
    })
}

fn integers(column: &dyn Array) -> Option<Vec<i64>> {
    Some(match column.data_type() {
        DataType::UInt8 => wide(column.as_primitive::<UInt8Type>().values()),
        DataType::UInt16 => wide(column.as_primitive::<UInt16Type>().values()),
        DataType::UInt32 => wide(column.as_primitive::<UInt32Type>().values()),
        DataType::Int32 => wide(column.as_primitive::<Int32Type>().values()),
        DataType::Int64 => column.as_primitive::<Int64Type>().values().to_vec(),
        DataType::UInt64 => {
            let values = column.as_primitive::<UInt64Type>().values();
            return values.iter().map(|v| i64::try_from(*v).ok()).collect();
        }
        _ => return None,
    })
}

fn wide<T: Copy + Into<i64>>(values: &[T]) -> Vec<i64> {
    values.iter().map(|value| (*value).into()).collect()
}

fn texts(column: &dyn Array) -> Option<Vec<String>> {
    let owned = |text: Option<&str>| text.map(str::to_owned);
    match column.data_type() {
        DataType::Utf8 => column.as_string::<i32>().iter().map(owned).collect(),
        DataType::LargeUtf8 => column.as_string::<i64>().iter().map(owned).collect(),
        _ => None,
    }
}
