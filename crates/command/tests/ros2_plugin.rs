//! The plugin of `ros/motorlink_hardware` without ROS: its own sources, compiled with stand-ins for the headers of
//! `ros2_control`, drive virtual motors through a server.

use std::{
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, Stdio},
    sync::{
        OnceLock,
        mpsc::{Receiver, channel},
    },
    thread,
    time::{Duration, Instant},
};

use rustix::process::Signal;

use crate::{
    bench::{Bench, signal},
    control_socket::{Served, until_it_stands},
    controller::{Controller, HELLO, attempts},
};

/// A busy machine is slow.
const PATIENCE: Duration = Duration::from_secs(20);

/// The test program with the API of Humble, and with that of later versions.
pub struct Programs {
    pub humble: PathBuf,
    later: PathBuf,
    _folder: tempfile::TempDir,
}

/// Compiled once, before anything is driven: a compiler delays what has 100 ms.
pub fn programs() -> &'static Programs {
    static PROGRAMS: OnceLock<Programs> = OnceLock::new();
    PROGRAMS.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let of = |name: &str, stubs: &[&str]| compiled(folder.path(), name, stubs);
        Programs {
            humble: of("humble", &["test/stub"]),
            later: of("later", &["test/stub_params", "test/stub"]),
            _folder: folder,
        }
    })
}

/// Compiles the plugin with the test program. `stubs`: the folders of the headers, the first one first.
fn compiled(dir: &Path, name: &str, stubs: &[&str]) -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ros/motorlink_hardware");
    let program = dir.join(name);
    let mut compiler = Command::new("g++");
    compiler.args(["-std=c++17", "-O1", "-Wall", "-Wextra", "-Werror"]);
    for folder in [&["include"], stubs].concat() {
        compiler.arg("-I").arg(package.join(folder));
    }
    for source in [
        "src/motorlink_system.cpp",
        "src/socket_client.cpp",
        "test/drive.cpp",
    ] {
        compiler.arg(package.join(source));
    }
    compiler.arg("-o").arg(&program);
    crate::tools::run(
        &mut compiler,
        "g++ is missing: install it (Debian: apt-get install g++)",
    );
    program
}

/// The test program, which plays the controller manager.
pub struct Manager {
    child: Child,
    stdin: ChildStdin,
    lines: Receiver<String>,
}

impl Manager {
    pub fn start(program: &Path, socket: &Path) -> Self {
        let mut child = Command::new(program)
            .arg(socket)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (sender, lines) = channel();
        let out = BufReader::new(child.stdout.take().unwrap());
        thread::spawn(move || {
            out.lines().map_while(Result::ok).for_each(|line| {
                let _ = sender.send(line);
            });
        });
        let stdin = child.stdin.take().unwrap();
        Self {
            child,
            stdin,
            lines,
        }
    }

    /// The next line that begins so, and those before it.
    pub fn until(&self, start: &str) -> (String, Vec<String>) {
        let (began, mut said) = (Instant::now(), Vec::new());
        loop {
            let left = PATIENCE.saturating_sub(began.elapsed());
            let line = self.lines.recv_timeout(left);
            let line = line.unwrap_or_else(|_| panic!("no \"{start}\": {said:?}"));
            if line.starts_with(start) {
                return (line, said);
            }
            said.push(line);
        }
    }

    fn tell(&mut self, command: &str) {
        writeln!(self.stdin, "{command}").unwrap();
    }

    /// Gives a command, and returns what is said before its answer.
    pub fn does(&mut self, command: &str, answer: &str) -> Vec<String> {
        self.tell(command);
        self.until(answer).1
    }

    /// Values of a joint.
    pub fn state(&mut self) -> impl Fn(&str) -> f64 + use<> {
        self.tell("state");
        let (line, said) = self.until("state");
        assert!(said.is_empty(), "{said:?}");
        move |name: &str| {
            let mut words = line.split(' ');
            let value = words.find_map(|word| word.strip_prefix(name)?.strip_prefix('='));
            value.unwrap().parse().unwrap()
        }
    }

    fn turn(&mut self) {
        self.does("activate", "activate success");
        self.does("set 10 10", "set");
        let began = Instant::now();
        loop {
            let state = self.state();
            if state("left/velocity") > 9.0 && state("right/velocity") > 9.0 {
                return;
            }
            assert!(
                began.elapsed() < PATIENCE,
                "{} and {} rad/s",
                state("left/velocity"),
                state("right/velocity")
            );
        }
    }
}

