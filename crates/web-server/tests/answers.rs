//! What the server answers, byte by byte as a browser reads it.
#![cfg(test)]

use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};

use motorlink_web_server::{Delivery, Server, files};
use tempfile::TempDir;

/// A served directory with one page, and a secret beside it.
struct Site {
    dir: TempDir,
    server: Server,
}

impl Site {
    fn new(delivery: Delivery) -> Self {
        let dir = tempfile::tempdir().unwrap();
        let root = dir.path().join("site");
        fs::create_dir_all(root.join("help")).unwrap();
        fs::write(root.join("index.html"), "<p>page").unwrap();
        fs::write(root.join("help/index.html"), "<p>help").unwrap();
        fs::write(dir.path().join("secret"), "secret").unwrap();
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let server = Server::start(listener, files(&root, delivery).unwrap()).unwrap();
        Self { dir, server }
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.dir.path().join("site").join(name), content).unwrap();
    }

    /// The whole answer to one request, such as `GET /`; more headers may follow its address.
    fn ask(&self, request: &str) -> String {
        let (first, headers) = request.split_once('\n').unwrap_or((request, ""));
        let address = self.server.origin().replace("http://", "");
        let mut stream = TcpStream::connect(address).unwrap();
        let head = format!("{first} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n{headers}\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// The content type of a file with this name.
    fn content_type(&self, name: &str) -> String {
        self.write(name, "content");
        let answer = self.ask(&format!("GET /{name}"));
        let line = answer
            .lines()
            .find(|line| line.starts_with("content-type: "));
        line.unwrap().replace("content-type: ", "")
    }
}

#[test]
fn a_page_comes_with_its_type_and_is_asked_for_each_time() {
    let site = Site::new(Delivery::AsAHost);
    for address in ["/", "/?port=virtual", "/index.html", "//index.html"] {
        let answer = site.ask(&format!("GET {address}"));
        assert!(answer.starts_with("HTTP/1.1 200"), "{address}: {answer}");
        assert!(
            answer.contains("content-type: text/html; charset=utf-8"),
            "{answer}"
        );
        assert!(answer.contains("cache-control: no-cache"), "{answer}");
        assert!(
            answer.contains("x-content-type-options: nosniff"),
            "{answer}"
        );
        assert!(answer.ends_with("<p>page"), "{answer}");
    }
    assert!(site.ask("GET /help/").ends_with("<p>help"));
    let head = site.ask("HEAD /");
    assert!(
        head.starts_with("HTTP/1.1 200") && !head.contains("<p>"),
        "{head}"
    );
}

#[test]
fn a_test_gets_files_uncompressed_and_the_browser_keeps_none() {
    let site = Site::new(Delivery::Uncached);
    site.write("index.html", "<p>page".repeat(100));
    let answer = site.ask("GET /\nAccept-Encoding: gzip\r\n");
    assert!(answer.contains("cache-control: no-store"), "{answer}");
    assert!(answer.contains("<p>page<p>page"), "{answer}");
}

#[test]
fn a_file_is_compressed_for_a_browser_that_accepts_it() {
    let site = Site::new(Delivery::AsAHost);
    site.write("index.html", "<p>page".repeat(100));
    let answer = site.ask("GET /\nAccept-Encoding: br, gzip\r\n");
    assert!(answer.contains("content-encoding: gzip"), "{answer}");
    assert!(!answer.contains("<p>page<p>page"), "{answer}");
    let answer = site.ask("GET /");
    assert!(!answer.contains("gzip"), "{answer}");
    assert!(answer.contains("<p>page<p>page"), "{answer}");
    site.write("a.webp", [7; 1000]);
    let picture = site.ask("GET /a.webp\nAccept-Encoding: gzip\r\n");
    assert!(!picture.contains("gzip"), "{picture}");
}

#[test]
fn types_are_those_that_a_browser_insists_on() {
    let site = Site::new(Delivery::AsAHost);
    for (name, expected) in [
        ("a.wasm", "application/wasm"),
        ("a-1.js", "text/javascript; charset=utf-8"),
        ("a.css", "text/css; charset=utf-8"),
        ("a.txt", "text/plain; charset=utf-8"),
        ("a.svg", "image/svg+xml"),
        ("a.png", "image/png"),
        ("a.webp", "image/webp"),
        ("a.webmanifest", "application/manifest+json"),
        ("a.json", "application/json"),
        ("LICENSE", "application/octet-stream"),
        ("a%20b.svg", "image/svg+xml"),
    ] {
        site.write("a b.svg", "<svg/>");
        assert_eq!(site.content_type(name), expected, "{name}");
    }
}

#[test]
fn nothing_outside_is_found() {
    let site = Site::new(Delivery::AsAHost);
    for address in [
        "/../secret",
        "/help/../../secret",
        "/%2e%2e/secret",
        "/..%2fsecret",
        "/..%5csecret",
        "/%2fetc/passwd",
        "/index.html%00.js",
        "/%ff",
        "/missing.js",
    ] {
        let answer = site.ask(&format!("GET {address}"));
        assert!(answer.starts_with("HTTP/1.1 404"), "{address}: {answer}");
        assert!(answer.ends_with("no such file"), "{address}: {answer}");
    }
}

#[test]
#[cfg(unix)]
fn a_link_does_not_lead_out() {
    let site = Site::new(Delivery::AsAHost);
    let root = site.dir.path().join("site");
    std::os::unix::fs::symlink("../secret", root.join("link")).unwrap();
    std::os::unix::fs::symlink("index.html", root.join("inside.html")).unwrap();
    assert!(site.ask("GET /link").starts_with("HTTP/1.1 404"));
    assert!(site.ask("GET /%6cink").starts_with("HTTP/1.1 404"));
    assert!(site.ask("GET /inside.html").ends_with("<p>page"));
}

#[test]
fn only_get_and_head_are_answered() {
    let answer = Site::new(Delivery::AsAHost).ask("POST /");
    assert!(answer.starts_with("HTTP/1.1 405"), "{answer}");
}

#[test]
fn a_directory_that_does_not_exist_is_an_error() {
    let dir = tempfile::tempdir().unwrap();
    let error = files(&dir.path().join("missing"), Delivery::AsAHost).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::NotFound);
}

#[test]
fn a_dropped_server_closes_its_port_and_its_connections() {
    let Site { dir: _dir, server } = Site::new(Delivery::Uncached);
    let address = server.origin().replace("http://", "");
    let mut open = TcpStream::connect(&address).unwrap();
    open.write_all(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n")
        .unwrap();
    let mut start = [0; 12];
    open.read_exact(&mut start).unwrap();
    assert_eq!(&start, b"HTTP/1.1 200");
    drop(server);
    let mut rest = Vec::new();
    // An end or a reset: whichever, it does not stay open.
    let _ = open.read_to_end(&mut rest);
    let error = TcpStream::connect(&address).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::ConnectionRefused);
}
