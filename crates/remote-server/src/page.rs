//! The files of the page.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
    sync::Arc,
};

use axum::{
    body::Bytes,
    http::{
        HeaderMap, HeaderValue, StatusCode,
        header::{
            ACCEPT_ENCODING, CACHE_CONTROL, CONTENT_ENCODING, CONTENT_SECURITY_POLICY,
            CONTENT_TYPE, X_CONTENT_TYPE_OPTIONS,
        },
    },
    response::{IntoResponse, Response},
};

use crate::{
    fleet::{FLEET, Fleet},
    sessions::SESSIONS,
};

/// The page that was there when this program was built.
#[cfg(not(debug_assertions))]
#[derive(rust_embed::RustEmbed)]
#[folder = "../../dist"]
#[allow_missing = true]
struct Built;

/// A debug build reads the folder at its start: the tests compile while the page is built.
const fn debug_folder() -> Option<&'static str> {
    if cfg!(debug_assertions) {
        Some(concat!(env!("CARGO_MANIFEST_DIR"), "/../../dist"))
    } else {
        None
    }
}

/// The one of the page would keep the page for visits without the server, and the link with the token would not reach the
/// server. This one removes what an earlier visit has left.
const SERVICE_WORKER: &str = "sw.js";
const NO_SERVICE_WORKER: &str = "addEventListener('activate', () => registration.unregister());\n";

/// The page, which connects to the server that it comes from.
#[derive(Clone, Debug)]
pub struct Site {
    /// The files of a folder, read once; `None` for those in this program.
    files: Option<Arc<BTreeMap<String, Bytes>>>,
    /// The first file, changed but for what depends on the request.
    index: Arc<str>,
    /// The same, as it was built: for motors on the computer of the browser.
    local_index: Bytes,
    /// The name of the program that connects. It has a hash of its content, so it is also the version.
    version: Arc<str>,
    /// The folder of the sessions that the server writes.
    sessions: Option<Arc<Path>>,
    /// The robots that the server shows.
    fleet: Option<Fleet>,
}

impl Site {
    /// The page of this folder, or the one that this program was built with.
    ///
    /// # Errors
    /// There is no page, or it is of a version before remote operation.
    pub fn open(folder: Option<PathBuf>) -> io::Result<Self> {
        let folder = folder.or_else(|| debug_folder().map(PathBuf::from));
        let files = folder.map(|folder| files_in(&folder)).transpose()?;
        let files = files.map(Arc::new);
        let index = file(files.as_deref(), "index.html");
        let missing = || {
            io::Error::new(
                io::ErrorKind::NotFound,
                "the page is missing: build it with `cargo xtask build`, or name its folder with --page",
            )
        };
        let index = index.ok_or_else(missing)?;
        let text = String::from_utf8_lossy(&index).into_owned();
        let old = || {
            io::Error::new(
                io::ErrorKind::InvalidData,
                "the page is of a version without remote operation: build it again",
            )
        };
        let (worker, remote) = (
            named(&text, "motorlink-worker").ok_or_else(old)?,
            named(&text, "motorlink-remote").ok_or_else(old)?,
        );
        let version = remote.trim_start_matches("./").into();
        let changed = text.replace(worker, remote);
        Ok(Self {
            index: changed.into(),
            local_index: text.clone().into(),
            version,
            files,
            sessions: None,
            fleet: None,
        })
    }

    /// The same, with the session files of this folder.
    #[must_use]
    pub fn with_sessions(mut self, folder: &Path) -> Self {
        self.sessions = Some(folder.into());
        self
    }

    /// The same, with a page of these robots.
    #[must_use]
    pub fn with_fleet(mut self, fleet: Fleet) -> Self {
        self.fleet = Some(fleet);
        self
    }

