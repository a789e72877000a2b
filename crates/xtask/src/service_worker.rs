//! Generates the service worker, which caches the page, with the list of files to cache.

use std::path::Path;

use anyhow::Result;
use serde_json::{Value, json};

use crate::content_hash::{integrity, is_hashed, short_hash};
use crate::minify;
use crate::site_file::{Profile, SiteFile};
use crate::template::fill;

/// In the top directory, so that its scope is the whole site; the name stays, so that a browser finds the
/// next version.
pub const NAME: &str = "sw.js";

const CACHING: &str = include_str!("../../../boot/service_worker.js");
const REMOVING: &str = include_str!("../../../boot/no_service_worker.js");
const INSTALLED: &str = include_str!("../../../boot/installed.js");

/// The page's part of the installation.
pub fn page_part(profile: Profile) -> Result<String> {
    let kept = match profile {
        Profile::Release => "yes",
        Profile::Dev => "no",
    };
    fill(
        &minify::script(INSTALLED),
        &[("service_worker", NAME), ("kept", kept)],
    )
}

/// The service worker of a site with these files.
pub fn of(files: &[SiteFile], profile: Profile) -> Result<SiteFile> {
    let text = match profile {
        Profile::Release => caching_script(files)?,
        Profile::Dev => minify::script(REMOVING),
    };
    Ok(SiteFile {
        path: NAME.into(),
        content: text.into_bytes(),
    })
}

fn caching_script(files: &[SiteFile]) -> Result<String> {
    let mut hashed = Vec::new();
    let mut named = Vec::new();
    for file in files.iter().filter(|file| is_cached(&file.path)) {
        let path = address(&file.path);
        if is_hashed(&file.path) {
            hashed.push(Value::from(path));
        } else {
            named.push(json!([path, integrity(&file.content)]));
        }
    }
    let (hashed, named) = (Value::from(hashed), Value::from(named));
    let lists = [hashed.to_string(), named.to_string()];
    let version = short_hash(lists.iter().map(String::as_bytes));
    let [hashed, named] = &lists;
    fill(
        &minify::script(CACHING),
        &[("hashed", hashed), ("named", named), ("version", &version)],
    )
}

/// Whether the page needs the file. Pictures of the installation dialog and hidden files for the host are
/// not needed, nor is what connects to a server: without the server there is nothing to connect to.
fn is_cached(path: &Path) -> bool {
    let hidden = |part: &std::ffi::OsStr| part.to_string_lossy().starts_with('.');
    let is_remote = path.to_string_lossy().starts_with("remote-");
    !is_for_installing(path) && !is_remote && !path.iter().any(hidden)
}

/// Whether it is a picture that a browser shows in its installation dialog.
pub fn is_for_installing(path: &Path) -> bool {
    path.starts_with("screenshots")
}

/// The address relative to the script. For the page it is the directory: many hosts redirect from
/// `index.html`, and a browser does not accept a redirected response as a page.
fn address(path: &Path) -> String {
    if path == Path::new("index.html") {
        return "./".to_owned();
    }
    let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site(page: &str) -> Vec<SiteFile> {
        [
            ("index.html", page),
            ("page-0123456789ab.wasm", "wasm"),
            ("page-snippets-0123456789ab/lib/inline0.js", "snippet"),
            ("icon.svg", "<svg/>"),
            ("screenshots/wide.webp", "picture"),
            (".nojekyll", ""),
        ]
        .map(|(path, content)| SiteFile {
            path: path.into(),
            content: content.into(),
        })
        .to_vec()
    }

    fn text(files: &[SiteFile], profile: Profile) -> String {
        let script = of(files, profile).unwrap();
        assert_eq!(script.path, Path::new("sw.js"));
        String::from_utf8(script.content).unwrap()
    }

    #[test]
    fn every_file_that_the_page_needs_is_cached() {
        let script = text(&site("<p>"), Profile::Release);
        assert!(
            script.contains(
                r#"["page-0123456789ab.wasm","page-snippets-0123456789ab/lib/inline0.js"]"#
            )
        );
        assert!(script.contains(r#"["./","sha256-"#), "{script}");
        assert!(script.contains(r#"["icon.svg","sha256-"#), "{script}");
        for left_out in ["wide.webp", "nojekyll", "index.html\",\"sha", "{{"] {
            assert!(!script.contains(left_out), "{left_out} in {script}");
        }
    }

    #[test]
    fn another_page_is_another_version() {
        let version = |page| text(&site(page), Profile::Release);
        assert_eq!(version("<p>"), version("<p>"));
        assert_ne!(version("<p>"), version("<b>"));
    }

    #[test]
    fn a_development_build_caches_nothing() {
        let script = text(&site("<p>"), Profile::Dev);
        assert!(script.contains("unregister") && !script.contains("cache.add("));
        assert!(
            page_part(Profile::Dev)
                .unwrap()
                .contains(r#""no" === "yes""#)
        );
        assert!(page_part(Profile::Release).unwrap().contains("./sw.js"));
    }
}
