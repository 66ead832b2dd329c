//! The ids by which rows of the tables name each other.

use std::fmt;

use serde::de::{self, Deserialize, Deserializer, Visitor};

/// A row's id.
///
/// nuScenes writes 32 lower-case hex digits; as a number such a token costs no allocation, which is
/// what lets millions of rows be looked at and left. Any other text is kept as it is.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Token {
    /// 32 lower-case hex digits.
    Hex(u128),
    /// Anything else.
    Text(Box<str>),
}

impl From<&str> for Token {
    fn from(text: &str) -> Self {
        hex(text).map_or_else(|| Self::Text(text.into()), Self::Hex)
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hex(number) => write!(f, "{number:032x}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

impl<'de> Deserialize<'de> for Token {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_str(TokenVisitor)
    }
}

struct TokenVisitor;

impl Visitor<'_> for TokenVisitor {
    type Value = Token;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a token")
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Token, E> {
        Ok(text.into())
    }
}

fn hex(text: &str) -> Option<u128> {
    let digit = |byte: u8| match byte {
        b'0'..=b'9' => Some(byte - b'0'),
        b'a'..=b'f' => Some(byte - b'a' + 10),
        _ => None,
    };
    let mut digits = text.bytes().map(digit);
    let number = digits.try_fold(0_u128, |sum, digit| Some(sum << 4 | u128::from(digit?)))?;
    (text.len() == 32).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_written_as_it_was_read() {
        let hex = "0af3c1d2e4b5968778695a4b3c2d1e0f";
        assert!(matches!(Token::from(hex), Token::Hex(_)));
        let texts = ["", "0", &hex.to_uppercase(), &format!("{hex}0"), "scène", "+1"];
        assert!(texts.iter().all(|text| matches!(Token::from(*text), Token::Text(_))));
        for text in texts.into_iter().chain([hex]) {
            assert_eq!(Token::from(text).to_string(), text);
        }
    }
}
