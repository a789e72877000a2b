//! Compression as the hosts of the site do it.
//!
//! It is in this crate because the code of `brotli` is generic: the crate that uses it has to be optimised.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::GzEncoder;

/// Compresses at the level that servers use by default, not at the best one.
///
/// # Errors
/// None: a `Vec` takes every byte.
pub fn gzip(content: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(content)?;
    encoder.finish()
}

/// Compresses as far as brotli can: the files are compressed once, when they are built.
///
/// # Errors
/// None: a `Vec` takes every byte.
pub fn brotli(content: &[u8]) -> io::Result<Vec<u8>> {
    let mut compressed = Vec::new();
    let params = brotli::enc::BrotliEncoderParams::default();
    brotli::BrotliCompress(&mut &*content, &mut compressed, &params)?;
    Ok(compressed)
}
