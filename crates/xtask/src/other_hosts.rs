//! Other hosts that a site would fetch files from.
//!
//! Searches markup and style sheets, whose addresses a browser fetches. Scripts and wasm files contain many
//! addresses that are never fetched (name spaces, links to documentation). The bench sees what they really
//! request, and the Content-Security-Policy forbids other hosts.

use std::collections::BTreeSet;

use crate::site_file::SiteFile;

/// Hosts in names of XML name spaces, which are never fetched.
const NAME_SPACES: [&str; 1] = ["www.w3.org"];

/// The other hosts that the site's markup and style sheets name.
pub fn named_in(files: &[SiteFile]) -> BTreeSet<String> {
    files
        .iter()
        .filter(|file| {
            let extension = file.path.extension().and_then(|text| text.to_str());
            matches!(extension, Some("html" | "css" | "svg" | "webmanifest"))
        })
        .flat_map(|file| hosts_in(&String::from_utf8_lossy(&file.content)))
        .filter(|host| !NAME_SPACES.contains(&host.as_str()))
        .collect()
}

/// The host of every address in a text, those without a scheme (`"//host/"`, `(//host/`) included.
fn hosts_in(text: &str) -> Vec<String> {
    let mut hosts = Vec::new();
    let mut before = "";
    for piece in text.split("//") {
        let starts = ["http:", "https:", "\"", "'", "(", "="];
        if starts.iter().any(|start| before.ends_with(start)) {
            let host: String = piece
                .chars()
                .take_while(|c| c.is_ascii_alphanumeric() || ".-:[]".contains(*c))
                .collect();
            if !host.is_empty() {
                hosts.push(host);
            }
        }
        before = piece;
    }
    hosts
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn addresses_are_found_with_and_without_scheme() {
        let html = r#"<link href="https://fonts.example/a"><img src='//cdn.example:8080/b'>
            <script src=//bare.example></script> <!-- a // b --> <p>a//b</p>"#;
        assert_eq!(
            hosts_in(html),
            ["fonts.example", "cdn.example:8080", "bare.example"]
        );
        assert_eq!(hosts_in("@import url(//c.example/x.css)"), ["c.example"]);
        assert!(hosts_in(r#"<a href="./b"><a href="/c">"#).is_empty());
    }

    #[test]
    fn scripts_and_name_spaces_do_not_count() {
        let file = |path: &str, text: &str| SiteFile {
            path: PathBuf::from(path),
            content: text.as_bytes().to_vec(),
        };
        let files = [
            file("a.js", "// see https://docs.example"),
            file("b.svg", r#"<svg xmlns="http://www.w3.org/2000/svg">"#),
            file("c.css", "a { background: url(https://x.example/y.png) }"),
        ];
        assert_eq!(named_in(&files), BTreeSet::from(["x.example".to_owned()]));
    }
}
