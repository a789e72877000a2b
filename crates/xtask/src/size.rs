//! What a first visit costs.

use std::fmt;
use std::io::Write;

use anyhow::Result;
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::service_worker::is_for_installing;
use crate::site::SiteFile;

/// What a first visit may cost at most, so that no change makes it heavier unnoticed: everything that the
/// service worker keeps, the help in three languages too. The original page took 1.8 MB. It is to cost 300,000,
/// which it does not yet: three languages take 46,000 of it, the help 19,000, a session that survives a crash
/// 27,000, and views, which are code for each element, more than half. It was 520,000 before the outside review;
/// what the review asked for (alerts that are withdrawn, a restored graph, more of the bus) takes 16,000.
pub const FIRST_VISIT_GZIP_BYTES_MAX: usize = 537_000;

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
    /// Measures every file that a visit can fetch.
    pub fn new(files: &[SiteFile]) -> Result<Self> {
        let mut rows = Vec::new();
        // A browser fetches those pictures when it asks whether the page is to be installed, and then only.
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

    /// All files that a visit can fetch together, as if the first fetched every one.
    pub fn first_visit_gzip_bytes(&self) -> usize {
        self.rows.iter().map(|row| row.gzip_bytes).sum()
    }
}

/// At the level that servers use by default, not the best there is.
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
