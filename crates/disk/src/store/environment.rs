//! What the environment says of stores, before the library that reads it stumbles.

use std::ffi::OsString;
use std::io::{self, ErrorKind};

/// Where S3 is, if it is elsewhere.
const ENDPOINTS: [&str; 3] = ["AWS_ENDPOINT", "AWS_ENDPOINT_URL", "AWS_ENDPOINT_URL_S3"];

/// That an endpoint may be one without encryption.
const PLAIN_HTTP: &str = "AWS_ALLOW_HTTP";

/// Refuses variables that cannot be meant.
pub(crate) fn check_variables(
    variables: impl Iterator<Item = (OsString, OsString)>,
) -> io::Result<()> {
    let text = |(name, value): (OsString, OsString)| {
        Some((name.into_string().ok()?, value.into_string().ok()?))
    };
    let of_store = |name: &str| ["AWS_", "AZURE_", "GOOGLE_"].iter().any(|of| name.starts_with(of));
    let variables: Vec<(String, String)> =
        variables.filter_map(text).filter(|(name, _)| of_store(name)).collect();
    let is_plain = variables.iter().any(|(name, value)| name == PLAIN_HTTP && value == "true");
    variables.iter().try_for_each(|(name, value)| check(name, value, is_plain))
}

/// Values may be secret: they are not told.
fn check(name: &str, value: &str, allows_http: bool) -> io::Result<()> {
    let wrong = |what: &str| Err(io::Error::new(ErrorKind::InvalidInput, format!("{name} {what}")));
    if value.chars().any(char::is_control) {
        return wrong("has a line's end or another control character");
    }
    if !ENDPOINTS.contains(&name) {
        return Ok(());
    }
    let host = value.split_once("://").filter(|(scheme, _)| matches!(*scheme, "http" | "https"));
    match host {
        Some((_, host)) if host.trim_matches('/').is_empty() => wrong("is a URL without a host"),
        Some(("http", _)) if !allows_http => wrong("is http://, which needs AWS_ALLOW_HTTP=true"),
        Some(_) => Ok(()),
        None => wrong("is no URL that begins with https:// or http://"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(variables: &[(&str, &str)]) -> Option<String> {
        let owned = variables.iter().map(|(name, value)| (name.into(), value.into()));
        check_variables(owned).err().map(|error| error.to_string())
    }

    #[test]
    fn what_cannot_be_meant_is_told_by_the_name_of_its_variable() {
        for endpoint in ["nonsense", "", "127.0.0.1:9000", "http://", "https:///", "ftp://a"] {
            let told = told(&[("AWS_ENDPOINT_URL", endpoint), ("AWS_ALLOW_HTTP", "true")]);
            assert!(told.unwrap().starts_with("AWS_ENDPOINT_URL is"), "{endpoint}");
        }
        let secret = told(&[("AWS_ACCESS_KEY_ID", "secret\n")]).unwrap();
        assert!(secret.starts_with("AWS_ACCESS_KEY_ID has") && !secret.contains("secret"));
        let plain = told(&[("AWS_ENDPOINT", "http://127.0.0.1:9")]).unwrap();
        assert!(plain.contains("AWS_ALLOW_HTTP=true"), "{plain}");
    }

    #[test]
    fn what_can_be_meant_is_let_through() {
        let http = [("AWS_ALLOW_HTTP", "true"), ("AWS_ENDPOINT_URL", "http://127.0.0.1:9")];
        let https =
            [("AWS_ENDPOINT_URL", "https://host/path"), ("AWS_REGION", ""), ("OTHER", "a\n")];
        assert_eq!((told(&http), told(&https)), (None, None));
    }
}
