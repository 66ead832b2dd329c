//! Numbers as Python writes them.

use serde::{Deserialize, Deserializer};

/// A number of a table. Python writes `NaN` and `Infinity` bare, which is no JSON: they are read as
/// `null`, and `null` as NaN, so that the row can be refused where the number matters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Number(pub(super) f64);

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Option::<f64>::deserialize(deserializer).map(|number| Self(number.unwrap_or(f64::NAN)))
    }
}

/// The plain numbers.
pub(super) fn plain<const N: usize>(numbers: &[Number; N]) -> [f64; N] {
    numbers.map(|number| number.0)
}

/// The record with `null` for each bare `NaN`, `Infinity` and `-Infinity`; `None` if it has none.
pub(super) fn without_bare_words(record: &[u8]) -> Option<Vec<u8>> {
    let mut clean = Vec::with_capacity(record.len() + 8);
    let (mut rest, mut in_string, mut found) = (record, false, false);
    while let Some(&byte) = rest.first() {
        let word = if in_string { None } else { bare_word(rest) };
        let taken = match (word, byte) {
            (Some(word), _) => word.len(),
            (None, b'\\') => rest.len().min(2),
            (None, _) => 1,
        };
        let (text, left) = rest.split_at(taken);
        clean.extend_from_slice(if word.is_some() { b"null" } else { text });
        in_string ^= byte == b'"';
        found |= word.is_some();
        rest = left;
    }
    found.then_some(clean)
}

fn bare_word(text: &[u8]) -> Option<&'static str> {
    ["NaN", "Infinity", "-Infinity"].into_iter().find(|word| text.starts_with(word.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bare_words_become_null_outside_of_strings_only() {
        let clean = |text: &str| {
            without_bare_words(text.as_bytes()).map(|clean| String::from_utf8(clean).unwrap())
        };
        assert_eq!(clean(r#"{"a":[1,null,"x"]}"#), None);
        assert_eq!(clean(r#"{"NaN":"a\"NaN","b":"\\"}"#), None);
        assert_eq!(
            clean(r#"{"a":"\\","b":[NaN,-Infinity, Infinity,1]}"#).as_deref(),
            Some(r#"{"a":"\\","b":[null,null, null,1]}"#)
        );
    }

    #[test]
    fn null_is_read_as_nan() {
        let numbers: [Number; 2] = serde_json::from_str("[null, 3]").unwrap();
        assert!(numbers[0].0.is_nan() && numbers[1].0 == 3.0);
        assert!(serde_json::from_str::<Number>("\"3\"").is_err());
    }
}
