//! `motorlink fleet` and `serve --fleet`, with a script in place of `motorlink-fleet`, which is tested in `crates/ros`.

use std::{
    env, fs,
    io::{BufRead as _, BufReader},
    os::unix::fs::PermissionsExt as _,
    path::Path,
    process::{Child, Command},
    thread::sleep,
    time::{Duration, Instant},
};

use rustix::process::Signal;

use crate::{
    bench::{Said, signal},
    serve::{get, page, serve},
};

/// It tells its process ID and its arguments again and again, and ends with its standard input.
const SCRIPT: &str = r#"#!/usr/bin/env python3
import json, os, sys, threading, time

def end():
    sys.stdin.read()
    os._exit(0)

state = {"robots": [], "process": os.getpid(), "arguments": " ".join(sys.argv[1:])}
print(json.dumps(state), flush=True)
threading.Thread(target=end).start()
while True:
    time.sleep(0.2)
    print(json.dumps(state), flush=True)
"#;

/// A folder with the script, and the path that begins with it.
fn with_script() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("motorlink-fleet");
    fs::write(&script, SCRIPT).unwrap();
    fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", folder.path().display(), env::var("PATH").unwrap());
    (folder, path)
}

/// Waits until there is such a value. A busy machine is slow.
fn until<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> T {
    let began = Instant::now();
    loop {
        if let Some(found) = found() {
            return found;
        }
        assert!(began.elapsed() < Duration::from_secs(20), "{what}");
        sleep(Duration::from_millis(50));
    }
}

/// The process that has told the state, and the rest.
fn process(state: &str) -> Option<(u32, String)> {
    let (_, rest) = state.split_once("\"process\": ")?;
    let (process, rest) = rest.split_once(',')?;
    Some((process.parse().ok()?, rest.to_owned()))
}

fn lives(process: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{process}/stat"));
    stat.is_ok_and(|stat| !stat.contains(") Z "))
}

/// The server and its address.
fn started(page: &Path, path: &str, flags: &[&str]) -> (Child, String) {
    let mut command = serve(page, &["--listen", "127.0.0.1:0"]);
    let mut child = command.args(flags).env("PATH", path).spawn().unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut lines = lines.map_while(Result::ok);
    let link = lines.find(|line| line.contains("/fleet")).unwrap();
    std::thread::spawn(move || lines.for_each(drop));
    let address = link.split('/').nth(2).unwrap();
    (child, address.to_owned())
}

#[test]
fn without_the_program_one_line_says_how_to_get_it() {
    let fleet = Command::new(env!("CARGO_BIN_EXE_motorlink"))
        .args(["fleet", "--json"])
        .env("PATH", "/nowhere")
        .output()
        .unwrap();
    let page = page();
    let serve = serve(page.path(), &["--listen", "127.0.0.1:0", "--fleet"])
        .env("PATH", "/nowhere")
        .output()
        .unwrap();
    for said in [fleet, serve].map(Said::of) {
        assert_eq!(said.code, Some(1), "{}", said.err);
        assert_eq!(said.err.lines().count(), 1, "{}", said.err);
        assert!(
            said.err.contains("cargo install --path crates/ros"),
            "{}",
            said.err
        );
    }
}

#[test]
fn the_arguments_are_those_of_the_program() {
    let (_folder, path) = with_script();
    let fleet = Command::new(env!("CARGO_BIN_EXE_motorlink"))
        .args(["fleet", "sessions", "rover-1", "--help"])
        .env("PATH", path)
        .output()
        .unwrap();
    let said = Said::of(fleet);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.out.contains("sessions rover-1 --help"), "{}", said.out);
}

/// The state is passed on; the program is started again when it ends, and ends with the server, whatever ends that.
#[test]
fn the_server_shows_what_the_program_tells_while_both_live() {
    let (page, (_folder, path)) = (page(), with_script());
    for end in [Signal::INT, Signal::KILL] {
        let (mut server, address) = started(page.path(), &path, &["--fleet=tcp/site:7447"]);
        let state = || process(&get(&address, "/fleet/state", ""));
        let (first, rest) = until("a state", state);
        assert!(
            rest.contains("--json --until-stdin-ends --connect tcp/site:7447"),
            "{rest}"
        );
        let killed = Command::new("kill")
            .args(["-9", &first.to_string()])
            .status();
        assert!(killed.unwrap().success());
        let second = until("another program", || state().filter(|(id, _)| *id != first));
        signal(&server, end);
        server.wait().unwrap();
        until("its end", || (!lives(second.0)).then_some(()));
    }
}

#[test]
fn the_fleet_needs_the_token_and_no_other_path_leads_to_it() {
    let (page, (folder, path)) = (page(), with_script());
    let token = folder.path().join("token");
    let flags = ["--fleet", "--token-file", token.to_str().unwrap()];
    let (mut server, address) = started(page.path(), &path, &flags);
    let token = fs::read_to_string(token).unwrap();
    for file in ["", "/", "/state", "/page.js", "/page.css", "/words.json"] {
        let file = format!("/fleet{file}");
        let answer = get(&address, &file, "");
        assert!(answer.starts_with("HTTP/1.1 401"), "{file}: {answer}");
        let cookie = format!("Cookie: motorlink-token={}\r\n", token.trim());
        let answer = until(&file, || {
            let answer = get(&address, &file, &cookie);
            (!answer.starts_with("HTTP/1.1 503")).then_some(answer)
        });
        assert!(answer.starts_with("HTTP/1.1 200"), "{file}: {answer}");
        assert!(
            answer.contains("frame-ancestors 'none'"),
            "{file}: {answer}"
        );
        let foreign = answer_to_other_host(&address, &file, &cookie);
        assert!(foreign.starts_with("HTTP/1.1 403"), "{file}: {foreign}");
    }
    signal(&server, Signal::INT);
    assert_eq!(server.wait().unwrap().code(), Some(0));
}

/// A page of another site leads the browser here by a name of its own.
fn answer_to_other_host(address: &str, path: &str, headers: &str) -> String {
    use std::io::{Read as _, Write as _};
    let mut stream = std::net::TcpStream::connect(address).unwrap();
    let request =
        format!("GET {path} HTTP/1.1\r\nHost: evil.example\r\n{headers}Connection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}
