//! The setup as text for an address: the JSON file without its blanks, in base64url (RFC 4648, section 5) without padding.

use std::fmt;

use motorlink_i18n::tr;

use crate::model::setup::{SETUP_BYTES_MAX, Setup, SetupError};

/// Characters of the longest link: base64 has four for three bytes.
const CHARACTERS_MAX: usize = SETUP_BYTES_MAX.div_ceil(3) * 4;

/// Why a link has no valid setup.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum LinkError {
    /// Its setup has more than [`SETUP_BYTES_MAX`] bytes.
    TooLong,
    /// It is no base64url of JSON: a part of it is missing, or something was added.
    Damaged,
    /// The setup in it is not valid.
    Setup(SetupError),
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&match self {
            Self::TooLong => {
                let kilobytes = SETUP_BYTES_MAX / 1024;
                tr!(
                    "Link too long: a setup has at most {kilobytes} KB.",
                    kilobytes
                )
            }
            Self::Damaged => {
                tr!("The link is incomplete or damaged. Copy the whole link again.").to_owned()
            }
            Self::Setup(error) => error.to_string(),
        })
    }
}

impl std::error::Error for LinkError {}

/// The setup for a link.
pub(super) fn to_link(setup: &Setup) -> String {
    // The writer puts blanks only at the begin of a line, and JSON has no line break within a text.
    let json: String = setup.to_json().lines().map(str::trim_start).collect();
    encode(json.as_bytes())
}

/// Reads the setup of a link completely, before any of it is applied.
///
/// # Errors
/// [`LinkError`] says what is wrong, and what to do.
pub(super) fn from_link(text: &str) -> Result<Setup, LinkError> {
    if text.len() > CHARACTERS_MAX {
        return Err(LinkError::TooLong);
    }
    let json = decode(text).ok_or(LinkError::Damaged)?;
    Setup::from_json(&json).map_err(|error| match error {
        // A link is no text that a person edits: the place in it says nothing.
        SetupError::NoJson { .. } => LinkError::Damaged,
        SetupError::TooLarge => LinkError::TooLong,
        error @ SetupError::At { .. } => LinkError::Setup(error),
    })
}

fn encode(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |place: usize| u32::from(three.get(place).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        // One byte needs two characters, two need three.
        for place in 0..=three.len() {
            text.push(character(bits >> (18 - 6 * place) & 63));
        }
    }
    text
}

/// `None` if it is no base64url.
fn decode(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for four in text.as_bytes().chunks(4) {
        let mut bits = 0;
        for character in four {
            bits = bits << 6 | value(*character)?;
        }
        // What is not there is zero.
        bits <<= 6 * (4 - four.len());
        let [_, all @ ..] = u32::to_be_bytes(bits);
        let (whole, rest) = all.split_at_checked(four.len().checked_sub(1)?)?;
        if whole.is_empty() || rest.iter().any(|byte| *byte != 0) {
            return None;
        }
        bytes.extend(whole);
    }
    Some(bytes)
}

fn character(value: u32) -> char {
    let ascii = |first: u8, above: u32| {
        let after = u8::try_from(value - above).unwrap_or_default();
        char::from(first + after)
    };
    match value {
        0..26 => ascii(b'A', 0),
        26..52 => ascii(b'a', 26),
        52..62 => ascii(b'0', 52),
        62 => '-',
        _ => '_',
    }
}

fn value(character: u8) -> Option<u32> {
    let value = match character {
        b'A'..=b'Z' => character - b'A',
        b'a'..=b'z' => character - b'a' + 26,
        b'0'..=b'9' => character - b'0' + 52,
        b'-' => 62,
        b'_' => 63,
        _ => return None,
    };
    Some(value.into())
}

