//! The page of a fleet: what `motorlink-fleet` tells of all robots. Nothing leads from it to a motor.

use std::{
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use axum::{
    body::Bytes,
    http::StatusCode,
    response::{IntoResponse, Response},
};

use crate::headers::set_headers;

/// The path of the page. Below it are its files and the state of the robots.
pub(crate) const FLEET: &str = "/fleet";

/// `motorlink-fleet` tells a state once a second. An older one says nothing of now.
const STATE_MAX: Duration = Duration::from_secs(3);
/// The page loads nothing from elsewhere, and nobody shows it inside another one.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; base-uri 'none'; \
                      form-action 'none'; frame-ancestors 'none'";

/// The newest state of all robots.
#[derive(Clone, Debug, Default)]
pub struct Fleet(Arc<Mutex<Option<(Instant, Bytes)>>>);

impl Fleet {
    /// Takes a line of `motorlink-fleet --json`.
    pub fn tell(&self, line: Vec<u8>) {
        let newest = Some((Instant::now(), line.into()));
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = newest;
    }

    fn newest(&self) -> Option<Bytes> {
        let newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (_, state) = newest.as_ref().filter(|(at, _)| at.elapsed() < STATE_MAX)?;
        Some(state.clone())
    }
}

/// Answers a request below [`FLEET`]. `name` is what follows in the path.
pub(crate) fn answer(fleet: &Fleet, name: &str) -> Response {
    let file = |kind, content: &'static str| (kind, Bytes::from_static(content.as_bytes()));
    let (kind, content) = match name {
        "" | "/" => file("text/html; charset=utf-8", include_str!("page.html")),
        "/page.css" => file("text/css; charset=utf-8", include_str!("page.css")),
        "/page.js" => file("text/javascript; charset=utf-8", include_str!("page.js")),
        "/words.json" => file("application/json", include_str!("words.json")),
        "/state" => match fleet.newest() {
            Some(state) => ("application/json", state),
            None => return (StatusCode::SERVICE_UNAVAILABLE, "no state\n").into_response(),
        },
        _ => return (StatusCode::NOT_FOUND, "no such file\n").into_response(),
    };
    let mut response = content.into_response();
    set_headers(&mut response, kind, POLICY);
    response
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn a_state_is_told_while_it_is_new() {
        let fleet = Fleet::default();
        let status = || answer(&fleet, "/state").status();
        assert_eq!(status(), StatusCode::SERVICE_UNAVAILABLE);
        fleet.tell(b"{}".to_vec());
        assert_eq!(status(), StatusCode::OK);
        let old = Instant::now().checked_sub(STATE_MAX).unwrap();
        *fleet.0.lock().unwrap() = Some((old, Bytes::new()));
        assert_eq!(status(), StatusCode::SERVICE_UNAVAILABLE);
    }

    /// The words of each language, and those that the page asks for.
    #[test]
    fn every_language_has_every_word() {
        type Words = BTreeMap<String, BTreeMap<String, String>>;
        let words: nojson::Json<Words> = include_str!("words.json").parse().unwrap();
        let words = words.0;
        let keys = |language: &str| words[language].keys().cloned().collect::<Vec<_>>();
        assert_eq!(words.keys().collect::<Vec<_>>(), ["de", "en", "zh"]);
        for language in ["de", "zh"] {
            assert_eq!(keys(language), keys("en"), "{language}");
        }
        assert!(
            words
                .values()
                .flat_map(BTreeMap::values)
                .all(|word| !word.is_empty())
        );
        let (html, script) = (include_str!("page.html"), include_str!("page.js"));
        let until_quote = |text: &'static str| text.split('"').next().unwrap_or_default();
        let asked = html.split("data-word=\"").skip(1);
        let asked: Vec<_> = asked
            .chain(script.split("word(\"").skip(1))
            .map(until_quote)
            .collect();
        assert!(asked.len() > 20, "{asked:?}");
        // Those that stand in a state: `crates/ros` has a test of them.
        let of_state = [
            "no_access",
            "no_program",
            "no_server",
            "nobody",
            "page",
            "client",
            "ros",
        ];
        for word in asked.iter().chain(&of_state) {
            assert!(words["en"].contains_key(*word), "{word}");
        }
    }
}
