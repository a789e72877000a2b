//! A static server for this machine only.

use std::fs;
use std::io::{ErrorKind, Read};
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;

use anyhow::{Context, Result, anyhow};
use tiny_http::{Header, Method, Request, Response, Server};

use crate::failure::BadInput;
use crate::packed::Packer;
use crate::site_path::{content_type, file_for};

/// Permissions for serial ports belong to an origin, port number included, so it stays the same
/// from one run to the next.
const PORT_DEFAULT: u16 = 8017;

/// How many ports after the default are tried: as many as one person has checkouts open.
const PORT_TRIES: u16 = 20;

/// A browser opens up to six connections to a host; a stalled one must not hold up the others.
const THREADS: usize = 6;

/// Serves a directory until the process ends.
pub fn serve(dir: &Path, listener: TcpListener, open_browser: bool) -> Result<()> {
    let root = dir.canonicalize().map_err(|_| {
        BadInput(format!(
            "{} does not exist; make it with cargo xtask build",
            dir.display()
        ))
    })?;
    let url = format!("http://{}/", listener.local_addr()?);
    let server = Server::from_listener(listener, None)
        .map_err(|error| anyhow!("cannot serve on {url}: {error}"))?;
    println!("MotorLink is at {url} (Ctrl-C ends it)");
    if open_browser && has_screen() && open::that_detached(&url).is_err() {
        eprintln!("no browser could be opened: open {url} yourself");
    }
    let site = Site::new(root);
    thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| answer_all(&server, &site));
        }
    });
    Ok(())
}

/// Serves a directory on a free port for as long as this process lives; gives its address.
pub fn in_background(dir: &Path) -> Result<String> {
    let listener = listen(Some(0))?;
    let url = format!("http://{}/", listener.local_addr()?);
    let server = Server::from_listener(listener, None)
        .map_err(|error| anyhow!("cannot serve on {url}: {error}"))?;
    let server = Arc::new(server);
    let site = Arc::new(Site::new(dir.canonicalize()?));
    for _ in 0..THREADS {
        let (server, site) = (Arc::clone(&server), Arc::clone(&site));
        thread::spawn(move || answer_all(&server, &site));
    }
    Ok(url)
}

/// The served directory, and its files as they are sent.
struct Site {
    root: PathBuf,
    packer: Packer,
}

impl Site {
    fn new(root: PathBuf) -> Self {
        Self {
            root,
            packer: Packer::default(),
        }
    }
}

fn answer_all(server: &Server, site: &Site) {
    for request in server.incoming_requests() {
        // The browser has hung up: nobody is left to tell.
        let _ = answer(site, request);
    }
}

/// Takes a port: the one given, else the default one or the next that is free.
pub fn listen(port: Option<u16>) -> Result<TcpListener> {
    let bind = |port: u16| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
    if let Some(port) = port {
        return bind(port).with_context(|| format!("cannot serve on port {port}"));
    }
    for port in PORT_DEFAULT..PORT_DEFAULT + PORT_TRIES {
        match bind(port) {
            Err(error) if error.kind() == ErrorKind::AddrInUse => {}
            other => return other.with_context(|| format!("cannot serve on port {port}")),
        }
    }
    Err(anyhow!(
        "ports {PORT_DEFAULT} to {} are all taken: choose one with --port",
        PORT_DEFAULT + PORT_TRIES - 1
    ))
}

/// On Linux a browser started without a display only prints errors.
fn has_screen() -> bool {
    !cfg!(target_os = "linux")
        || std::env::var_os("DISPLAY").is_some()
        || std::env::var_os("WAYLAND_DISPLAY").is_some()
}

fn answer(site: &Site, request: Request) -> std::io::Result<()> {
    if !matches!(request.method(), Method::Get | Method::Head) {
        return request.respond(plain("only GET and HEAD", 405));
    }
    let found = find(&site.root, request.url());
    let found = found.and_then(|path| fs::read(&path).ok().map(|content| (path, content)));
    let Some((path, content)) = found else {
        return request.respond(plain("no such file", 404));
    };
    let packed = takes_gzip(&request).then(|| site.packer.pack(&path, &content));
    let packed = packed.flatten();
    let is_packed = packed.is_some();
    let mut response = Response::from_data(packed.unwrap_or(content));
    for header in headers(content_type(&path)) {
        response.add_header(header);
    }
    if is_packed && let Ok(header) = Header::from_bytes("Content-Encoding", "gzip") {
        response.add_header(header);
    }
    request.respond(response)
}

fn takes_gzip(request: &Request) -> bool {
    let mut headers = request.headers().iter();
    let accepted = headers.find(|header| header.field.equiv("Accept-Encoding"));
    accepted.is_some_and(|header| header.value.as_str().contains("gzip"))
}

