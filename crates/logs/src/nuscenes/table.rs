//! The rows of a table that are wanted.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::io::BufReader;
use std::ops::Deref;
use std::path::Path;

use occlabel_core::Fault;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::number::without_bare_words;
use super::records::{Record, Records};
use super::token::Token;
use crate::files::open_file;

/// Tables are read in pieces of this size.
const BUFFER_BYTES: usize = 1 << 18;

/// Of a parser's complaint, which may quote the record, this many characters are shown.
const MAX_COMPLAINT_CHARS: usize = 200;

/// The fields of a table's row, as far as they are used.
pub(super) trait Table: DeserializeOwned {
    /// The table's file in the version folder.
    const FILE: &'static str;
}

/// A row, and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Row<T> {
    /// Its id.
    pub(super) token: Token,
    /// Where in the file it begins.
    pub(super) offset: u64,
    fields: T,
}

impl<T> Deref for Row<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.fields
    }
}

impl<T: Table> Row<T> {
    /// A fault of this row.
    pub(super) fn fault(
        &self,
        rule: &'static str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Fault {
        self.located(Fault::new(rule, T::FILE, expected, found))
    }

    /// A fault of the table as one of this row.
    pub(super) fn located(&self, fault: Fault) -> Fault {
        fault.record(self.token.to_string()).offset(self.offset)
    }

    /// The row of another table that this one names.
    ///
    /// # Errors
    /// If there is none.
    pub(super) fn follow<'a, U: Table>(
        &self,
        rows: &'a HashMap<Token, Row<U>>,
        token: &Token,
    ) -> Result<&'a Row<U>, Fault> {
        rows.get(token).ok_or_else(|| self.located(dangling::<T, U>(token)))
    }
}

/// Another row of table `T` has the same token.
pub(super) fn repeated<T: Table>() -> Fault {
    Fault::new("duplicate-token", T::FILE, "one row a token", "another one")
}

/// A row of table `T` names a row of table `U` that is not there.
pub(super) fn dangling<T: Table, U: Table>(token: &Token) -> Fault {
    Fault::new("dangling-token", T::FILE, format!("a row `{token}` in {}", U::FILE), "none")
}

/// The tokens by which a row is chosen before the rest of it is read.
#[derive(Deserialize)]
pub(super) struct Head {
    pub(super) token: Token,
    #[serde(default)]
    pub(super) scene_token: Option<Token>,
    #[serde(default)]
    pub(super) sample_token: Option<Token>,
    #[serde(default)]
    pub(super) calibrated_sensor_token: Option<Token>,
}

/// Reads a table row by row, and gives those that are `wanted` to `keep`.
///
/// # Errors
/// If there is no such file, it is no array of objects, or a row lacks a field or has one of another
/// type; or what `wanted` and `keep` say of a row.
pub(super) fn read_table<T: Table>(
    folder: &Path,
    mut wanted: impl FnMut(&Head) -> Result<bool, Fault>,
    mut keep: impl FnMut(Row<T>) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let path = folder.join(T::FILE);
    let file = open_file(&path, &path.to_string_lossy())?;
    let mut records = Records::new(BufReader::with_capacity(BUFFER_BYTES, file), T::FILE);
    while let Some(record) = records.next_record()? {
        let offset = record.offset;
        let head: Head = parse::<T, _>(&record, None)?;
        let locate = |fault: Fault| fault.record(head.token.to_string()).offset(offset);
        if wanted(&head).map_err(locate)? {
            let fields = parse::<T, T>(&record, Some(&head.token))?;
            keep(Row { token: head.token, offset, fields })?;
        }
    }
    Ok(())
}

/// The wanted rows of a table by their tokens.
///
/// # Errors
/// As [`read_table`]; or if two rows have one token.
pub(super) fn read_keyed<T: Table>(
    folder: &Path,
    mut wanted: impl FnMut(&Token) -> bool,
) -> Result<HashMap<Token, Row<T>>, Fault> {
    let mut rows = HashMap::new();
    let keep = |row: Row<T>| match rows.entry(row.token.clone()) {
        Entry::Vacant(entry) => {
            entry.insert(row);
            Ok(())
        }
        Entry::Occupied(_) => Err(row.located(repeated::<T>())),
    };
    read_table(folder, |head| Ok(wanted(&head.token)), keep)?;
    Ok(rows)
}

/// Reads fields of a record of table `T`, bare `NaN` and `Infinity` as `null`.
pub(super) fn parse<T: Table, F: DeserializeOwned>(
    record: &Record<'_>,
    token: Option<&Token>,
) -> Result<F, Fault> {
    let parsed = serde_json::from_slice(record.bytes);
    let parsed = parsed.or_else(|error| match without_bare_words(record.bytes) {
        Some(clean) => serde_json::from_slice(&clean),
        None => Err(error),
    });
    parsed.map_err(|error| {
        let complaint: String = error.to_string().chars().take(MAX_COMPLAINT_CHARS).collect();
        let found = format!("{complaint} of the record");
        let fault = Fault::new("table-record", T::FILE, "a row of this table", found);
        let fault = fault.offset(record.offset);
        match token {
            Some(token) => fault.record(token.to_string()),
            None => fault,
        }
    })
}
