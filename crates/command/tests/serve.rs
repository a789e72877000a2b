//! `motorlink serve` with bad input, and its end. What pages do is in `tests/end-to-end`.

use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    net::{TcpListener, TcpStream},
    path::Path,
    process::{Command, Output, Stdio},
};

use rustix::process::Signal;

use crate::bench::{Said, signal};

/// A folder with a page of two lines.
pub fn page() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let index = "<html lang=\"en\"><meta name=\"motorlink-worker\" content=\"./a.js\">\
                 <meta name=\"motorlink-remote\" content=\"./b.js\">";
    fs::write(folder.path().join("index.html"), index).unwrap();
    folder
}

/// The answer to a request with these further headers.
pub fn get(address: &str, path: &str, headers: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    let request =
        format!("GET {path} HTTP/1.1\r\nHost: {address}\r\n{headers}Connection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}

pub fn serve(page: &Path, flags: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_motorlink"));
    command
        .args(["--virtual", "serve", "--page"])
        .arg(page)
        .args(flags)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn refused(output: Output, says: &str) {
    let said = Said::of(output);
    assert_eq!(said.code, Some(2), "{}", said.err);
    assert_eq!(said.err.lines().count(), 1, "{}", said.err);
    assert!(said.err.contains(says), "{}", said.err);
}

#[test]
fn bad_input_gets_one_line() {
    let page = page();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let used = listener.local_addr().unwrap().to_string();
    let run = |flags: &[&str]| serve(page.path(), flags).output().unwrap();
    refused(run(&["--listen", &used]), "another program listens there");
    refused(run(&["--listen", "rover.local"]), "not an IP address");
    refused(
        run(&["--listen", "192.0.2.1:8017"]),
        "--listen 192.0.2.1:8017",
    );
    let file = page.path().join("token");
    fs::write(&file, "secret").unwrap();
    let file = file.to_str().unwrap();
    refused(
        run(&["--token-file", file]),
        "not a token of 32 hexadecimal digits",
    );
    refused(run(&["--token-file", "/"]), "/: ");
    let missing = serve(&page.path().join("none"), &[]).output().unwrap();
    refused(missing, "the page is missing");
    fs::write(page.path().join("index.html"), "<html lang=\"en\">").unwrap();
    refused(run(&[]), "without remote operation");
}

/// Serves until the line with the address has come, and then until SIGINT. Returns that line.
fn serve_once(page: &Path, flags: &[&str]) -> String {
    let mut child = serve(page, flags).spawn().unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut lines = lines.map_while(Result::ok);
    let link = lines.find(|line| line.starts_with("Open ")).unwrap();
    signal(&child, Signal::INT);
    lines.for_each(drop);
    assert_eq!(child.wait().unwrap().code(), Some(0));
    link
}

fn mode(file: &Path) -> u32 {
    let permissions = fs::metadata(file).unwrap().permissions();
    std::os::unix::fs::PermissionsExt::mode(&permissions) & 0o777
}

/// What is no terminal is a journal, and gets no secret that a file has.
#[test]
fn a_token_file_is_made_once_and_only_its_owner_reads_it() {
    let page = page();
    let file = page.path().join("token");
    let flags = [
        "--listen",
        "127.0.0.1:0",
        "--token-file",
        file.to_str().unwrap(),
    ];
    let link = serve_once(page.path(), &flags);
    let token = fs::read_to_string(&file).unwrap();
    assert_eq!(token.trim().len(), 32);
    assert!(link.contains("?token=TOKEN") && !link.contains(token.trim()));
    serve_once(page.path(), &flags);
    assert_eq!(fs::read_to_string(&file).unwrap(), token);
    assert_eq!(mode(&file), 0o600);
}

#[test]
fn a_certificate_is_made_once_and_only_its_owner_reads_the_key() {
    let page = page();
    let [file, key] = ["certificate.pem", "key.pem"].map(|name| page.path().join(name));
    let flags = [
        "--listen",
        "127.0.0.1:0",
        "--certificate",
        file.to_str().unwrap(),
        "--key",
        key.to_str().unwrap(),
    ];
    let link = serve_once(page.path(), &flags);
    assert!(link.starts_with("Open https://127.0.0.1:"), "{link}");
    let made = fs::read(&file).unwrap();
    assert_eq!(mode(&key), 0o600);
    serve_once(page.path(), &flags);
    assert_eq!(fs::read(&file).unwrap(), made);

    let run = || serve(page.path(), &flags).output().unwrap();
    fs::write(&key, "none").unwrap();
    refused(run(), "key.pem: not a private key");
    fs::remove_file(&file).unwrap();
    refused(run(), "certificate.pem: is missing, although");
    fs::write(&file, "none").unwrap();
    refused(run(), "certificate.pem: not a certificate");
    let without_key = &flags[..4];
    refused(serve(page.path(), without_key).output().unwrap(), "--key");
}

/// The session that the server writes is listed for the page, can be saved while it is written, and reads whole at the end.
#[test]
fn a_log_is_a_session_file_that_the_page_can_save() {
    let (page, folder) = (page(), tempfile::tempdir().unwrap());
    let log = folder.path().join("log");
    let log = log.to_str().unwrap();
    let mut command = serve(page.path(), &["--listen", "127.0.0.1:0", "--log", log]);
    let mut child = command.args(["--model", "ddsm400"]).spawn().unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut lines = lines.map_while(Result::ok);
    let link = lines.find(|line| line.starts_with("Open ")).unwrap();
    let address = link.split('/').nth(2).unwrap();
    let get = |path: &str| get(address, path, "");
    assert!(get("/").contains("data-remote=\"sessions\""));
    let list = get("/sessions");
    let (_, rest) = list.split_once("href=\"").unwrap();
    let path = rest.split('"').next().unwrap();
    assert!(
        path.starts_with("/sessions/motorlink-log-000001-"),
        "{path}"
    );
    assert!(get(path).starts_with("HTTP/1.1 200"));
    assert!(get("/sessions/../token.mcap").starts_with("HTTP/1.1 404"));
    assert!(get("/sessions/none.mcap").starts_with("HTTP/1.1 404"));
    std::thread::sleep(std::time::Duration::from_millis(500));
    signal(&child, Signal::INT);
    lines.for_each(drop);
    assert_eq!(child.wait().unwrap().code(), Some(0));
    let name = path.rsplit('/').next().unwrap();
    let info = Command::new(env!("CARGO_BIN_EXE_motorlink"))
        .args(["session", "info"])
        .arg(Path::new(log).join(name))
        .output()
        .unwrap();
    let info = Said::of(info);
    assert_eq!(info.code, Some(0), "{}", info.err);
    assert!(
        info.out.contains("motorlink serve") && !info.out.contains(" 0 received"),
        "{}",
        info.out
    );
}

/// A limit of the system stands for a full disk.
#[test]
fn a_full_disk_is_said_in_one_line_and_stops_nothing() {
    let (page, folder) = (page(), tempfile::tempdir().unwrap());
    let script = r#"trap '' XFSZ; ulimit -f 0; exec "$0" "$@""#;
    let mut child = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_motorlink")])
        .args(["--virtual", "serve", "--listen", "127.0.0.1:0", "--page"])
        .arg(page.path())
        .arg("--log")
        .arg(folder.path())
        .env("XDG_STATE_HOME", folder.path())
        .stdin(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut lines = lines.map_while(Result::ok);
    lines.find(|line| line.starts_with("Open ")).unwrap();
    signal(&child, Signal::INT);
    let said: Vec<String> = lines.filter(|line| line.contains("--log")).collect();
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].starts_with("--log has ended: ") && said[0].contains("mcap"));
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

/// As systemd starts it: it hears when the server answers, that it lives, and when it ends.
#[test]
#[cfg(target_os = "linux")]
fn a_service_says_that_it_is_ready_and_lives() {
    let (page, folder) = (page(), tempfile::tempdir().unwrap());
    let socket = folder.path().join("notify");
    let heard = std::os::unix::net::UnixDatagram::bind(&socket).unwrap();
    heard
        .set_read_timeout(Some(std::time::Duration::from_secs(10)))
        .unwrap();
    let hear = || {
        let mut text = [0; 64];
        let length = heard.recv(&mut text).unwrap();
        String::from_utf8_lossy(&text[..length]).trim().to_owned()
    };
    let mut child = serve(page.path(), &["--listen", "127.0.0.1:0"])
        .env("NOTIFY_SOCKET", &socket)
        .env("WATCHDOG_USEC", "300000")
        .spawn()
        .unwrap();
    assert_eq!(hear(), "READY=1");
    assert_eq!([hear(), hear()], ["WATCHDOG=1", "WATCHDOG=1"]);
    signal(&child, Signal::TERM);
    let mut said = hear();
    while said == "WATCHDOG=1" {
        said = hear();
    }
    assert_eq!(said, "STOPPING=1");
    assert_eq!(child.wait().unwrap().code(), Some(0));
}
