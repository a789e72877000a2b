//! Parts of JSON that every channel writes and reads.

use std::fmt::Write;

use nojson::RawJsonValue;

/// Adds a text with its quotes.
pub(crate) fn push_text(out: &mut String, text: &str) {
    // Writing into a text does not fail.
    let _ = write!(out, "{}", nojson::Json(text));
}

/// The number in a member of an object; `None` where there is none that fits.
pub(crate) fn integer<T: std::str::FromStr>(object: RawJsonValue<'_, '_>, name: &str) -> Option<T> {
    let member = object.to_member(name).ok()?.optional()?;
    member.as_integer_str().ok()?.parse().ok()
}
