//! `motorlink serve` with bad input, and its end. What pages do is in `tests/end-to-end`.

use std::{
    fs,
    io::{BufRead, BufReader},
    net::TcpListener,
    path::Path,
    process::{Command, Output, Stdio},
};

use rustix::process::Signal;

use crate::bench::{Said, signal};

/// A folder with a page of two lines.
fn page() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let index = "<html lang=\"en\"><meta name=\"motorlink-worker\" content=\"./a.js\">\
                 <meta name=\"motorlink-remote\" content=\"./b.js\">";
    fs::write(folder.path().join("index.html"), index).unwrap();
    folder
}

fn serve(page: &Path, flags: &[&str]) -> Command {
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
    let links = [(); 2].map(|()| {
        let mut child = serve(page.path(), &flags).spawn().unwrap();
        let lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let mut lines = lines.map_while(Result::ok);
        let link = lines.find(|line| line.starts_with("Open ")).unwrap();
        signal(&child, Signal::INT);
        lines.for_each(drop);
        assert_eq!(child.wait().unwrap().code(), Some(0));
        link
    });
    let tokens = links.map(|link| link.split_once("?token=").unwrap().1.to_owned());
    assert_eq!(tokens[0], tokens[1]);
    assert_eq!(fs::read_to_string(&file).unwrap().trim(), tokens[0]);
    let mode = std::os::unix::fs::PermissionsExt::mode(&fs::metadata(&file).unwrap().permissions());
    assert_eq!(mode & 0o777, 0o600);
}
