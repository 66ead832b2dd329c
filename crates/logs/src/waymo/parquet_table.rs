//! A Parquet file, column by column.
//!
//! Columns are read as Parquet stores them: a list is so many values a row, whatever Arrow called it
//! (list, large list, list of fixed size), and a number is a number, in 32 bits or in 64.

use std::fs::File;
use std::ops::Range;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;
use parquet::errors::Result as ParquetResult;
use parquet::file::metadata::RowGroupMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::parquet_cursor::{Cursor, Cursors, guarded};
use crate::files::{open_file, unreadable};

/// A file of the log.
pub(super) struct Table {
    pub(super) file: String,
    reader: SerializedFileReader<File>,
}

/// A row: in which row group, and at which place of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Row {
    group: usize,
    row: usize,
}

/// Reads rows of a column.
type Read<T> = fn(&mut Cursor, Range<usize>) -> ParquetResult<Vec<Vec<T>>>;

impl Table {
    /// Opens a file below the root, reading its footer.
    ///
    /// # Errors
    /// If it is absent (`missing-file`), or no Parquet file.
    pub(super) fn open(root: &Path, file: String) -> Result<Self, Fault> {
        let opened = disk::into_std(open_file(&root.join(&file), &file)?)
            .map_err(|error| unreadable(&file, &error))?;
        let fault = |found: String| Fault::new("parquet", &file, "a Parquet file", found);
        let reader = guarded(|| SerializedFileReader::new(opened));
        let reader = reader.map_err(|error| fault(error.to_string()))?;
        match reader.metadata().row_groups().iter().all(is_sound) {
            true => Ok(Self { file, reader }),
            false => Err(fault("a column at a negative place, or of negative length".into())),
        }
    }

    /// Whether there is a column of that name.
    pub(super) fn has(&self, column: &str) -> bool {
        self.place_of(column).is_some()
    }

    /// The integer of every row; -1 where there is none.
    pub(super) fn integers(&self, column: &str) -> Result<Vec<i64>, Fault> {
        let cells = self.every(column, Cursor::integers)?;
        Ok(cells.into_iter().map(|cell| cell.first().copied().unwrap_or(-1)).collect())
    }

    /// The number of every row; NaN where there is none.
    pub(super) fn reals(&self, column: &str) -> Result<Vec<f64>, Fault> {
        let cells = self.every(column, Cursor::reals)?;
        Ok(cells.into_iter().map(|cell| cell.first().copied().unwrap_or(f64::NAN)).collect())
    }

    /// The list of numbers of every row; empty where there is none.
    pub(super) fn real_lists(&self, column: &str) -> Result<Vec<Vec<f64>>, Fault> {
        self.every(column, Cursor::reals)
    }

    /// The list of integers of every row; empty where there is none.
    pub(super) fn integer_lists(&self, column: &str) -> Result<Vec<Vec<i64>>, Fault> {
        self.every(column, Cursor::integers)
    }

    /// The text of every row; empty where there is none.
    pub(super) fn texts(&self, column: &str) -> Result<Vec<String>, Fault> {
        let cells = self.every(column, Cursor::texts)?;
        Ok(cells.into_iter().map(|mut cell| cell.pop().unwrap_or_default()).collect())
    }

    /// The list of numbers of one row, in single precision; empty if there is none.
    pub(super) fn floats_at(
        &self,
        cursors: &Cursors,
        column: &str,
        row: Row,
    ) -> Result<Vec<f32>, Fault> {
        self.at(cursors, column, row, Cursor::floats)
    }

    /// The list of integers of one row; empty if there is none.
    pub(super) fn integers_at(
        &self,
        cursors: &Cursors,
        column: &str,
        row: Row,
    ) -> Result<Vec<i64>, Fault> {
        self.at(cursors, column, row, Cursor::integers)
    }

