//! Files as a host sends them: packed with gzip, each once, so that a page that is measured here is as quick
//! as there.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use crate::size;

/// Packed files.
#[derive(Debug, Default)]
pub struct Packer(Mutex<HashMap<PathBuf, Packed>>);

#[derive(Debug)]
struct Packed {
    /// What it was made of: that changes with every build.
    of: Vec<u8>,
    packed: Vec<u8>,
}

impl Packer {
    /// The content packed; none where that gains nothing, as with pictures.
    pub fn pack(&self, path: &Path, content: &[u8]) -> Option<Vec<u8>> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        if matches!(extension, Some("png" | "webp")) {
            return None;
        }
        let mut files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match files.get(path) {
            Some(Packed { of, packed }) if of == content => return Some(packed.clone()),
            _ => {}
        }
        let packed = size::gzip(content).ok()?;
        let of = content.to_vec();
        let kept = packed.clone();
        files.insert(path.to_path_buf(), Packed { of, packed: kept });
        Some(packed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_changed_is_packed_anew() {
        let packer = Packer::default();
        let path = Path::new("page.js");
        let first = packer.pack(path, b"first").unwrap();
        assert_eq!(packer.pack(path, b"first"), Some(first.clone()));
        assert_ne!(packer.pack(path, b"second"), Some(first));
        assert_eq!(packer.pack(Path::new("a.png"), b"png"), None);
    }
}
