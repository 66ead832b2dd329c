//! What is done with an object of a store.

use std::fmt::Debug;
use std::io::{self, Read, Seek};

use crate::Metadata;

/// An object of a store, or a folder of objects: by its name, whether it is there or not.
pub(crate) trait Storage: Debug + Send + Sync {
    /// Its bytes, from anywhere.
    fn open(&self) -> io::Result<Box<dyn StoredFile>>;

    /// What the store says of it.
    fn metadata(&self) -> io::Result<Metadata>;

    /// The names of what is in it.
    fn list(&self) -> io::Result<Vec<(String, Metadata)>>;

    /// Gives it so many bytes, all at once: nobody sees a part of them.
    fn put(&self, from: &mut dyn Read, bytes: u64, how: &Put) -> io::Result<()>;

    /// Removes it. One that is not there is no error.
    fn remove(&self) -> io::Result<()>;

    /// Nothing below it will change as long as the program runs: what is known of it need not be asked
    /// for again.
    fn expect_no_change(&self);

    /// These files below it will be read about in this order: names and sizes.
    fn expect(&self, files: &mut dyn Iterator<Item = (&str, u64)>);

    /// The memory that so many readers at once take at most.
    fn reading_bytes(&self, readers: usize) -> u64;
}

/// What becomes of an object that is there already.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Put {
    /// It is replaced.
    Over,
    /// It stays: `AlreadyExists`.
    New,
    /// It is replaced if it still is of this version: else `NotFound`.
    InPlaceOf(Option<String>),
}

/// An object that is read.
pub(crate) trait StoredFile: Read + Seek + Debug + Send + Sync {
    /// Its length in bytes.
    fn len(&self) -> u64;

    /// Its version, if the store tells one.
    fn version(&self) -> Option<&str>;
}
