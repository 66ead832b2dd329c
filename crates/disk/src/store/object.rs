//! An object of a store, or a folder of objects.

use std::io::{self, ErrorKind, Read};
use std::sync::Arc;

use futures_util::StreamExt;
use object_store::path::Path as Key;
use object_store::{ListResult, ObjectMeta, ObjectStore, ObjectStoreExt};

use super::catalog::Catalog;
use super::connection::{Connection, locked, patiently, wait_for};
use super::errors::io_error;
use super::expected::{MAX_AHEAD_BYTES, MAX_OBJECT_BYTES};
use super::ranged_file::{READER_BYTES, RangedFile};
use super::recent::RECENT_BYTES;
use super::upload;
use crate::Metadata;
use crate::address::Address;
use crate::storage::{Put, Storage, StoredFile};

/// What the client for HTTP takes: connections, their encryption, threads.
const CLIENT_BYTES: u64 = 16 << 20;

/// An object by its name, whether it is there or not.
#[derive(Clone, Debug)]
pub(crate) struct Object {
    pub(crate) connection: Arc<Connection>,
    pub(crate) key: Key,
}

impl Object {
    /// The object of this address.
    pub(crate) fn at(address: &Address) -> io::Result<Self> {
        let wrong = |error: object_store::path::Error| {
            io::Error::new(ErrorKind::InvalidInput, error.to_string())
        };
        let key = Key::parse(&address.key).map_err(wrong)?;
        Ok(Self { connection: Connection::to(address)?, key })
    }

    fn store(&self) -> &dyn ObjectStore {
        &*self.connection.store
    }

    /// Its length, if it is remembered.
    fn known_bytes(&self) -> Option<u64> {
        let catalog = self.connection.catalog_of(&self.key)?;
        catalog.known(&self.key).filter(Metadata::is_file).map(|known| known.bytes())
    }

    /// Whether anything is below it.
    fn is_folder(&self) -> io::Result<bool> {
        let first = patiently(async || self.store().list(Some(&self.key)).next().await.transpose());
        wait_for(first).map(|first| first.is_some()).map_err(io_error)
    }

    /// Where it is looked up; none if the store is best asked for itself.
    fn catalog(&self) -> Option<Arc<Catalog>> {
        let known = self.connection.catalog_of(&self.key);
        let known = known.filter(|catalog| catalog.folder != self.key);
        let listing = || Arc::new(Catalog::new(Key::default()));
        known.or_else(|| self.connection.has_folders.then(listing))
    }
}

impl Storage for Object {
    fn open(&self) -> io::Result<Box<dyn StoredFile>> {
        let fetched = locked(&self.connection.expected).take(&self.connection, &self.key);
        let file = match fetched {
            Some(fetched) => wait_for(fetched).map(|piece| RangedFile::of(self.clone(), piece)),
            None => match self.known_bytes() {
                Some(0) | None => RangedFile::open(self.clone()),
                Some(bytes) => Ok(RangedFile::unread(self.clone(), bytes)),
            },
        };
        file.map(|file| Box::new(file) as _).map_err(io_error)
    }

    fn metadata(&self) -> io::Result<Metadata> {
        if self.key.as_ref().is_empty() {
            return Ok(Metadata::of_stored_folder());
        }
        if let Some(catalog) = self.catalog() {
            let found = catalog.look(&self.connection, &self.key).map_err(io_error)?;
            return found.ok_or_else(|| ErrorKind::NotFound.into());
        }
        match wait_for(self.store().head(&self.key)) {
            Ok(meta) => Ok(of_object(&meta)),
            Err(object_store::Error::NotFound { .. }) if self.is_folder()? => {
                Ok(Metadata::of_stored_folder())
            }
            Err(error) => Err(io_error(error)),
        }
    }

    fn list(&self) -> io::Result<Vec<(String, Metadata)>> {
        let listed = patiently(|| self.store().list_with_delimiter(Some(&self.key)));
        let listed = wait_for(listed);
        let entries = entries(listed.map_err(io_error)?);
        if let Some(catalog) = self.connection.catalog_of(&self.key) {
            catalog.note(&self.key, &entries);
        }
        if entries.is_empty() && !self.key.as_ref().is_empty() {
            return Err(ErrorKind::NotFound.into());
        }
        let named = |(key, metadata): (Key, _)| Some((key.filename()?.to_owned(), metadata));
        Ok(entries.into_iter().filter_map(named).collect())
    }

    fn put(&self, from: &mut dyn Read, bytes: u64, how: &Put) -> io::Result<()> {
        upload::put(self, from, bytes, how)
    }

    fn remove(&self) -> io::Result<()> {
        match wait_for(patiently(|| self.store().delete(&self.key))) {
            Err(object_store::Error::NotFound { .. }) => Ok(()),
            removed => removed.map_err(io_error),
        }
    }

    fn expect_no_change(&self) {
        self.connection.remember(&self.key);
    }

    fn expect(&self, files: &mut dyn Iterator<Item = (&str, u64)>) {
        let below = |name: &str| Key::parse(format!("{}/{name}", self.key)).ok();
        let files = files.filter_map(|(name, bytes)| Some((below(name)?, bytes)));
        locked(&self.connection.expected).replace(files.collect());
    }

    fn reading_bytes(&self, readers: usize) -> u64 {
        CLIENT_BYTES
            + MAX_AHEAD_BYTES
            + RECENT_BYTES
            + readers as u64 * (MAX_OBJECT_BYTES + READER_BYTES)
    }
}

/// What is in a folder: objects, and folders that hold some.
pub(crate) fn entries(listed: ListResult) -> Vec<(Key, Metadata)> {
    let folders = listed.common_prefixes.into_iter().map(|key| (key, Metadata::of_stored_folder()));
    let objects = listed.objects.into_iter().map(|meta| (meta.location.clone(), of_object(&meta)));
    folders.chain(objects).collect()
}

pub(crate) fn of_object(meta: &ObjectMeta) -> Metadata {
    Metadata::of_object(meta.size, meta.last_modified.into())
}
