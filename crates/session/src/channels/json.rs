//! JSON helpers for all channels.

use std::fmt::Write;

use nojson::RawJsonValue;

/// Adds a quoted and escaped text.
pub(crate) fn push_text(out: &mut String, text: &str) {
    // Writing to a string cannot fail.
    let _ = write!(out, "{}", nojson::Json(text));
}

/// The number in a member of an object; `None` if it is missing or does not fit.
pub(crate) fn integer<T: std::str::FromStr>(object: RawJsonValue<'_, '_>, name: &str) -> Option<T> {
    let member = object.to_member(name).ok()?.optional()?;
    member.as_integer_str().ok()?.parse().ok()
}
