//! The sketch that `motorlink-experiments` generates, run against virtual motors.
//!
//! It drives them, and stops them at its end, on Ctrl-C and on an error. A missing tool fails the test with
//! a line that names it.

use std::{
    fs,
    io::{BufRead, BufReader, Write},
    panic::catch_unwind,
    path::Path,
    process::{Child, ChildStdin, Command, Stdio},
    sync::mpsc::{Receiver, channel},
    thread,
    time::{Duration, Instant},
};

use crate::program::Program;
use motorlink_experiments::{
    generate::{Program as Generated, arduino},
    plan::{Fleet, Plan},
    sequence::{Sequence, Template},
};
use motorlink_protocol::MotorId;
use rustix::process::{Pid, Signal, kill_process, setpriority_process};

/// A busy machine is slow, and a program has its run to do.
const PATIENCE: Duration = Duration::from_secs(60);

/// Two seconds with every kind of instruction.
const SHORT: &str = r#"{ "motorlink_sequence": 1, "name": "Test", "limits": { "rpm": 200, "celsius": 70 },
  "steps": [
    { "rpm": 60, "shape": "ramp", "for_s": 0.4 },
    { "rpm": 60, "until": { "rpm_above": 50 }, "within_s": 5 },
    { "repeat": 2, "steps": [
      { "rpm": 60, "motor": 1, "shape": "sine", "amplitude": 20, "hz": 4, "for_s": 0.25 },
      { "rpm": 60, "motor": 2, "shape": "triangle", "amplitude": 20, "hz": 4, "for_s": 0.25 }] },
    { "rpm": 40, "shape": "chirp", "amplitude": 10, "hz": 1, "to_hz": 5, "for_s": 0.4 },
    { "brake": true, "for_s": 0.1 }] }"#;
const LONG: &str = r#"{ "motorlink_sequence": 1, "steps": [{ "rpm": 60, "for_s": 50 }] }"#;
/// To an angle from which zero is a long way.
const TURN: &str = r#"{ "motorlink_sequence": 1, "steps": [{ "degrees": 211, "for_s": 2 }] }"#;
const PUSH: &str = r#"{ "motorlink_sequence": 1, "steps": [{ "amps": 0.2, "for_s": 0.5 }] }"#;

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

/// A program that runs, its output line by line.
struct Running {
    child: Child,
    stdin: ChildStdin,
    lines: Receiver<String>,
    said: Vec<String>,
}

impl Running {
    fn start(mut command: Command, consent: &str) -> Self {
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        // The browsers and tests beside it must not make it late; the virtual motors are as prompt. Only the superuser may.
        let _ = setpriority_process(Some(Pid::from_child(&child)), -10);
        let (sender, lines) = channel();
        let out = BufReader::new(child.stdout.take().unwrap());
        thread::spawn(move || {
            out.lines().map_while(Result::ok).for_each(|line| {
                let _ = sender.send(line);
            });
        });
        let mut stdin = child.stdin.take().unwrap();
        stdin.write_all(consent.as_bytes()).unwrap();
        Self {
            child,
            stdin,
            lines,
            said: Vec::new(),
        }
    }

    fn until(&mut self, start: &str) {
        let began = Instant::now();
        while !self.said.iter().any(|line| line.starts_with(start)) {
            let left = PATIENCE.saturating_sub(began.elapsed());
            let line = self.lines.recv_timeout(left);
            self.said
                .push(line.unwrap_or_else(|_| panic!("no \"{start}\": {:?}", self.said)));
        }
    }

    /// Waits a moment for its end: a program that has finished may still hold the port.
    fn ends(mut self) {
        for _ in 0..100 {
            if self.child.try_wait().is_ok_and(|ended| ended.is_some()) {
                return;
            }
            thread::sleep(Duration::from_millis(10));
        }
    }

    fn interrupt(&self) {
        kill_process(Pid::from_child(&self.child), Signal::INT).unwrap();
    }
}

/// See `drives_and_stops`.
const ATTEMPTS_MAX: u32 = 3;

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.stdin.flush();
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn figure(motors: &mut Program, id: u8, name: &str) -> String {
    let state = motors.command(&format!("state {id}"));
    let mut words = state.split_whitespace();
    let figure = words.find_map(|word| word.strip_prefix(name));
    figure.expect(&state).to_owned()
}

fn rpm(motors: &mut Program, id: u8) -> f32 {
    figure(motors, id, "rpm=").parse().unwrap()
}

