//! File names that contain a hash of the content: a browser may cache such a file for ever and never mixes
//! two versions.

use std::fmt::Write as _;
use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

/// 48 bits: the site has a few dozen files, so that a collision is practically impossible.
const HASH_BYTES: usize = 6;

/// `page.wasm` with this content is `page-1a2b3c4d5e6f.wasm`.
pub fn hashed_name(stem: &str, extension: &str, content: &[u8]) -> String {
    format!("{stem}-{}.{extension}", short_hash([content]))
}

/// The hash in such a name, of content in several pieces.
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

/// Whether a file or one of its directories has such a name.
pub fn is_hashed(path: &Path) -> bool {
    path.iter().any(|part| {
        let part = part.to_string_lossy();
        let stem = part.split('.').next().unwrap_or_default();
        let hash = stem.rsplit_once('-').map_or("", |(_, hash)| hash);
        hash.len() == 2 * HASH_BYTES && hash.chars().all(|c| c.is_ascii_hexdigit())
    })
}

/// The integrity value of a file without a hash in its name.
pub fn integrity(content: &[u8]) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(content)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashed_names_are_recognised() {
        for name in [
            hashed_name("page", "wasm", b"1"),
            "page-snippets-0123456789ab/lib-1/inline0.js".to_owned(),
        ] {
            assert!(is_hashed(Path::new(&name)), "{name}");
        }
        for name in [
            "icon.svg",
            "icon-maskable.svg",
            "sw.js",
            "a-0123/index.html",
        ] {
            assert!(!is_hashed(Path::new(name)), "{name}");
        }
    }

    #[test]
    fn the_integrity_is_what_a_browser_computes() {
        // The digest of nothing, from FIPS 180-4's test vectors, in base 64.
        let empty = "sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=";
        assert_eq!(integrity(b""), empty);
    }

    #[test]
    fn a_name_has_stem_hash_and_extension() {
        let name = hashed_name("page", "wasm", b"content");
        let hash = name
            .strip_prefix("page-")
            .and_then(|rest| rest.strip_suffix(".wasm"))
            .unwrap();
        assert_eq!(hash.len(), 12);
        assert!(hash.chars().all(|c| c.is_ascii_hexdigit()));
    }

    #[test]
    fn the_same_content_has_the_same_name_and_other_content_another() {
        assert_eq!(hashed_name("a", "js", b"1"), hashed_name("a", "js", b"1"));
        assert_ne!(hashed_name("a", "js", b"1"), hashed_name("a", "js", b"2"));
        let split = |a: &'static [u8], b: &'static [u8]| short_hash([a, b]);
        assert_ne!(split(b"ab", b"c"), split(b"a", b"bc"));
    }
}
