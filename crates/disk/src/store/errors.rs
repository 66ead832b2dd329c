//! What a store's error is on a disk.

use std::io::{self, ErrorKind};

use object_store::Error;

/// The longest text of an error that is told: some stores send a page.
const MAX_CHARACTERS: usize = 300;

/// The error in a line, of the kind that a disk would give.
pub(crate) fn io_error(error: Error) -> io::Error {
    let kind = match &error {
        Error::NotFound { .. } => ErrorKind::NotFound,
        Error::AlreadyExists { .. } | Error::Precondition { .. } => ErrorKind::AlreadyExists,
        Error::PermissionDenied { .. } | Error::Unauthenticated { .. } => {
            ErrorKind::PermissionDenied
        }
        Error::NotSupported { .. } | Error::NotImplemented { .. } => ErrorKind::Unsupported,
        Error::InvalidPath { .. } => ErrorKind::InvalidInput,
        _ => ErrorKind::Other,
    };
    let text = error.to_string();
    let line = without_page(&text).split_whitespace().collect::<Vec<_>>().join(" ");
    io::Error::new(kind, line.chars().take(MAX_CHARACTERS).collect::<String>())
}

/// Of a page that the store sent along, its code.
fn without_page(text: &str) -> String {
    let Some((before, page)) = text.split_once('<') else { return text.to_owned() };
    let code = page.split_once("<Code>").and_then(|(_, rest)| rest.split_once("</Code>"));
    format!("{before}{}", code.map_or("", |(code, _)| code))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_a_line_and_a_page_its_code() {
        let told =
            "404 Not Found: <?xml version='1'?>\n<Error><Code>NoSuchBucket</Code><x/>\n</Error>";
        let error = Error::Generic { store: "S3", source: told.into() };
        let error = io_error(error).to_string();
        assert!(error.ends_with("404 Not Found: NoSuchBucket") && !error.contains('\n'), "{error}");
    }
}
