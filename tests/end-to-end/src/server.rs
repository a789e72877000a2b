//! A static server for the page under test, on a free port of this machine.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use anyhow::{Context, Result};

/// A browser asks at once or not at all.
const SILENCE_MAX: Duration = Duration::from_secs(10);

/// Serves one directory until dropped.
///
/// Each connection has a thread of its own and ends with its answer. A server with a pool of threads that
/// connections keep has the last of a burst wait until the browser gives another one up, and the browser
/// waits for the answer.
pub struct Server {
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
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
        let listener = TcpListener::bind("127.0.0.1:0").context("no port to serve on")?;
        let address = listener.local_addr()?;
        let ended = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ended);
        let thread = thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                if end.load(Ordering::SeqCst) {
                    return;
                }
                let dir = dir.clone();
                // A browser that went away in the middle of an answer is no fault of ours.
                thread::spawn(move || answer(&dir, stream));
            }
        });
        Ok(Self {
            ended,
            thread: Some(thread),
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
        self.ended.store(true, Ordering::SeqCst);
        // It waits for the next connection: this is the one.
        let woken = TcpStream::connect(self.address).is_ok();
        if let Some(thread) = self.thread.take().filter(|_| woken) {
            // A panic in there has been printed already, and there is nobody to pass it on to.
            let _ = thread.join();
        }
    }
}

fn answer(dir: &Path, mut stream: TcpStream) -> std::io::Result<()> {
    stream.set_read_timeout(Some(SILENCE_MAX))?;
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let first = lines.next().transpose()?.unwrap_or_default();
    // To the end of the head: a connection that is closed with something unread loses its answer.
    while lines
        .next()
        .transpose()?
        .is_some_and(|line| !line.is_empty())
    {}
    let mut words = first.split(' ');
    let method = words.next().unwrap_or_default();
    let file = words.next().and_then(|url| resolve(dir, url));
    let file = file.filter(|_| matches!(method, "GET" | "HEAD"));
    let content = file.and_then(|path| Some((mime(&path), fs::read(path).ok()?)));
    let (status, mime, content) = match content {
        Some((mime, content)) => ("200 OK", mime, content),
        None => ("404 Not Found", "text/plain", b"not found".to_vec()),
    };
    // Each test has its own port and profile, so a cache could only ever be wrong.
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {mime}\r\nContent-Length: {}\r\n\
         Cache-Control: no-store\r\nConnection: close\r\n\r\n",
        content.len()
    );
    stream.write_all(head.as_bytes())?;
    if method != "HEAD" {
        stream.write_all(&content)?;
    }
    Ok(())
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