fn assert_stands_at(motors: &mut Program, id: u8, degrees: f32) {
    let angle: f32 = figure(motors, id, "angle=").parse().unwrap();
    assert!(
        (angle - degrees).abs() < 3.0,
        "motor {id} at {angle} degrees"
    );
    assert!(rpm(motors, id).abs() < 1.0);
}

fn until_in_loop(motors: &mut Program, id: u8, mode: &str) {
    let began = Instant::now();
    while figure(motors, id, "mode=") != mode {
        assert!(began.elapsed() < PATIENCE, "never in the {mode} loop");
        thread::sleep(Duration::from_millis(1));
    }
}

/// Starts the program of a sequence.
fn start(dir: &Path, text: &str, motors: &Program, ids: &str) -> Running {
    let mut fleet = Fleet::of(ids.split(',').map(|id| id.parse().unwrap()));
    // One wheel is on the right side.
    fleet.mirrored = vec![id(2)];
    let sequence = Sequence::from_json(text).unwrap();
    let plan = Plan::new(&sequence, &fleet).unwrap();
    fs::create_dir_all(dir).unwrap();
    let port = motors.slave.clone();
    let port_name = port.to_string_lossy().into_owned();
    let generated = Generated {
        plan: &plan,
        sequence: &sequence,
        port: &port_name,
    };
    Running::start(compiled(dir, &generated, &port), "y")
}

/// On a busy machine, replies come too late for a program, which then rightly stops. So it gets another
/// attempt, at most three in all.
fn drives_and_stops() {
    for attempt in 1..ATTEMPTS_MAX {
        let tried = catch_unwind(drive_and_stop);
        if tried.is_ok() {
            return;
        }
        println!("attempt {attempt} of {ATTEMPTS_MAX} failed");
    }
    drive_and_stop();
}

/// A full run, one that is interrupted, one whose motor falls silent, and some in the current loop: with an adapter
/// that sends back what it gets, too.
fn drive_and_stop() {
    let dir = tempfile::tempdir().unwrap();
    let run_on = |name: &str,
                  text: &str,
                  (ids, flags): (&str, &[&str]),
                  act: &dyn Fn(&mut Program, &mut Running)| {
        let mut motors = Program::start(&[&["--ids", ids], flags].concat());
        let mut running = start(&dir.path().join(name), text, &motors, ids);
        running.until("running");
        act(&mut motors, &mut running);
        for id in ids.split(',') {
            let rpm = rpm(&mut motors, id.parse().unwrap());
            assert!(
                rpm.abs() < 1.0,
                "{name}: motor {id} at {rpm} rpm, {:?}",
                running.said
            );
        }
    };
    let run = |name: &str, text: &str, ids: &str, act: &dyn Fn(&mut Program, &mut Running)| {
        run_on(name, text, (ids, &[]), act);
    };
    run("whole", SHORT, "1,2", &|motors, running| {
        let mut fastest = 0.0_f32;
        while !running.said.iter().any(|line| line.starts_with("finished")) {
            fastest = fastest.max(rpm(motors, 1)).max(-rpm(motors, 2));
            if let Ok(line) = running.lines.recv_timeout(Duration::from_millis(20)) {
                assert!(!line.starts_with("aborted"), "{line}");
                running.said.push(line);
            }
        }
        assert!((60.0..110.0).contains(&fastest), "{fastest}");
        assert!(
            running.said.contains(&"motor 2 stands".to_owned()),
            "{:?}",
            running.said
        );
    });
    run("interrupted", LONG, "1,2", &|motors, running| {
        while rpm(motors, 1) < 50.0 || rpm(motors, 2) > -50.0 {
            thread::sleep(Duration::from_millis(20));
        }
        running.interrupt();
        running.until("aborted: stopped by you");
        assert!(
            running.said.contains(&"motor 1 stands".to_owned()),
            "{:?}",
            running.said
        );
    });
    run("silent", LONG, "1,2", &|motors, running| {
        while rpm(motors, 1) < 50.0 {
            thread::sleep(Duration::from_millis(20));
        }
        motors.command("mute 2 on");
        running.until("aborted: ");
        let said = running.said.join("\n");
        // The other is stopped for it, and what could not be confirmed is said.
        assert!(said.contains("motor 1 stands"), "{said}");
        assert!(said.contains("motor 2 DID NOT CONFIRM ITS STOP"), "{said}");
    });
    let pushes: [&[&str]; 3] = [&[], &["--echo", "whole"], &["--echo", "cut:4"]];
    for flags in pushes {
        run_on("current", PUSH, ("1", flags), &|_, running| {
            running.until("finished");
        });
    }
}

