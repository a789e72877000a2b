//! The download size of a first visit.

use std::fmt;
use std::io::Write;

use anyhow::Result;
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::service_worker::is_for_installing;
use crate::site_file::SiteFile;

/// Largest download of a first visit: everything that the service worker caches, with the help in three
/// languages. A change that exceeds it fails the tests. The original page has 1.8 MB. The goal is 300,000:
/// three languages take 46,000, the help 19,000, the session that survives a crash 27,000, and views, which
/// are code for each element, more than half. It was 520,000 before the outside review, whose requests
/// (alerts that are withdrawn, a restored graph, more of the bus) take 16,000.
pub const FIRST_VISIT_GZIP_BYTES_MAX: usize = 531_000;

/// The files of a site with their sizes.
#[derive(Debug)]
pub struct Report {
    rows: Vec<Row>,
}

#[derive(Debug)]
struct Row {
    name: String,
    raw_bytes: usize,
    gzip_bytes: usize,
}

impl Report {
    /// Measures each file that a visit can fetch.
    pub fn new(files: &[SiteFile]) -> Result<Self> {
        let mut rows = Vec::new();
        // A browser fetches those pictures for its installation dialog only.
        for file in files.iter().filter(|file| !is_for_installing(&file.path)) {
            rows.push(Row {
                name: file.path.display().to_string(),
                raw_bytes: file.content.len(),
                gzip_bytes: gzip(&file.content)?.len(),
            });
        }
        rows.sort_by(|a, b| b.gzip_bytes.cmp(&a.gzip_bytes).then(a.name.cmp(&b.name)));
        Ok(Self { rows })
    }

    /// Sum of all files, as if the first visit fetched each of them.
    pub fn first_visit_gzip_bytes(&self) -> usize {
        self.rows.iter().map(|row| row.gzip_bytes).sum()
    }
}

/// Compresses at the level that servers use by default, not at the best one.
pub fn gzip(content: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(content)?;
    Ok(encoder.finish()?)
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = self.rows.iter().map(|row| row.name.len());
        let width = names.max().unwrap_or(0).max("first visit".len());
        writeln!(f, "{:width$} {:>10} {:>10}", "file", "bytes", "gzip")?;
        for row in &self.rows {
            let Row {
                name,
                raw_bytes,
                gzip_bytes,
            } = row;
            writeln!(f, "{name:width$} {raw_bytes:>10} {gzip_bytes:>10}")?;
        }
        let raw_bytes: usize = self.rows.iter().map(|row| row.raw_bytes).sum();
        let gzip_bytes = self.first_visit_gzip_bytes();
        writeln!(
            f,
            "{:width$} {raw_bytes:>10} {gzip_bytes:>10} (at most {FIRST_VISIT_GZIP_BYTES_MAX})",
            "first visit"
        )
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn the_largest_comes_first_and_all_are_summed() {
        let file = |name: &str, content: &[u8]| SiteFile {
            path: PathBuf::from(name),
            content: content.to_vec(),
        };
        let noise: Vec<u8> = (0..2000_u32)
            .map(|n| n.wrapping_mul(2_654_435_761).to_be_bytes()[0])
            .collect();
        let report =
            Report::new(&[file("zeros.js", &[0; 5000]), file("page.wasm", &noise)]).unwrap();
        let text = report.to_string();
        assert!(text.find("page.wasm") < text.find("zeros.js"), "{text}");
        assert!(text.contains("7000"), "{text}");
        let total = report.first_visit_gzip_bytes();
        assert!((1000..3000).contains(&total), "{total}");
    }
}