    /// The robots, and the name of a file, if the request is for it or, without a name, for their page.
    pub(crate) fn fleet<'a>(&self, path: &'a str) -> Option<(&Fleet, &'a str)> {
        Some((self.fleet.as_ref()?, path.strip_prefix(FLEET)?))
    }

    /// The version of the page.
    pub(crate) fn is_version(&self, version: &str) -> bool {
        *self.version == *version
    }

    /// The folder of the sessions, and the name of one of them, if the request is for it or, without a name, for their list.
    pub(crate) fn session<'a>(&self, path: &'a str) -> Option<(Arc<Path>, &'a str)> {
        Some((self.sessions.clone()?, path.strip_prefix(SESSIONS)?))
    }

    /// The first file. Its root element says what the page shows of the server.
    fn index(&self, is_secure: bool) -> Bytes {
        let shown = [
            (self.sessions.is_some(), "sessions"),
            (self.fleet.is_some(), "fleet"),
            (!is_secure, "plain"),
        ];
        let shown: Vec<_> = shown
            .iter()
            .filter(|(is, _)| *is)
            .map(|(_, what)| *what)
            .collect();
        let root = format!("<html data-remote=\"{}\" ", shown.join(" "));
        self.index.replacen("<html ", &root, 1).into()
    }

    /// Answers a request for a file. `is_secure`: the browser takes the address for a secure context.
    pub(crate) fn answer(
        &self,
        path: &str,
        query: Option<&str>,
        headers: &HeaderMap,
        is_secure: bool,
    ) -> Response {
        let name = path.trim_start_matches('/');
        if matches!(name, "" | "index.html") {
            let index = if query == Some("local") {
                self.local_index.clone()
            } else {
                self.index(is_secure)
            };
            return response(name, index, None);
        }
        let accepted = headers
            .get(ACCEPT_ENCODING)
            .and_then(|value| value.to_str().ok());
        let accepted = accepted.unwrap_or_default();
        for (encoding, ending) in [("br", "br"), ("gzip", "gz")] {
            if name != SERVICE_WORKER
                && accepted.split(',').any(|one| one.trim() == encoding)
                && let Some(content) = self.file(&format!("{name}.{ending}"))
            {
                return response(name, content, Some(encoding));
            }
        }
        match self.file(name) {
            Some(content) => response(name, content, None),
            None => (StatusCode::NOT_FOUND, "no such file\n").into_response(),
        }
    }

    fn file(&self, name: &str) -> Option<Bytes> {
        if name == SERVICE_WORKER {
            return Some(Bytes::from_static(NO_SERVICE_WORKER.as_bytes()));
        }
        file(self.files.as_deref(), name)
    }
}

/// Every file in a folder and its folders, by its path from there.
fn files_in(folder: &Path) -> io::Result<BTreeMap<String, Bytes>> {
    let mut files = BTreeMap::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(current) = open.pop() {
        let Ok(entries) = fs::read_dir(&current) else {
            // The error is that the page is missing.
            continue;
        };
        for entry in entries {
            let path = entry?.path();
            if path.is_dir() {
                open.push(path);
            } else if let Ok(name) = path.strip_prefix(folder) {
                let name = name.to_string_lossy().replace('\\', "/");
                files.insert(name, fs::read(&path)?.into());
            }
        }
    }
    Ok(files)
}

/// The content of a file.
fn file(files: Option<&BTreeMap<String, Bytes>>, name: &str) -> Option<Bytes> {
    match files {
        Some(files) => files.get(name).cloned(),
        None => built(name),
    }
}

#[cfg(not(debug_assertions))]
fn built(name: &str) -> Option<Bytes> {
    Some(match Built::get(name)?.data {
        std::borrow::Cow::Borrowed(content) => Bytes::from_static(content),
        std::borrow::Cow::Owned(content) => content.into(),
    })
}

#[cfg(debug_assertions)]
const fn built(_name: &str) -> Option<Bytes> {
    None
}

/// The content of the `meta` element with this name.
fn named<'a>(index: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = index.split_once(&format!("<meta name=\"{name}\" content=\""))?;
    Some(rest.split_once('"')?.0)
}

fn response(name: &str, content: Bytes, encoding: Option<&'static str>) -> Response {
    let mut response = content.into_response();
    let headers = response.headers_mut();
    let mut set = |name, value| headers.insert(name, HeaderValue::from_static(value));
    set(CONTENT_TYPE, content_type(name));
    set(X_CONTENT_TYPE_OPTIONS, "nosniff");
    // Nobody shows the page inside another one, over whose buttons a person is led to press these.
    set(CONTENT_SECURITY_POLICY, "frame-ancestors 'none'");
    set(
        CACHE_CONTROL,
        if has_hash(name) {
            "max-age=31536000, immutable"
        } else {
            "no-cache"
        },
    );
    if let Some(encoding) = encoding {
        set(CONTENT_ENCODING, encoding);
    }
    response
}

/// Whether the name has a hash of the content, as in `page-0123456789ab.js`.
fn has_hash(name: &str) -> bool {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let hash = stem.rsplit_once('-').map(|(_, hash)| hash);
    hash.is_some_and(|hash| hash.len() == 12 && hash.bytes().all(|byte| byte.is_ascii_hexdigit()))
}

fn content_type(name: &str) -> &'static str {
    match name.rsplit_once('.').map(|(_, ending)| ending) {
        None | Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("json") => "application/json",
        Some("webmanifest") => "application/manifest+json",
        Some(_) => "text/plain; charset=utf-8",
    }
}