/// A stop pressed while the motors are prepared for the position loop does not turn a wheel to 0 degrees.
fn stopped_while_preparing() {
    let dir = tempfile::tempdir().unwrap();
    let mut motors = Program::start(&["--ids", "1,2"]);
    let mut running = start(&dir.path().join("turn"), TURN, &motors, "1,2");
    running.until("finished");
    for id in [1, 2] {
        assert_stands_at(&mut motors, id, 211.0);
        assert!(running.said.contains(&format!("motor {id} stands")));
    }
    running.ends();

    let mut running = start(&dir.path().join("stopped"), TURN, &motors, "1,2");
    for mode in ["position", "velocity", "position"] {
        until_in_loop(&mut motors, 1, mode);
    }
    running.interrupt();
    running.until("aborted: stopped by you");
    let said = running.said.join("\n");
    assert!(!said.contains("running"), "{said}");
    for id in [1, 2] {
        assert!(said.contains(&format!("motor {id} stands")), "{said}");
        assert_stands_at(&mut motors, id, 211.0);
        assert_eq!(figure(&mut motors, id, "mode="), "velocity");
    }
}

/// The sentence that a person reads before the start, and no promise beside it.
fn says_what_a_failure_leaves() {
    let dir = tempfile::tempdir().unwrap();
    let motors = Program::start(&["--ids", "1"]);
    drop(start(dir.path(), LONG, &motors, "1"));
    let source = fs::read_to_string(dir.path().join("sequence.cpp")).unwrap();
    assert!(source.contains(
        "If the cable or the computer fails, the wheel may keep turning. Only the power switch stops it then."
    ));
    assert!(!source.contains("coast"));
}

/// Compiles the sketch for this computer. A person types y to start it.
fn compiled(dir: &Path, generated: &Generated<'_>, port: &Path) -> Command {
    let file = dir.join("sequence.cpp");
    fs::write(&file, arduino(generated)).unwrap();
    let stub = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/generated");
    let program = dir.join("sequence");
    let flags = [
        "-std=c++17",
        "-O1",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-I",
        stub,
        "-o",
    ];
    let mut compiler = Command::new("g++");
    compiler.args(flags).arg(&program).arg(&file);
    crate::tools::run(
        &mut compiler,
        "g++ is missing: install it (Debian: apt-get install g++)",
    );
    let mut command = Command::new(program);
    command.env("PORT", port);
    command
}

#[test]
fn the_arduino_sketch_stopped_while_it_prepares_turns_no_wheel() {
    stopped_while_preparing();
    says_what_a_failure_leaves();
}

#[test]
fn the_arduino_sketch_drives_and_stops() {
    drives_and_stops();
}

#[test]
fn the_published_schema_accepts_every_template_and_refuses_what_the_program_refuses() {
    let dir = tempfile::tempdir().unwrap();
    for (place, template) in Template::ALL.iter().enumerate() {
        let file = dir.path().join(format!("good-{place}.json"));
        fs::write(file, template.sequence().to_json()).unwrap();
    }
    fs::write(dir.path().join("good-short.json"), SHORT).unwrap();
    let bad = [
        SHORT.replace("\"rpm\": 40", "\"rpm\": 400"),
        SHORT.replace("\"repeat\": 2", "\"repeat\": 0"),
        SHORT.replace("\"for_s\": 0.1", "\"for_s\": -1"),
        SHORT.replace("\"brake\": true", "\"rmp\": 1"),
        SHORT.replace("\"motorlink_sequence\": 1", "\"motorlink_sequence\": 2"),
    ];
    for (place, text) in bad.iter().enumerate() {
        let refused = Sequence::from_json(text)
            .and_then(|sequence| Plan::new(&sequence, &Fleet::of([id(1), id(2)])));
        assert!(refused.is_err(), "{text}");
        fs::write(dir.path().join(format!("bad-{place}.json")), text).unwrap();
    }
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(crate::tools::python());
    command.arg(manifest.join("tests/generated/check_schema.py"));
    command
        .arg(manifest.join("../../docs/sequence.schema.json"))
        .arg(dir.path());
    crate::tools::run(&mut command, "python cannot be started");
}
