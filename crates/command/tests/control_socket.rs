//! `motorlink serve --socket` as a program. What a controller may do is in `crates/remote-server/tests/control_socket.rs`.

use std::{
    fs,
    io::{BufRead, BufReader},
    os::unix::{
        fs::{FileTypeExt, PermissionsExt},
        net::UnixListener,
    },
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use rustix::process::Signal;

use crate::{
    bench::{Bench, Said, signal},
    controller::{Controller, NOT_CONFIRMED, STANDS, State, ask, attempts},
    serve::page,
};

/// 10 rad/s, about 95 rpm: the second wheel is mirrored by the client.
pub const FAST: [(u8, f32); 2] = [(1, 10.0), (2, -10.0)];

/// A server with a socket, at the port of a bench.
pub struct Served {
    pub child: Child,
    pub socket: PathBuf,
    _page: tempfile::TempDir,
}

impl Served {
    pub fn start(bench: &Bench) -> Self {
        let page = page();
        let socket = PathBuf::from(bench.file("socket"));
        let mut command = bench.command("--id 1,2 serve --listen 127.0.0.1:0");
        command
            .arg("--socket")
            .arg(&socket)
            .arg("--page")
            .arg(page.path());
        let mut child = command.spawn().unwrap();
        let lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let mut lines = lines.map_while(Result::ok);
        let found = lines.any(|line| line.starts_with("Open "));
        assert!(found, "the server does not start");
        // It would block on a full pipe.
        std::thread::spawn(move || lines.for_each(|line| println!("server: {line}")));
        Self {
            child,
            socket,
            _page: page,
        }
    }

    /// Ends it as a person does.
    pub fn end(mut self) {
        signal(&self.child, Signal::INT);
        assert_eq!(self.child.wait().unwrap().code(), Some(0));
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn driving(served: &Served) -> Controller {
    let mut controller = Controller::connect(&served.socket);
    controller.start(&[1, 2]);
    controller.drive(&FAST, "turning wheels", |state| {
        state.velocity(1) > 9.0 && state.velocity(2) < -9.0
    });
    controller
}

/// How long the wheel takes to stand from now on.
pub fn until_it_stands(bench: &mut Bench) -> Duration {
    let began = Instant::now();
    bench.until(|rpm| rpm.abs() < 1.0);
    began.elapsed()
}

#[test]
fn a_controller_that_hangs_or_is_killed_stops_the_wheels() {
    attempts(hang_and_die);
}

fn hang_and_die() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let served = Served::start(&bench);
    let mut stopped = driving(&served);
    stopped.disarm();
    let by_itself = until_it_stands(&mut bench);
    stopped.wait("standing wheels", |state| state.drive() == STANDS);
    // It hangs: it does not even read.
    let hung = driving(&served);
    let after_silence = until_it_stands(&mut bench);
    let allowed = by_itself + Duration::from_millis(100);
    println!("stop {by_itself:?}, after silence {after_silence:?}");
    // A busy machine is slow.
    assert!(
        after_silence < allowed + Duration::from_millis(400),
        "{after_silence:?}"
    );
    // Another one drives at once; the one that hung has nothing to say.
    let mut next = driving(&served);
    drop(hung);
    next.drive(&FAST, "a moment", State::is_armed);
    drop(next);
    let after_kill = until_it_stands(&mut bench);
    assert!(
        after_kill < allowed + Duration::from_millis(400),
        "{after_kill:?}"
    );
    let said = ask(&served.socket, "state\n");
    assert!(
        said.starts_with("control: nobody, all motors stopped, DDSM115\n"),
        "{said}"
    );
    served.end();
    assert!(bench.stands());
}

#[test]
fn a_server_that_was_killed_is_replaced_and_its_wheels_are_stopped() {
    attempts(kill_the_server);
}

fn kill_the_server() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let mut served = Served::start(&bench);
    let mut controller = driving(&served);
    served.child.kill().unwrap();
    served.child.wait().unwrap();
    while controller.next().is_ok() {}
    assert!(!bench.stands(), "the motors keep their last command");
    let socket = served.socket.clone();
    assert!(socket.exists());
    let served = Served::start(&bench);
    assert!(bench.stands());
    let made = fs::symlink_metadata(&socket).unwrap();
    assert!(made.file_type().is_socket());
    assert_eq!(made.permissions().mode() & 0o777, 0o660);
    drop(driving(&served));
    served.end();
    assert!(!socket.exists());
    assert!(bench.stands());
}

#[test]
fn positions_are_those_of_the_wheels() {
    attempts(compare_positions);
}

fn compare_positions() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let served = Served::start(&bench);
    let mut controller = Controller::connect(&served.socket);
    let mut stands_at = |bench: &mut Bench, speeds: [(u8, f32); 2], seconds: u64| {
        controller.start(&[1, 2]);
        let began = Instant::now();
        controller.drive(&speeds, "the time", |_| {
            began.elapsed() >= Duration::from_secs(seconds)
        });
        controller.disarm();
        controller.wait("standing wheels", |state| state.drive() == STANDS);
        [1, 2].map(|id| {
            let figure = format!("state {id}");
            let said = bench.motors.command(&figure);
            let (_, rest) = said.split_once("angle=").unwrap();
            let angle: f64 = rest.split(' ').next().unwrap().parse().unwrap();
            (controller.state.position(id).to_degrees(), angle)
        })
    };
    let before = stands_at(&mut bench, FAST, 1);
    for (speeds, seconds) in [(FAST, 5), ([(1, -3.0), (2, 17.0)], 3)] {
        let after = stands_at(&mut bench, speeds, seconds);
        for ((before, speed), after) in before.into_iter().zip(speeds).zip(after) {
            // The motor's angle falls at positive speed.
            let sum = (after.0 - before.0) + (after.1 - before.1);
            let error = sum - 360.0 * (sum / 360.0).round();
            println!("{speed:?}: {before:?} to {after:?}: {error:.3} degrees");
            assert!(error.abs() < 0.5, "{error} degrees");
        }
    }
}

