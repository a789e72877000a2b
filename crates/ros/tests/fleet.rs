//! Robots of a fleet, as `motorlink-fleet` shows them.

use std::{
    fs,
    io::{BufRead as _, BufReader, Lines},
    process::{ChildStdout, Command, Stdio},
    time::{Duration, Instant},
};

use serde_json::Value;

use crate::bench::{Asking, Bench, PATIENCE, Program, fleet};

/// `motorlink-fleet --json`.
struct Fleet {
    lines: Lines<BufReader<ChildStdout>>,
    program: Program,
}

impl Fleet {
    fn start(endpoint: &str) -> Self {
        let mut child = fleet(endpoint, &["--json", "--until-stdin-ends"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        Self {
            lines,
            program: Program(child),
        }
    }

    /// Waits for a line of which this is true. Returns how long that took.
    fn until(&mut self, what: &str, mut is_so: impl FnMut(&Value) -> bool) -> Duration {
        let began = Instant::now();
        loop {
            let line = self.lines.next().unwrap().unwrap();
            let line: Value = serde_json::from_str(&line).unwrap();
            if is_so(&line) {
                return began.elapsed();
            }
            assert!(
                began.elapsed() < PATIENCE,
                "not within {PATIENCE:?}: {what}: {line}"
            );
        }
    }
}

fn robot<'a>(line: &'a Value, name: &str) -> Option<&'a Value> {
    let robots = line["robots"].as_array().unwrap();
    robots.iter().find(|robot| robot["name"] == name)
}

fn is_heard(line: &Value, name: &str) -> bool {
    robot(line, name).is_some_and(|robot| robot["heard"] == true)
}

fn printed(command: &mut Command) -> (String, String, Option<i32>) {
    let output = command.stdin(Stdio::null()).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (
        text(output.stdout),
        text(output.stderr),
        output.status.code(),
    )
}

#[test]
fn two_robots_are_seen_and_a_killed_one_is_not_heard() {
    let mut one = Bench::start(&["--robot", "rover-1", "--page", "http://rover.local:8055/"]);
    let mut two = Bench::start_beside(&one, &["--namespace", "rover2"]);
    let mut fleet = Fleet::start(&one.endpoint());
    fleet.until("both robots", |line| {
        is_heard(line, "rover-1") && is_heard(line, "rover2") && line["router"] == true
    });
    let node = one.node();
    let asking = Asking::new(&node);
    one.drive(&asking, (0.4, 0.0), 70.0);
    fleet.until("a robot that drives", |line| {
        let state = &robot(line, "rover-1").unwrap()["state"];
        let rpm = |motor: &Value| motor["rpm"].as_f64().unwrap_or_default();
        state["drive"]["is"] == "drives"
            && state["level"] == "ok"
            && state["control"]["by"] == "ros"
            && state["page"] == "http://rover.local:8055/"
            && state["motors"]
                .as_array()
                .unwrap()
                .iter()
                .all(|motor| rpm(motor) > 60.0)
    });
    two.ros.as_ref().unwrap().signal("KILL");
    let took = fleet.until("a robot that was killed", |line| {
        assert!(is_heard(line, "rover-1"));
        let robot = robot(line, "rover2").unwrap();
        let is_first = line["robots"][0]["name"] == "rover2";
        robot["heard"] == false && robot.get("state").is_none() && is_first
    });
    println!("not heard {} ms after it was killed", took.as_millis());
    assert!(took < Duration::from_secs(2), "{took:?}");
    two.ros = None;
    two.start_ros();
    fleet.until("a robot that was started again", |line| {
        let robots = line["robots"].as_array().unwrap();
        robots
            .iter()
            .any(|robot| robot["name"] == "rover2" && robot["heard"] == true)
    });
    asking.ask(None);
    one.router = None;
    fleet.until("a router that has gone", |line| {
        line["router"] == false && !is_heard(line, "rover-1")
    });
    one.start_router();
    fleet.until("a router that is back", |line| {
        is_heard(line, "rover-1") && line["router"] == true
    });
    drop(fleet.program.0.stdin.take());
    assert!(fleet.program.0.wait().unwrap().success());
}

#[test]
fn a_session_is_listed_and_saved_byte_for_byte() {
    let sessions = tempfile::tempdir().unwrap();
    // Three pieces.
    let bytes: Vec<u8> = (0..2_500_000_u32)
        .flat_map(u32::to_le_bytes)
        .take(2_500_000)
        .collect();
    fs::write(sessions.path().join("run-1.mcap"), &bytes).unwrap();
    fs::write(sessions.path().join("token"), b"secret").unwrap();
    let folder = sessions.path().to_str().unwrap();
    let bench = Bench::start(&["--robot", "rover-1", "--sessions", folder]);
    let run = |arguments: &[&str]| printed(&mut fleet(&bench.endpoint(), arguments));
    let (listed, ..) = run(&["sessions", "rover-1"]);
    assert_eq!(listed.trim(), "2500000  run-1.mcap");
    let to = bench.folder().join("saved.mcap");
    let save = [
        "save",
        "rover-1",
        "run-1.mcap",
        "--to",
        to.to_str().unwrap(),
    ];
    let (saved, problem, code) = run(&save);
    assert!(
        saved.ends_with("2500000 bytes\n") && code == Some(0),
        "{problem}"
    );
    assert!(fs::read(&to).unwrap() == bytes);
    // Nothing is overwritten, and no half file is left.
    let (_, problem, code) = run(&save);
    assert!(problem.contains("exists") && code == Some(2), "{problem}");
    for (wrong, says) in [
        (
            &["save", "rover-1", "token"][..],
            "no name of a session file",
        ),
        (
            &["save", "rover-1", "other.mcap", "--to", "/tmp/no-such.mcap"],
            "has no session",
        ),
        (&["sessions", "rover-9"], "does not answer"),
        (&["sessions", "a b"], "no name of a robot"),
        (&["--json", "--once"], "cannot be used with"),
    ] {
        let (out, problem, code) = run(wrong);
        assert!(
            problem.contains(says) && code == Some(2) && out.is_empty(),
            "{problem}"
        );
    }
    let (table, ..) = run(&[]);
    assert!(
        table.starts_with("1 robots, 0 driving, 0 with problems, 0 not heard\n"),
        "{table}"
    );
    assert!(
        table.contains("rover-1  stopped: nobody asks it to move  nobody"),
        "{table}"
    );
    let (_, problem, code) = printed(&mut fleet("tcp/127.0.0.1:9", &["--once"]));
    assert!(
        problem.contains("no Zenoh router") && code == Some(2),
        "{problem}"
    );
    println!("{problem}");
}
