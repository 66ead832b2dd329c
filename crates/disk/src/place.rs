//! Whether a path is on a disk or in a store.

use std::borrow::Cow;
use std::io;
use std::path::Path;

use crate::address::{Address, path_of_file_url};
use crate::storage::Storage;

/// Where a path leads.
pub(crate) enum Place<'a> {
    /// To a file or folder of this machine.
    Local(Cow<'a, Path>),
    /// To an object, or a folder of objects.
    Stored(Box<dyn Storage>),
}

impl<'a> Place<'a> {
    /// Where this path leads.
    pub(crate) fn of(path: &'a Path) -> io::Result<Self> {
        if let Some(address) = Address::of(path)? {
            return stored(&address).map(Self::Stored);
        }
        Ok(Self::Local(path_of_file_url(path)?.map_or(Cow::Borrowed(path), Cow::Owned)))
    }
}

#[cfg(feature = "stores")]
fn stored(address: &Address) -> io::Result<Box<dyn Storage>> {
    crate::store::Object::at(address).map(|object| Box::new(object) as _)
}

#[cfg(not(feature = "stores"))]
fn stored(address: &Address) -> io::Result<Box<dyn Storage>> {
    let Address { scheme, .. } = address;
    let what = format!("`{scheme}://` needs a program built with the cargo feature `stores`");
    Err(io::Error::new(io::ErrorKind::Unsupported, what))
}
