//! Reading on in a column of a Parquet file.
//!
//! Parquet is read forwards: row 500 costs the 499 before it. So a column that was read up to some
//! row is kept, and who wants a later one goes on from there.

use std::fmt;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::{ParquetError, Result};
use parquet::schema::types::ColumnDescPtr;

/// One row may have so many values.
const MAX_VALUES: usize = 1 << 26;
/// So many columns are kept.
const MAX_KEPT: usize = 64;

/// A column of a row group, read up to some row.
pub(super) struct Cursor {
    column: ColumnReader,
    budget: Budget,
    /// The row that comes next.
    next: usize,
}

/// Whose cursor it is: file, column, row group.
pub(super) type Owner = (String, usize, usize);

/// Columns that were begun.
#[derive(Default)]
pub(super) struct Cursors(Mutex<Vec<(Owner, Cursor)>>);

impl fmt::Debug for Cursors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Cursors")
    }
}

impl Cursors {
    /// Takes out the column that is nearest before a row.
    pub(super) fn take(&self, owner: &Owner, row: usize) -> Option<Cursor> {
        let mut kept = self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let fits = |place: &usize| kept[*place].0 == *owner && kept[*place].1.next <= row;
        let place = (0..kept.len()).filter(fits).max_by_key(|place| kept[*place].1.next)?;
        Some(kept.remove(place).1)
    }

    /// Keeps a column for the next who wants it.
    pub(super) fn keep(&self, owner: Owner, cursor: Cursor) {
        let mut kept = self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if kept.len() == MAX_KEPT {
            kept.remove(0);
        }
        kept.push((owner, cursor));
    }
}

impl Cursor {
    /// Begins at the first row.
    pub(super) fn new(column: ColumnDescPtr, pages: Box<dyn PageReader>) -> Self {
        let budget = Budget::default();
        let pages = Box::new(CappedPages { pages, budget: budget.clone() });
        Self { column: get_column_reader(column, pages), budget, next: 0 }
    }

    /// The integers of each of these rows.
    pub(super) fn integers(&mut self, rows: Range<usize>) -> Result<Vec<Vec<i64>>> {
        let Self { column, budget, next } = self;
        match column {
            ColumnReader::Int32ColumnReader(column) => {
                cells(column, budget, next, rows, |value| i64::from(*value))
            }
            ColumnReader::Int64ColumnReader(column) => {
                cells(column, budget, next, rows, |value| *value)
            }
            _ => Err(ParquetError::General("a column of no integers".into())),
        }
    }

    /// The real numbers of each of these rows.
    pub(super) fn reals(&mut self, rows: Range<usize>) -> Result<Vec<Vec<f64>>> {
        let Self { column, budget, next } = self;
        match column {
            ColumnReader::FloatColumnReader(column) => {
                cells(column, budget, next, rows, |value| f64::from(*value))
            }
            ColumnReader::DoubleColumnReader(column) => {
                cells(column, budget, next, rows, |value| *value)
            }
            _ => Err(ParquetError::General("a column of no real numbers".into())),
        }
    }

    /// The real numbers of each of these rows, in single precision.
    pub(super) fn floats(&mut self, rows: Range<usize>) -> Result<Vec<Vec<f32>>> {
        let Self { column, budget, next } = self;
        match column {
            ColumnReader::FloatColumnReader(column) => {
                cells(column, budget, next, rows, |value| *value)
            }
            ColumnReader::DoubleColumnReader(column) => {
                cells(column, budget, next, rows, |value| *value as f32)
            }
            _ => Err(ParquetError::General("a column of no real numbers".into())),
        }
    }

    /// The bytes of each of these rows.
    pub(super) fn bytes(&mut self, rows: Range<usize>) -> Result<Vec<Vec<Vec<u8>>>> {
        let Self { column, budget, next } = self;
        match column {
            ColumnReader::ByteArrayColumnReader(column) => {
                cells(column, budget, next, rows, |value| value.data().to_vec())
            }
            _ => Err(ParquetError::General("a column of no bytes".into())),
        }
    }

    /// The text of each of these rows.
    pub(super) fn texts(&mut self, rows: Range<usize>) -> Result<Vec<Vec<String>>> {
        let Self { column, budget, next } = self;
        match column {
            ColumnReader::ByteArrayColumnReader(column) => {
                let text = |value: &[u8]| String::from_utf8_lossy(value).into_owned();
                cells(column, budget, next, rows, |value| text(value.data()))
            }
            _ => Err(ParquetError::General("a column of no texts".into())),
        }
    }
}

/// The values of each of these rows, one row at a time; none where the row has none.
fn cells<T: DataType, U>(
    column: &mut ColumnReaderImpl<T>,
    budget: &Budget,
    next: &mut usize,
    rows: Range<usize>,
    convert: impl Fn(&T::T) -> U,
) -> Result<Vec<Vec<U>>> {
    let mut found = Vec::new();
    let (mut definitions, mut repetitions, mut values) = (Vec::new(), Vec::new(), Vec::new());
    while *next < rows.end {
        budget.renew();
        let records = if *next < rows.start {
            column.skip_records(1)?
        } else {
            definitions.clear();
            repetitions.clear();
            values.clear();
            let levels = (Some(&mut definitions), Some(&mut repetitions));
            let (records, ..) = column.read_records(1, levels.0, levels.1, &mut values)?;
            found.push(values.iter().map(&convert).collect());
            records
        };
        if records != 1 {
            return Err(ParquetError::General(format!("{next} rows of {}", rows.end)));
        }
        *next += 1;
    }
    Ok(found)
}

/// What is read, or why not. The library asserts some of what a file says: a file that breaks such an
/// assertion is broken, and no reason to stop.
pub(super) fn guarded<T>(read: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(ParquetError::General("numbers that contradict each other".into())))
}

/// How many values may still be read for one row.
#[derive(Clone, Debug, Default)]
struct Budget(Arc<AtomicUsize>);

impl Budget {
    fn renew(&self) {
        self.0.store(MAX_VALUES, Ordering::Relaxed);
    }

    /// Spends values, if there are as many left.
    fn spend(&self, values: usize) -> Result<()> {
        let left = self.0.load(Ordering::Relaxed).checked_sub(values);
        let left = left.ok_or_else(|| {
            ParquetError::General(format!("more than {MAX_VALUES} values of one row"))
        })?;
        self.0.store(left, Ordering::Relaxed);
        Ok(())
    }
}

/// Pages, as far as the budget goes: a few bytes may stand for billions of equal values.
struct CappedPages {
    pages: Box<dyn PageReader>,
    budget: Budget,
}

impl PageReader for CappedPages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.pages.get_next_page()?;
        if let Some(page) = &page {
            self.budget.spend(page.num_values() as usize)?;
        }
        Ok(page)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.pages.skip_next_page()
    }

    fn at_record_boundary(&mut self) -> Result<bool> {
        self.pages.at_record_boundary()
    }
}

impl Iterator for CappedPages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_may_cost_no_more_than_its_budget() {
        let budget = Budget::default();
        assert!(budget.spend(1).is_err(), "nothing before it is renewed");
        budget.renew();
        assert!(budget.spend(MAX_VALUES - 1).is_ok() && budget.spend(1).is_ok());
        assert!(budget.spend(1).is_err());
        budget.renew();
        assert!(budget.spend(usize::MAX).is_err() && budget.spend(1).is_ok());
    }
}
