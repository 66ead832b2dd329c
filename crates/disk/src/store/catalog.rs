//! What is known of a folder of a store that does not change.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

use futures_util::stream::BoxStream;
use futures_util::{StreamExt, TryStreamExt};
use object_store::path::Path as Key;
use object_store::{ObjectMeta, Result as StoreResult};

use super::connection::{Connection, locked, patiently, wait_for};
use super::object::{entries, of_object};
use crate::Metadata;

/// How many objects stores tell of in one answer.
const PAGE: usize = 1000;

/// Objects and folders below a folder, as far as anyone asked.
///
/// Files of a log stand side by side in the order of their names: a page of the store's listing, from the
/// one that is asked for on, answers for the thousand that are asked for next.
#[derive(Debug)]
pub(crate) struct Catalog {
    pub(crate) folder: Key,
    known: Mutex<Known>,
}

#[derive(Debug, Default)]
struct Known {
    /// By their keys.
    found: BTreeMap<String, Metadata>,
    /// From one key to another, that one too, all objects are found.
    spans: Vec<(String, String)>,
    /// Folders in which all is found.
    folders: BTreeSet<String>,
}

impl Catalog {
    pub(crate) fn new(folder: Key) -> Self {
        Self { folder, known: Mutex::default() }
    }

    /// Whether an object is in this folder, or is the folder.
    pub(crate) fn holds(&self, key: &Key) -> bool {
        key.prefix_matches(&self.folder)
    }

    /// What stands under a name, if anything does.
    pub(crate) fn look(&self, to: &Connection, key: &Key) -> StoreResult<Option<Metadata>> {
        // Who comes second finds what the first one asks for.
        let mut known = locked(&self.known);
        if let Some(metadata) = known.found.get(key.as_ref()) {
            return Ok(Some(*metadata));
        }
        match to.has_pages {
            true => known.look_by_pages(to, key),
            false => known.look_by_folder(to, key),
        }
    }

    /// What was found under a name before.
    pub(crate) fn known(&self, key: &Key) -> Option<Metadata> {
        locked(&self.known).found.get(key.as_ref()).copied()
    }

    /// Notes all that is in a folder.
    pub(crate) fn note(&self, folder: &Key, entries: &[(Key, Metadata)]) {
        locked(&self.known).note(folder, entries);
    }
}

impl Known {
    fn look_by_folder(&mut self, to: &Connection, key: &Key) -> StoreResult<Option<Metadata>> {
        let folder = folder_of(key);
        if !self.folders.contains(folder.as_ref()) {
            let listed = patiently(|| to.store.list_with_delimiter(Some(&folder)));
            let listed = wait_for(listed)?;
            self.note(&folder, &entries(listed));
        }
        Ok(self.found.get(key.as_ref()).copied())
    }

    fn look_by_pages(&mut self, to: &Connection, key: &Key) -> StoreResult<Option<Metadata>> {
        if self.folders.contains(folder_of(key).as_ref()) {
            return Ok(None);
        }
        if !self.spans_over(key.as_ref()) {
            let folder = folder_of(key);
            let listed = || match before(key) {
                None => to.store.list(Some(&folder)),
                Some(before) => to.store.list_with_offset(Some(&folder), &before),
            };
            self.note_page(key.as_ref(), &last_of(&folder), listed)?;
        }
        match self.found.get(key.as_ref()) {
            Some(metadata) => Ok(Some(*metadata)),
            None => self.look_below(to, key),
        }
    }

    /// Whether there is a folder of this name.
    fn look_below(&mut self, to: &Connection, key: &Key) -> StoreResult<Option<Metadata>> {
        let below = format!("{key}/");
        if !self.spans_over(&below) {
            self.note_page(&below, &last_of(key), || to.store.list(Some(key)))?;
        }
        let next = self.found.range(below.clone()..).next();
        if next.is_none_or(|(key, _)| !key.starts_with(&below)) {
            return Ok(None);
        }
        let folder = Metadata::of_stored_folder();
        self.found.insert(key.as_ref().to_owned(), folder);
        Ok(Some(folder))
    }

    fn note(&mut self, folder: &Key, entries: &[(Key, Metadata)]) {
        let named = entries.iter().map(|(key, metadata)| (key.as_ref().to_owned(), *metadata));
        self.found.extend(named);
        self.folders.insert(folder.as_ref().to_owned());
    }

    /// Notes a page of a listing that tells of all objects from a key on, up to its end if it is short.
    fn note_page(
        &mut self,
        from: &str,
        end: &str,
        listed: impl Fn() -> BoxStream<'static, StoreResult<ObjectMeta>>,
    ) -> StoreResult<()> {
        let page = wait_for(patiently(|| listed().take(PAGE).try_collect::<Vec<_>>()))?;
        let last = page.last().filter(|_| page.len() == PAGE);
        let to = last.map_or(end, |last| last.location.as_ref()).to_owned();
        self.spans.push((from.to_owned(), to));
        let named = page.iter().map(|meta| (meta.location.as_ref().to_owned(), of_object(meta)));
        self.found.extend(named);
        Ok(())
    }

    fn spans_over(&self, key: &str) -> bool {
        self.spans.iter().any(|(from, to)| from.as_str() <= key && key <= to.as_str())
    }
}

fn folder_of(key: &Key) -> Key {
    let mut parts: Vec<_> = key.parts().collect();
    parts.pop();
    Key::from_iter(parts)
}

/// A key before this one in the same folder, with little between them; none if there is none.
fn before(key: &Key) -> Option<Key> {
    let mut text = key.as_ref().to_owned();
    text.pop();
    Key::parse(&text).ok().filter(|before| folder_of(before) == folder_of(key))
}

/// After all that is in a folder: `0` comes after `/`.
fn last_of(folder: &Key) -> String {
    match folder.as_ref() {
        "" => char::MAX.to_string(),
        folder => format!("{folder}0"),
    }
}
