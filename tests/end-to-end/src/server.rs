//! A static server for the page under test, on a free port of this machine.

use std::fs::{self, File};
use std::io::Cursor;
use std::net::SocketAddr;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use anyhow::{Context, Result, anyhow};
use tiny_http::{Header, Method, Request, Response};

/// A browser opens up to six connections to a host, and what it reads late holds up none but itself.
const THREADS: usize = 6;

/// Serves one directory until dropped.
pub struct Server {
    http: Arc<tiny_http::Server>,
    threads: Vec<JoinHandle<()>>,
    address: SocketAddr,
}

impl Server {
    /// Serves `dir` from now on.
    ///
    /// # Errors
    ///
    /// When `dir` has no index.html, or no port is free.
    pub fn start(dir: &Path) -> Result<Self> {
        let dir = dir
            .canonicalize()
            .with_context(|| format!("cannot serve {}", dir.display()))?;
        fs::metadata(dir.join("index.html"))
            .with_context(|| format!("no index.html to serve in {}", dir.display()))?;
        let http = tiny_http::Server::http("127.0.0.1:0").map_err(|error| anyhow!(error))?;
        let address = http
            .server_addr()
            .to_ip()
            .context("the server has no address")?;
        let http = Arc::new(http);
        let threads = (0..THREADS).map(|_| {
            let (serving, dir) = (Arc::clone(&http), dir.clone());
            thread::spawn(move || {
                for request in serving.incoming_requests() {
                    // A browser that went away in the middle of an answer is no fault of ours.
                    let _ = answer(&dir, request);
                }
            })
        });
        let threads = threads.collect();
        Ok(Self {
            http,
            threads,
            address,
        })
    }

    /// The origin of what is served, without a slash at its end.
    pub fn origin(&self) -> String {
        format!("http://{}", self.address)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        for _ in &self.threads {
            self.http.unblock();
        }
        for thread in self.threads.drain(..) {
            // A panic in there has been printed already, and there is nobody to pass it on to.
            let _ = thread.join();
        }
    }
}

fn answer(dir: &Path, request: Request) -> std::io::Result<()> {
    let readable = matches!(request.method(), Method::Get | Method::Head);
    let file = readable.then(|| resolve(dir, request.url())).flatten();
    let Some((path, file)) = file.and_then(|path| File::open(&path).ok().map(|file| (path, file)))
    else {
        return request.respond(Response::new(
            404.into(),
            Vec::new(),
            Cursor::new("not found"),
            None,
            None,
        ));
    };
    // Each test has its own port and profile, so a cache could only ever be wrong.
    let headers = [("Content-Type", mime(&path)), ("Cache-Control", "no-store")];
    let mut response = Response::from_file(file);
    for header in headers
        .iter()
        .flat_map(|(name, value)| Header::from_bytes(*name, *value))
    {
        response.add_header(header);
    }
    request.respond(response)
}

/// The file that a request's URL names; none outside the directory.
fn resolve(dir: &Path, url: &str) -> Option<PathBuf> {
    let path = url.split(['?', '#']).next()?.trim_start_matches('/');
    let relative = Path::new(path);
    if !relative
        .components()
        .all(|part| matches!(part, Component::Normal(_)))
    {
        return None;
    }
    let file = dir.join(relative);
    Some(if file.is_dir() {
        file.join("index.html")
    } else {
        file
    })
}

fn mime(path: &Path) -> &'static str {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("css") => "text/css; charset=utf-8",
        Some("json") => "application/json",
        Some("webmanifest") => "application/manifest+json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("ico") => "image/x-icon",
        Some("woff2") => "font/woff2",
        Some("txt" | "md") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn urls_name_files_of_the_directory_only() {
        let dir = tempfile::tempdir().unwrap();
        let file = |url| resolve(dir.path(), url);
        assert_eq!(file("/"), Some(dir.path().join("index.html")));
        assert_eq!(file("/?port=virtual"), Some(dir.path().join("index.html")));
        assert_eq!(file("/a/b.wasm?v=1"), Some(dir.path().join("a/b.wasm")));
        assert_eq!(file("/../etc/passwd"), None);
        assert_eq!(mime(Path::new("app.wasm")), "application/wasm");
    }
}