// proptest needs a source of randomness, which the browser build lacks.
#[cfg(test)]
#[cfg(not(target_arch = "wasm32"))]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::model::setup::tests::any_setup;

    #[test]
    fn bytes_are_written_as_the_standard_has_them() {
        // RFC 4648, section 10, without the padding; and the two characters that differ in a link.
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg"),
            ("fo", "Zm8"),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg"),
            ("fooba", "Zm9vYmE"),
            ("foobar", "Zm9vYmFy"),
            ("\u{fb}\u{ff}?", "w7vDvz8"),
        ] {
            assert_eq!(encode(bytes.as_bytes()), text);
            assert_eq!(decode(text).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(encode(&[0xFB, 0xFF, 0xFE]), "-__-");
        assert_eq!(decode("-__-"), Some(vec![0xFB, 0xFF, 0xFE]));
        for wrong in [
            "Z", "Zm9vY", "Zg==", "Zm+v", "Zm/v", "Zm 9", "Zh", "\u{e4}AA",
        ] {
            assert_eq!(decode(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn a_link_has_no_blanks_and_says_what_a_file_says() {
        let file = b"{\"motorlink_setup\": 1, \"speed_limit_rpm\": 100,
            \"motors\": [{\"id\": 1, \"name\": \"Front  left\"}, {\"id\": 2}]}";
        let setup = Setup::from_json(file).unwrap();
        let json = String::from_utf8(decode(&to_link(&setup)).unwrap()).unwrap();
        assert_eq!(
            json,
            "{\"motorlink_setup\": 1,\"speed_limit_rpm\": 100,\"motors\": [\
             { \"id\": 1, \"name\": \"Front  left\", \"side\": \"none\", \"drives_together\": false },\
             { \"id\": 2, \"name\": \"\", \"side\": \"none\", \"drives_together\": false }]}"
        );
    }

    #[test]
    fn a_link_that_does_not_fit_says_why() {
        let refused = |json: &str| {
            let error = from_link(&encode(json.as_bytes())).unwrap_err();
            error.to_string()
        };
        assert_eq!(
            refused("{\"motorlink_setup\": 2}"),
            "motorlink_setup: expected 1 (the supported version)."
        );
        assert_eq!(
            refused("{\"motorlink_setup\": 1, \"speed_limit_rpm\": 9999}"),
            "speed_limit_rpm: expected a whole number from 1 to 380."
        );
        let damaged = "The link is incomplete or damaged. Copy the whole link again.";
        assert_eq!(refused(""), damaged);
        assert_eq!(refused("{\"motorlink_setup\": 1"), damaged);
        assert_eq!(refused("no JSON"), damaged);
        let error = |link: &str| from_link(link).unwrap_err();
        assert_eq!(error("<script>"), LinkError::Damaged);
        assert_eq!(error("%7B%7D"), LinkError::Damaged);
        let longest = "A".repeat(CHARACTERS_MAX);
        // As long as 64 KB and the rounding: one of the two bounds refuses it.
        assert_eq!(error(&longest), LinkError::TooLong);
        assert_eq!(error(&(longest + "AAAA")), LinkError::TooLong);
    }

    proptest! {
        #[test]
        fn any_setup_comes_back_from_a_link(setup in any_setup()) {
            prop_assert_eq!(from_link(&to_link(&setup)), Ok(setup));
        }

        #[test]
        fn no_part_of_a_link_is_a_setup(setup in any_setup(), part in 0.0..1.0_f64) {
            let link = to_link(&setup);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
            let length = (link.len() as f64 * part) as usize;
            prop_assert_eq!(from_link(&link[..length]), Err(LinkError::Damaged));
        }

        #[test]
        fn any_bytes_come_back(bytes in prop::collection::vec(any::<u8>(), 0..40)) {
            prop_assert_eq!(decode(&encode(&bytes)), Some(bytes));
        }

        #[test]
        fn no_text_makes_the_reader_panic(text in "\\PC{0,80}|[A-Za-z0-9_-]{0,80}") {
            prop_assert!(from_link(&text).is_err());
        }
    }
}
