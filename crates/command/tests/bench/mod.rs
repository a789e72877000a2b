//! The command at the port of virtual motors.

use std::{
    process::{Child, Command, Output, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, kill_process};
use tempfile::TempDir;

use crate::program::Program;

/// A busy machine is slow.
const PATIENCE: Duration = Duration::from_secs(20);

/// Virtual motors, and the command at their port with a state folder of its own.
pub struct Bench {
    pub motors: Program,
    pub folder: TempDir,
}

impl Bench {
    pub fn new(flags: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("port");
        let place = ["--link", link.to_str().unwrap()];
        Self {
            motors: Program::start(&[&place[..], flags].concat()),
            folder,
        }
    }

    pub fn port(&self) -> String {
        self.file("port")
    }

    pub fn file(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_motorlink"));
        command
            .args(["--port", &self.port()])
            .args(line.split_ascii_whitespace())
            .env("XDG_STATE_HOME", self.folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    /// Runs a command to its end.
    pub fn run(&self, line: &str) -> Said {
        Said::of(self.command(line).output().unwrap())
    }

    /// Starts a drive, and waits until the wheel turns so fast.
    pub fn drive(&mut self, line: &str, rpm: f64) -> Child {
        let child = self.command(line).spawn().unwrap();
        self.until(|rpm_now| rpm_now.abs() > rpm);
        child
    }

    /// The speed of motor 1, as it is.
    fn rpm(&mut self) -> f64 {
        self.value(1, "rpm=")
    }

    /// The angle of a wheel as it is, in degrees.
    pub fn angle(&mut self, id: u8) -> f64 {
        self.value(id, "angle=")
    }

    fn value(&mut self, id: u8, name: &str) -> f64 {
        let state = self.motors.command(&format!("state {id}"));
        let (_, rest) = state.split_once(name).expect(&state);
        rest.split(' ').next().unwrap().parse().unwrap()
    }

    pub fn until(&mut self, mut is_so: impl FnMut(f64) -> bool) {
        let until = Instant::now() + PATIENCE;
        loop {
            let rpm = self.rpm();
            if is_so(rpm) {
                return;
            }
            assert!(Instant::now() < until, "{rpm} rpm after {PATIENCE:?}");
            sleep(Duration::from_millis(20));
        }
    }

    pub fn stands(&mut self) -> bool {
        self.rpm().abs() < 1.0
    }
}

/// What a command has printed, and its exit code.
#[derive(Debug)]
pub struct Said {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Said {
    pub fn of(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

pub fn signal(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}
