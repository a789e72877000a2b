//! File names that change when the content does, so that a browser may keep a file for ever and
//! never shows half of an old version.

use std::fmt::Write as _;

use sha2::{Digest, Sha256};

/// 48 bits: a clash among the few files of two versions is out of the question.
const HASH_BYTES: usize = 6;

/// `page.wasm` with this content is `page-1a2b3c4d5e6f.wasm`.
pub fn fresh_name(stem: &str, extension: &str, content: &[u8]) -> String {
    format!("{stem}-{}.{extension}", short_hash([content]))
}

/// The name's changing part, for content in several pieces.
pub fn short_hash<'a>(pieces: impl IntoIterator<Item = &'a [u8]>) -> String {
    let mut hasher = Sha256::new();
    for piece in pieces {
        // The length first, so that moving a byte from one piece to the next changes the hash.
        hasher.update(piece.len().to_le_bytes());
        hasher.update(piece);
    }
    let mut hex = String::new();
    for byte in hasher.finalize().iter().take(HASH_BYTES) {
        // Writing to a String cannot fail.
        let _ = write!(hex, "{byte:02x}");
    }
    hex
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_stem_hash_and_extension() {
        let name = fresh_name("page", "wasm", b"content");
        let hash = name
            .strip_prefix("page-")
            .and_then(|rest| rest.strip_suffix(".wasm"))
            .unwrap();
        assert_eq!(hash.len(), 12);
        assert!(hash.chars().all(|c| c.is_ascii_hexdigit()));
    }

    #[test]
    fn the_same_content_has_the_same_name_and_other_content_another() {
        assert_eq!(fresh_name("a", "js", b"1"), fresh_name("a", "js", b"1"));
        assert_ne!(fresh_name("a", "js", b"1"), fresh_name("a", "js", b"2"));
        let split = |a: &'static [u8], b: &'static [u8]| short_hash([a, b]);
        assert_ne!(split(b"ab", b"c"), split(b"a", b"bc"));
    }
}
