//! From a request's address to a file of the site, and the file's type.

use std::path::{Path, PathBuf};

use percent_encoding::percent_decode_str;

/// The file that an address means, relative to the served directory.
///
/// Nothing for an address that could lead out of that directory on any system.
pub fn file_for(url: &str) -> Option<PathBuf> {
    let path = url.split(['?', '#']).next()?;
    let path = percent_decode_str(path).decode_utf8().ok()?;
    let mut file = PathBuf::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => return None,
            // On Windows these make drives, streams and separators.
            part if part.contains(['\\', ':', '\0']) => return None,
            part => file.push(part),
        }
    }
    if path.ends_with('/') {
        file.push("index.html");
    }
    Some(file)
}

/// The Content-Type of a file. A module script or a wasm file with another type is refused by the
/// browser.
pub fn content_type(file: &Path) -> &'static str {
    match file.extension().and_then(|extension| extension.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("webp") => "image/webp",
        Some("webmanifest") => "application/manifest+json",
        Some("json") => "application/json",
        Some("txt") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_name_files() {
        for (url, file) in [
            ("/", "index.html"),
            ("/?port=virtual", "index.html"),
            ("/page-12.js?a=/../b#c", "page-12.js"),
            ("/a%20b.svg", "a b.svg"),
            ("//a//b.css", "a/b.css"),
            ("/sub/", "sub/index.html"),
        ] {
            assert_eq!(file_for(url), Some(PathBuf::from(file)), "{url}");
        }
    }

    #[test]
    fn addresses_that_lead_out_are_refused() {
        for url in [
            "/../secret",
            "/a/../../secret",
            "/%2e%2e/secret",
            "/..%2fsecret",
            "/..%5csecret",
            "/c:/secret",
            "/a%00.js",
            "/%ff",
        ] {
            assert_eq!(file_for(url), None, "{url}");
        }
    }

    #[test]
    fn types_are_those_that_a_browser_insists_on() {
        assert_eq!(content_type(Path::new("a.wasm")), "application/wasm");
        assert!(content_type(Path::new("a-1.js")).starts_with("text/javascript"));
        assert!(content_type(Path::new("a.css")).starts_with("text/css"));
        assert_eq!(
            content_type(Path::new("LICENSE")),
            "application/octet-stream"
        );
    }
}
