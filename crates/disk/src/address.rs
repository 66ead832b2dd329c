//! Paths that begin as a URL does.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// What a store's URL begins with.
const STORES: [&str; 8] = ["s3", "s3a", "gs", "az", "abfs", "abfss", "http", "https"];

/// What stands for a path on this machine.
const HERE: &str = "file";

/// Where in which store.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Address {
    /// `s3` of `s3://bucket/a/b`.
    pub(crate) scheme: String,
    /// `bucket`.
    pub(crate) host: String,
    /// `a/b`: without `.` and empty parts.
    pub(crate) key: String,
}

/// Whether a path is in a store of objects. There are no folders to be made there, no links, and no parts
/// of what is not whole: it has no name before.
pub fn is_stored(path: &Path) -> bool {
    split(path).is_some_and(|(scheme, _)| scheme != HERE)
}

impl Address {
    /// The address that a path is; none of a path on a disk.
    pub(crate) fn of(path: &Path) -> io::Result<Option<Self>> {
        let Some((scheme, rest)) = split(path).filter(|(scheme, _)| *scheme != HERE) else {
            return Ok(None);
        };
        if !STORES.contains(&scheme.as_str()) {
            return Err(wrong(&format!("no store of objects is called `{scheme}`")));
        }
        let (host, key) = rest.split_once('/').unwrap_or((rest, ""));
        let parts: Vec<&str> = key.split('/').filter(|part| !matches!(*part, "" | ".")).collect();
        if host.is_empty() {
            return Err(wrong("a URL without a bucket or host"));
        }
        if parts.contains(&"..") {
            return Err(wrong("a store has no `..`"));
        }
        Ok(Some(Self { scheme, host: host.to_owned(), key: parts.join("/") }))
    }
}

/// The path on this machine that `file:///a/b` is; none of what is no such URL.
pub(crate) fn path_of_file_url(path: &Path) -> io::Result<Option<PathBuf>> {
    let Some((_, rest)) = split(path).filter(|(scheme, _)| *scheme == HERE) else {
        return Ok(None);
    };
    match rest.strip_prefix("localhost").unwrap_or(rest) {
        path if path.starts_with('/') => Ok(Some(PathBuf::from(path))),
        _ => Err(wrong("a file's URL has three slashes and a full path: file:///a/b")),
    }
}

/// Scheme, in lower case, and what follows `//`. Paths put together from their parts have lost a slash.
fn split(path: &Path) -> Option<(String, &str)> {
    let (scheme, rest) = path.to_str()?.split_once(":/")?;
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"+-.".contains(&byte);
    let is_scheme = scheme.len() > 1 && scheme.bytes().all(is_plain);
    let scheme = scheme.to_ascii_lowercase();
    let is_known = scheme == HERE || STORES.contains(&scheme.as_str());
    match rest.strip_prefix('/') {
        Some(rest) if is_scheme => Some((scheme, rest)),
        // `file:/a` is a full path, and `s3:/bucket` was a URL.
        None if is_known => Some((scheme.clone(), rest)).filter(|_| scheme != HERE),
        _ => None,
    }
}

fn wrong(what: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidInput, what)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(path: &str) -> Option<[String; 3]> {
        let found = Address::of(Path::new(path)).unwrap();
        found.map(|Address { scheme, host, key }| [scheme, host, key])
    }

    #[test]
    fn a_url_is_an_address_and_a_path_is_not() {
        let told = ["s3", "bucket", "a/b"].map(str::to_owned);
        for path in ["s3://bucket/a/b", "s3:/bucket/a/b", "s3://bucket//a/./b/"] {
            assert_eq!(address(path), Some(told.clone()), "{path}");
        }
        assert_eq!(
            address("http://127.0.0.1:80"),
            Some(["http", "127.0.0.1:80", ""].map(Into::into))
        );
        let joined = Path::new("gs://b").join("x").components().collect::<PathBuf>();
        assert_eq!(address(joined.to_str().unwrap()), Some(["gs", "b", "x"].map(Into::into)));
        assert_eq!(address("S3://Bucket/A"), Some(["s3", "Bucket", "A"].map(Into::into)));
        for path in ["/a/b", "a/s3://b", "s3", "s3:a", "C:/a", "C://a", "x:/a", "file:///a/b"] {
            assert_eq!(address(path), None, "{path}");
            assert!(!is_stored(Path::new(path)), "{path}");
        }
    }

    #[test]
    fn a_url_without_a_host_or_with_a_way_up_is_none() {
        for path in ["s3://", "s3:///log", "s3://bucket/a/../b", "ftp://host/a", "x1://a"] {
            assert!(is_stored(Path::new(path)) && Address::of(Path::new(path)).is_err(), "{path}");
        }
    }

    #[test]
    fn a_files_url_is_a_path_here() {
        let path = |url| path_of_file_url(Path::new(url));
        for url in ["file:///a/b", "FILE:///a/b", "file://localhost/a/b"] {
            assert_eq!(path(url).unwrap(), Some("/a/b".into()), "{url}");
        }
        assert_eq!(path("/a/b").unwrap(), None);
        assert!(path("file://host/a").is_err() && path("file://a").is_err());
    }
}