/// The file asked for; nothing where it does not exist or lies outside the root.
fn find(root: &Path, url: &str) -> Option<PathBuf> {
    // Links are resolved before the check, so they cannot lead out either.
    let path = root.join(file_for(url)?).canonicalize().ok()?;
    if !path.starts_with(root) || !fs::metadata(&path).ok()?.is_file() {
        return None;
    }
    Some(path)
}

fn plain(text: &str, status: u16) -> Response<impl Read> {
    let mut response = Response::from_string(text).with_status_code(status);
    for header in headers("text/plain; charset=utf-8") {
        response.add_header(header);
    }
    response
}

/// `no-cache` has the browser ask each time: a rebuilt page shows at once.
fn headers(content_type: &str) -> impl Iterator<Item = Header> {
    [
        ("Content-Type", content_type),
        ("Cache-Control", "no-cache"),
        ("X-Content-Type-Options", "nosniff"),
    ]
    .into_iter()
    .filter_map(|(name, value)| Header::from_bytes(name, value).ok())
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::net::TcpStream;

    use super::*;

    /// A served directory with one page, and a secret beside it.
    struct World {
        dir: PathBuf,
    }

    impl World {
        fn new(name: &str) -> Self {
            let dir = std::env::temp_dir().join(format!("xtask-{name}-{}", std::process::id()));
            fs::create_dir_all(dir.join("site")).unwrap();
            fs::write(dir.join("site/index.html"), "<p>page").unwrap();
            fs::write(dir.join("secret"), "secret").unwrap();
            Self { dir }
        }

        fn root(&self) -> PathBuf {
            self.dir.join("site").canonicalize().unwrap()
        }

        /// The whole answer to one raw request.
        fn ask(&self, request: &str) -> String {
            let listener = listen(Some(0)).unwrap();
            let address = listener.local_addr().unwrap();
            let server = Server::from_listener(listener, None).unwrap();
            let mut stream = TcpStream::connect(address).unwrap();
            let head = format!("{request} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
            stream.write_all(head.as_bytes()).unwrap();
            answer(&Site::new(self.root()), server.recv().unwrap()).unwrap();
            let mut bytes = Vec::new();
            stream.read_to_end(&mut bytes).unwrap();
            String::from_utf8_lossy(&bytes).into_owned()
        }
    }

    impl Drop for World {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.dir);
        }
    }

    #[test]
    fn a_page_comes_with_its_type_and_is_asked_for_each_time() {
        let world = World::new("page");
        let text = world.ask("GET /?port=virtual");
        assert!(text.starts_with("HTTP/1.1 200"), "{text}");
        assert!(
            text.contains("Content-Type: text/html; charset=utf-8"),
            "{text}"
        );
        assert!(text.contains("Cache-Control: no-cache"), "{text}");
        assert!(text.ends_with("<p>page"), "{text}");
    }

    #[test]
    fn what_can_be_packed_comes_packed_to_who_can_unpack_it() {
        let world = World::new("packed");
        fs::write(world.dir.join("site/index.html"), "<p>page".repeat(100)).unwrap();
        let text = world.ask("GET / HTTP/1.1\r\nAccept-Encoding: br, gzip\r\nX-Rest:");
        assert!(text.contains("Content-Encoding: gzip"), "{text}");
        assert!(!text.contains("<p>page<p>page"), "{text}");
        let text = world.ask("GET /");
        assert!(
            !text.contains("gzip") && text.contains("<p>page<p>page"),
            "{text}"
        );
    }

    #[test]
    fn what_lies_outside_is_not_found() {
        let world = World::new("outside");
        for url in ["/../secret", "/%2e%2e/secret", "/missing.js", "/."] {
            let text = world.ask(&format!("GET {url}"));
            assert!(text.starts_with("HTTP/1.1 404"), "{url}: {text}");
        }
    }

    #[test]
    fn nothing_is_written() {
        let text = World::new("write").ask("POST /");
        assert!(text.starts_with("HTTP/1.1 405"), "{text}");
    }

    #[test]
    #[cfg(unix)]
    fn a_link_does_not_lead_out() {
        let world = World::new("link");
        std::os::unix::fs::symlink("../secret", world.dir.join("site/link")).unwrap();
        assert!(find(&world.root(), "/link").is_none());
        assert!(find(&world.root(), "/index.html").is_some());
    }

    #[test]
    fn a_taken_port_is_named() {
        let taken = listen(Some(0)).unwrap();
        let port = taken.local_addr().unwrap().port();
        let error = listen(Some(port)).unwrap_err();
        assert!(error.to_string().contains(&port.to_string()));
    }
}
