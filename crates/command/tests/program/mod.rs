//! The program as a test sees it: a child with a serial port.
#![allow(dead_code, reason = "each test file uses its own part of the program")]

use std::{
    io::{BufRead, BufReader, Write},
    os::fd::OwnedFd,
    path::PathBuf,
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    time::{Duration, Instant},
};

use motorlink_protocol::{Frame, Reply, Request, family};
use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    fs::{Mode, OFlags, open},
    process::{Pid, Signal, kill_process},
    termios::{OptionalActions, tcgetattr, tcsetattr},
};

pub fn command(flags: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_motorlink"));
    command
        .arg("virtual")
        .args(flags)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// The command with these arguments.
pub fn motorlink(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_motorlink"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// A running program; it ends with the test.
pub struct Program {
    pub child: Child,
    pub slave: PathBuf,
    stdin: Option<ChildStdin>,
    stdout: BufReader<ChildStdout>,
}

impl Program {
    pub fn start(flags: &[&str]) -> Self {
        let mut child = command(flags).spawn().unwrap();
        let stdin = child.stdin.take();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        stdout.read_line(&mut line).unwrap();
        let slave = line.strip_prefix("ready ").expect(&line).trim_end();
        Self {
            slave: slave.into(),
            child,
            stdin,
            stdout,
        }
    }

    pub fn port(&self) -> Port {
        Port::open(&self.slave)
    }

    /// Gives a command and returns its answer.
    pub fn command(&mut self, line: &str) -> String {
        writeln!(self.stdin.as_mut().unwrap(), "{line}").unwrap();
        let mut answer = String::new();
        self.stdout.read_line(&mut answer).unwrap();
        answer.trim_end().to_owned()
    }

    pub fn close_stdin(&mut self) {
        self.stdin = None;
    }

    /// Sends the signal and gives the exit code.
    pub fn end_by(&mut self, signal: Signal) -> Option<i32> {
        kill_process(Pid::from_child(&self.child), signal).unwrap();
        self.child.wait().unwrap().code()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The slave, as any serial program opens it.
pub struct Port(OwnedFd);

impl Port {
    pub fn open(path: &std::path::Path) -> Self {
        Self(open(path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap())
    }

    /// Sets the baud, as a serial program does.
    pub fn set_baud(&self, baud: u32) {
        let mut settings = tcgetattr(&self.0).unwrap();
        settings.set_speed(baud).unwrap();
        tcsetattr(&self.0, OptionalActions::Now, &settings).unwrap();
    }

    /// One exchange with a motor of this model.
    pub fn ask_of(
        &self,
        model: family::Model,
        request: family::Request,
    ) -> Option<family::Reading> {
        self.write(request.frame(model).unwrap().bytes());
        let received: [u8; 10] = self.read(10, Duration::from_millis(500)).try_into().ok()?;
        let asked = request.reply_layout(model);
        family::Reading::decode(model, &Frame::new(received), asked).ok()
    }

    pub fn write(&self, bytes: &[u8]) {
        assert_eq!(rustix::io::write(&self.0, bytes).unwrap(), bytes.len());
    }

    /// All that comes until `count` bytes are there or so much time has passed.
    pub fn read(&self, count: usize, within: Duration) -> Vec<u8> {
        let (began, mut received) = (Instant::now(), Vec::new());
        while received.len() < count {
            let left = within.saturating_sub(began.elapsed());
            let timeout = Timespec::try_from(left).unwrap();
            let mut fds = [PollFd::new(&self.0, PollFlags::IN)];
            if poll(&mut fds, Some(&timeout)).unwrap() == 0 {
                break;
            }
            let mut buffer = [0; 256];
            let got = rustix::io::read(&self.0, &mut buffer).unwrap();
            received.extend_from_slice(&buffer[..got]);
        }
        received
    }

    /// One exchange. Half a second is long enough for a machine that does much else.
    pub fn ask(&self, request: Request) -> Option<Reply> {
        self.write(request.frame().bytes());
        let received: [u8; 10] = self.read(10, Duration::from_millis(500)).try_into().ok()?;
        Reply::decode(&Frame::new(received), request.reply_layout()).ok()
    }
}