#[test]
fn a_motor_that_falls_silent_ends_the_drive_of_both_and_is_named() {
    attempts(fall_silent);
}

fn fall_silent() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let served = Served::start(&bench);
    let mut controller = driving(&served);
    bench.motors.command("mute 2 on");
    controller.drive(&FAST, "the end", |state| state.ended() != 0);
    assert_eq!(controller.state.ended(), 7);
    controller.drive(&FAST, "the end of the stop", |state| {
        state.drive() == NOT_CONFIRMED
    });
    assert!(bench.stands());
    assert!(controller.state.velocity(2).is_nan(), "its last one is old");
    let said = ask(&served.socket, "state\n");
    let mut lines = said.lines();
    let of_muted = lines.find(|line| line.starts_with("motor 2 "));
    assert!(of_muted.unwrap().contains(", ? rad/s, ? A,"), "{said}");
    bench.motors.command("mute 2 off");
    controller.drive(&FAST, "standing wheels", |state| state.drive() == STANDS);
    controller.start(&[1, 2]);
}

#[test]
fn an_adapter_that_is_pulled_out_ends_the_drive_and_its_return_starts_nothing() {
    attempts(pull_out);
}

fn pull_out() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let served = Served::start(&bench);
    let mut controller = driving(&served);
    bench.motors.command("unplug");
    controller.drive(&FAST, "the end", |state| state.ended() != 0);
    assert_eq!(controller.state.ended(), 13);
    let began = Instant::now();
    controller.drive(&FAST, "a moment", |state| {
        assert_eq!(state.drive(), NOT_CONFIRMED);
        began.elapsed() > Duration::from_millis(300)
    });
    assert!(!bench.stands(), "the motors keep their last command");
    bench.motors.command("plug");
    controller.drive(&FAST, "standing wheels", |state| state.drive() == STANDS);
    let began = Instant::now();
    controller.drive(&FAST, "a moment", |_| {
        began.elapsed() > Duration::from_millis(300)
    });
    assert!(bench.stands());
}

fn refused(path: &Path, says: &str) {
    let page = page();
    let output = Command::new(env!("CARGO_BIN_EXE_motorlink"))
        .args(["--virtual", "serve", "--listen", "127.0.0.1:0", "--socket"])
        .arg(path)
        .arg("--page")
        .arg(page.path())
        .stdin(Stdio::null())
        .output();
    let said = Said::of(output.unwrap());
    assert_eq!(said.code, Some(2), "{}", said.err);
    assert_eq!(said.err.lines().count(), 1, "{}", said.err);
    assert!(
        said.err.contains("--socket ") && said.err.contains(says),
        "{}",
        said.err
    );
}

#[test]
fn a_path_that_cannot_be_used_gets_one_line_and_stays_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("file"), "mine").unwrap();
    refused(&path("file"), "no socket");
    assert_eq!(fs::read(path("file")).unwrap(), b"mine");
    let used = UnixListener::bind(path("used")).unwrap();
    refused(&path("used"), "another program listens there");
    assert!(path("used").exists());
    drop(used);
    refused(&path("none/socket"), "No such file");
    refused(&path(&"long".repeat(40)), "");
}

/// A wheel may turn that an earlier server has left driven.
#[test]
fn a_wrong_socket_does_not_keep_a_left_wheel_turning() {
    attempts(start_with_a_wrong_socket);
}

fn start_with_a_wrong_socket() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let mut served = Served::start(&bench);
    let _controller = driving(&served);
    served.child.kill().unwrap();
    served.child.wait().unwrap();
    assert!(!bench.stands());
    let page = page();
    let mut command = bench.command("serve --listen 127.0.0.1:0 --socket");
    command.arg(page.path()).arg("--page").arg(page.path());
    let said = Said::of(command.output().unwrap());
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("no socket"), "{said:?}");
    assert!(bench.stands());
}