impl Drop for Manager {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn the_plugin_of_ros2_control_drives_and_stops() {
    attempts(drive_and_stop);
}

fn drive_and_stop() {
    let program = &programs().humble;
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let served = Served::start(&bench);
    let mut manager = Manager::start(program, &served.socket);
    manager.until("configured");
    manager.turn();
    // The right motor is mirrored: both wheels turn ahead.
    let mut watcher = Controller::connect(&served.socket);
    watcher.wait("a mirrored pair", |state| {
        state.velocity(1) > 9.0 && state.velocity(2) < -9.0
    });
    let before = manager.state();
    thread::sleep(Duration::from_secs(1));
    let after = manager.state();
    for name in ["left/position", "right/position"] {
        let turned = after(name) - before(name);
        assert!(
            (8.0..14.0).contains(&turned),
            "{name}: {turned} rad in about a second"
        );
    }
    assert!(after("left/temperature") > 0.0);
    // 150 rpm are the limit of the joint.
    manager.does("set 1000 1000", "set");
    thread::sleep(Duration::from_secs(1));
    let speed = manager.state()("left/velocity");
    assert!((14.0..17.5).contains(&speed), "{speed} rad/s");

    // The controller goes, and leaves its command in the interface.
    manager.does("switch", "switched");
    until_it_stands(&mut bench);
    thread::sleep(Duration::from_millis(300));
    assert!(bench.stands());

    let said = manager.does("deactivate", "deactivate success");
    assert!(
        said.contains(&"info the motors stand, confirmed".to_owned()),
        "{said:?}"
    );
    assert!(bench.stands());
    let state = manager.state();
    watcher.wait("the positions of the wheels", |of_server| {
        let is_so = |id: u8, name: &str, sign: f64| {
            (of_server.position(id) - sign * state(name)).abs() < 1e-6
        };
        is_so(1, "left/position", 1.0) && is_so(2, "right/position", -1.0)
    });
    manager.turn();
    manager.does("shutdown", "shutdown success");
    assert!(bench.stands());
    served.end();
}

#[test]
fn a_manager_that_hangs_or_is_killed_stops_the_wheels_and_is_told() {
    attempts(hang_and_die);
}

fn hang_and_die() {
    let program = &programs().later;
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let served = Served::start(&bench);
    let mut manager = Manager::start(program, &served.socket);
    manager.until("configured");
    manager.turn();
    // Its own stop, from the same speed.
    manager.tell("deactivate");
    let by_itself = until_it_stands(&mut bench);
    manager.until("deactivate success");
    manager.turn();
    signal(&manager.child, Signal::STOP);
    let after_stop = until_it_stands(&mut bench);
    println!("stop {by_itself:?}, after SIGSTOP {after_stop:?}");
    let allowed = by_itself + Duration::from_millis(100);
    assert!(
        after_stop < allowed + Duration::from_millis(400),
        "{after_stop:?}"
    );
    signal(&manager.child, Signal::CONT);
    let (_, said) = manager.until("on_error");
    assert!(
        said.iter().any(|line| line.contains("did not answer for 100 ms") || line.contains("no reply for")),
        "{said:?}"
    );
    thread::sleep(Duration::from_millis(300));
    assert!(bench.stands(), "nothing turns before it is activated again");
    manager.does("configure", "configured");
    manager.turn();
    manager.child.kill().unwrap();
    let after_kill = until_it_stands(&mut bench);
    assert!(
        after_kill < allowed + Duration::from_millis(400),
        "{after_kill:?}"
    );
    let mut manager = Manager::start(program, &served.socket);
    manager.until("configured");
    manager.turn();
    // The server goes, with a confirmed stop.
    served.end();
    manager.until("on_error");
    assert!(bench.stands());
    let said = manager.does("configure", "not configured");
    assert!(
        said.iter()
            .any(|line| line.contains("Does motorlink serve --socket run?")),
        "{said:?}"
    );
}

#[test]
fn the_plugin_says_why_it_has_no_control() {
    attempts(be_refused);
}

fn be_refused() {
    let program = &programs().humble;
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let served = Served::start(&bench);
    let mut other = Controller::connect(&served.socket);
    other.start(&[1, 2]);
    let mut manager = Manager::start(program, &served.socket);
    manager.until("configured");
    manager.tell("activate");
    let mut said = Vec::new();
    other.drive(&[(1, 0.0), (2, 0.0)], "an answer", |_| {
        said.extend(manager.lines.try_iter());
        said.iter().any(|line| line.starts_with("activate"))
    });
    assert!(
        said.iter()
            .any(|line| line.contains("another client of the socket has control")),
        "{said:?}"
    );
    other.disarm();
    other.wait("no control", |state| !state.is_armed());
    manager.turn();
    // A person stops them.
    crate::controller::ask(&served.socket, "stop\n");
    let (_, said) = manager.until("on_error");
    assert!(
        said.iter()
            .any(|line| line.contains("a person has stopped the motors")),
        "{said:?}"
    );
    assert!(bench.stands());
    manager.does("configure", "configured");
    let said = manager.does("activate", "activate failed");
    assert!(
        said.iter()
            .any(|line| line.contains("a person has stopped all motors")),
        "{said:?}"
    );
    crate::controller::ask(&served.socket, "release\n");
    manager.turn();
    manager.does("shutdown", "shutdown success");

    // A server of another version.
    let socket = PathBuf::from(bench.file("other"));
    let listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    let refused = Manager::start(program, &socket);
    let (mut stream, _) = listener.accept().unwrap();
    let mut hello = HELLO;
    hello[4] = 7;
    stream.write_all(&hello).unwrap();
    let (_, said) = refused.until("not configured");
    assert!(
        said.iter()
            .any(|line| line.contains("version 7") && line.contains("version 1")),
        "{said:?}"
    );
}