    /// The bytes of one row; none if there are none.
    pub(super) fn bytes_at(
        &self,
        cursors: &Cursors,
        column: &str,
        row: Row,
    ) -> Result<Vec<u8>, Fault> {
        Ok(self.at(cursors, column, row, Cursor::bytes)?.pop().unwrap_or_default())
    }

    /// The first row whose integers in these columns are these.
    pub(super) fn find<const N: usize>(
        &self,
        keys: [(&str, i64); N],
    ) -> Result<Option<Row>, Fault> {
        for group in 0..self.reader.num_row_groups() {
            let mut columns = Vec::with_capacity(N);
            for (column, _) in keys {
                columns.push(self.group(column, group, Cursor::integers)?);
            }
            let is_it = |row: &usize| (0..N).all(|i| columns[i][*row] == [keys[i].1]);
            if let Some(row) = self.rows_of(group).find(is_it) {
                return Ok(Some(Row { group, row }));
            }
        }
        Ok(None)
    }

    /// Every row of a column.
    fn every<T>(&self, column: &str, read: Read<T>) -> Result<Vec<Vec<T>>, Fault> {
        let groups = 0..self.reader.num_row_groups();
        let groups = groups.map(|group| self.group(column, group, read));
        Ok(groups.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    }

    /// Every row of a column in a row group.
    fn group<T>(&self, column: &str, group: usize, read: Read<T>) -> Result<Vec<Vec<T>>, Fault> {
        let place = self.place(column, group)?;
        let cells = guarded(|| read(&mut self.begin(group, place)?, self.rows_of(group)));
        cells.map_err(|error| self.unreadable(column, group, error.to_string()))
    }

    fn at<T>(
        &self,
        cursors: &Cursors,
        column: &str,
        Row { group, row }: Row,
        read: Read<T>,
    ) -> Result<Vec<T>, Fault> {
        let place = self.place(column, group)?;
        let owner = (self.file.clone(), place, group);
        let cells = guarded(|| {
            let begun = cursors.take(&owner, row);
            let mut cursor = begun.map_or_else(|| self.begin(group, place), Ok)?;
            let cells = read(&mut cursor, row..row + 1)?;
            cursors.keep(owner, cursor);
            Ok(cells)
        });
        let cells = cells.map_err(|error| self.unreadable(column, group, error.to_string()));
        Ok(cells?.pop().unwrap_or_default())
    }

    fn begin(&self, group: usize, place: usize) -> ParquetResult<Cursor> {
        let pages = self.reader.get_row_group(group)?.get_column_page_reader(place)?;
        let schema = self.reader.metadata().file_metadata().schema_descr();
        Ok(Cursor::new(schema.column(place), pages))
    }

    /// So many rows as the file says; if there are fewer, reading them tells.
    fn rows_of(&self, group: usize) -> Range<usize> {
        let rows = self.reader.metadata().row_group(group).num_rows();
        0..usize::try_from(rows).unwrap_or(0)
    }

    fn place(&self, column: &str, group: usize) -> Result<usize, Fault> {
        let absent = || self.unreadable(column, group, "none of that name".into());
        self.place_of(column).ok_or_else(absent)
    }

    fn place_of(&self, column: &str) -> Option<usize> {
        let schema = self.reader.metadata().file_metadata().schema_descr();
        let is_it = |leaf: &usize| {
            schema.column(*leaf).path().parts().first().is_some_and(|name| name == column)
        };
        (0..schema.num_columns()).find(is_it)
    }

    fn unreadable(&self, column: &str, group: usize, found: String) -> Fault {
        Fault::new("parquet", &self.file, "a column that can be read", found)
            .record(format!("column {column}, row group {group}"))
    }
}

/// Whether no number of a row group is one that the library asserts against.
fn is_sound(group: &RowGroupMetaData) -> bool {
    group.columns().iter().all(|column| {
        let start = column.dictionary_page_offset().unwrap_or(0).min(column.data_page_offset());
        start >= 0 && column.compressed_size() >= 0
    })
}
