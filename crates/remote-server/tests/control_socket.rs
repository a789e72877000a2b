//! A controller on the socket, beside pages, on a real server with a virtual motor.
#![cfg(test)]
#![cfg(unix)]

#[path = "support/controller.rs"]
mod controller;
#[path = "support/page.rs"]
mod page;
mod support;

use std::{
    io::{Read, Write},
    net::TcpStream,
    os::unix::net::UnixStream,
    path::PathBuf,
    sync::atomic::{AtomicBool, Ordering},
    thread::{self, sleep},
    time::{Duration, Instant},
};

use controller::{Controller, DRIVEN, HELLO, STANDS, ask, attempts};
use motorlink_bus::{Command, StopReason};
use motorlink_remote::ToServer;
use motorlink_remote_server::{ControlSocket, RunningSocket};
use page::{Page, start};
use support::Bench;

/// 10 rad/s, about 95 rpm.
const FAST: [(u8, f32); 1] = [(1, 10.0)];

/// A server with a socket.
struct Server {
    _socket: RunningSocket,
    bench: Bench,
    path: PathBuf,
    _folder: tempfile::TempDir,
}

impl Server {
    fn start() -> Self {
        let bench = Bench::start(None);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socket");
        let socket = ControlSocket::bind(&path).unwrap();
        Self {
            _socket: socket.start(bench.viewers.clone()).unwrap(),
            bench,
            path,
            _folder: folder,
        }
    }

    fn controller(&self) -> Controller {
        Controller::connect(&self.path)
    }

    fn page(&self) -> Page {
        let stream = TcpStream::connect(self.bench.address).unwrap();
        let origin = format!("http://{}", self.bench.address);
        Page::connect(stream, &origin, "remote-boot.js", None).unwrap()
    }

    /// A controller that drives its wheel.
    fn driving(&self) -> Controller {
        let mut controller = self.controller();
        controller.start(&[1]);
        controller.drive(&FAST, "a turning wheel", |state| state.velocity(1) > 9.0);
        controller
    }
}

/// Gives these setpoints, with control or without, until `work` is done.
fn beside(controller: &mut Controller, speeds: &[(u8, f32)], work: impl FnOnce()) {
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        let driving = scope.spawn(|| {
            controller.drive(speeds, "the end of the work", |_| {
                is_over.load(Ordering::SeqCst)
            });
        });
        work();
        is_over.store(true, Ordering::SeqCst);
        driving.join().unwrap();
    });
}

#[test]
fn a_controller_drives_and_the_state_follows() {
    attempts(|| {
        let server = Server::start();
        let mut controller = server.controller();
        controller.wait("the temperature", |state| {
            state.motors() == 1 && state.temperature(1) > 0.0
        });
        assert!(!controller.state.is_armed());
        controller.start(&[1]);
        assert_eq!(controller.state.holder().0, 3);
        controller.drive(&FAST, "a turning wheel", |state| state.velocity(1) > 9.0);
        let before = controller.state.position(1);
        let began = Instant::now();
        let mut oldest = Duration::ZERO;
        controller.drive(&FAST, "a second", |state| {
            oldest = oldest.max(state.age(1));
            began.elapsed() > Duration::from_secs(1)
        });
        let turned = controller.state.position(1) - before;
        let expected = 10.0 * began.elapsed().as_secs_f64();
        assert!(
            (turned - expected).abs() < 2.0,
            "{turned} of {expected} rad"
        );
        assert!(oldest < Duration::from_millis(100), "{oldest:?}");
        controller.drive(&[(1, -5.0)], "the other direction", |state| {
            state.velocity(1) < -4.0
        });
        // A speed beyond the limits is limited.
        controller.drive(&[(1, 1e9)], "the limit", |state| state.velocity(1) > 18.0);
        assert_eq!(controller.state.drive(), DRIVEN);
        controller.disarm();
        controller.wait("a standing wheel", |state| state.drive() == STANDS);
        assert!(!controller.state.is_armed());
        assert_eq!(controller.state.ended(), 1);
        assert!(controller.state.velocity(1).abs() < 0.2);
    });
}

#[test]
fn silence_stops_the_wheel_and_only_the_next_arm_drives_it() {
    attempts(|| {
        let server = Server::start();
        let mut controller = server.driving();
        let silent = Instant::now();
        controller.wait("the end of the lease", |state| !state.is_armed());
        let ended = silent.elapsed();
        assert!(ended < Duration::from_millis(400), "{ended:?}");
        assert_eq!(controller.state.ended(), 2);
        controller.wait("a standing wheel", |state| state.drive() == STANDS);
        let began = Instant::now();
        controller.drive(&FAST, "half a second", |state| {
            assert!(!state.is_armed() && state.velocity(1).abs() < 0.2);
            began.elapsed() > Duration::from_millis(500)
        });
        controller.start(&[1]);
        controller.drive(&FAST, "a turning wheel", |state| state.velocity(1) > 9.0);
    });
}

#[test]
fn a_controller_that_goes_stops_the_wheel() {
    attempts(|| {
        let server = Server::start();
        let mut watcher = server.controller();
        drop(server.driving());
        watcher.wait("nobody with control", |state| state.holder().0 == 0);
        watcher.wait("a standing wheel", |state| {
            state.is_halted() && state.velocity(1).abs() < 0.2
        });
        watcher.start(&[1]);
        watcher.drive(&FAST, "a turning wheel", |state| state.velocity(1) > 9.0);
    });
}

#[test]
fn control_is_taken_from_nobody() {
    attempts(|| {
        let server = Server::start();
        let mut page = server.page();
        page.take_control();
        let mut controller = server.controller();
        assert_eq!(controller.arm(&[1]), 1);
        assert_eq!(controller.state.holder().0, 1);
        page.drive();
        beside(&mut controller, &[(1, -10.0)], || {
            page.live(Duration::from_millis(500));
        });
        assert!(page.turns() && page.speed().unwrap().rpm() > 0);
        // What holds no control gives none up.
        controller.disarm();
        page.live(Duration::from_millis(300));
        assert!(page.turns());
        page.send(&ToServer::GiveUp);
        page.wait("no control", |page| page.epoch.is_none());
        controller.start(&[1]);

        let mut second = server.controller();
        controller.drive(&FAST, "a turning wheel", |state| state.velocity(1) > 9.0);
        second.wait("a new state", |state| {
            state.sent_ago() < Duration::from_millis(50)
        });
        second.order(1, second.state.challenge(), &[(1, 0.0)]);
        let began = Instant::now();
        controller.drive(&FAST, "a moment", |state| {
            second.next().unwrap();
            second.setpoints(&[(1, -10.0)]);
            assert!(state.is_armed());
            began.elapsed() > Duration::from_millis(300)
        });
        assert_eq!(second.state.arm().1, 2);
        assert_eq!(second.state.holder().0, 2);
        assert!(controller.state.velocity(1) > 9.0);
    });
}

#[test]
fn a_page_takes_control_by_its_second_press() {
    attempts(|| {
        let server = Server::start();
        let mut controller = server.driving();
        let mut page = server.page();
        page.wait("a reply", |page| page.speed().is_some());
        beside(&mut controller, &FAST, || {
            page.send(&ToServer::Take { by_force: false });
            page.live(Duration::from_millis(1_100));
            assert!(page.turns() && page.epoch.is_none());
            page.send(&ToServer::Take { by_force: true });
            page.wait("control", |page| page.epoch.is_some());
            page.live(Duration::from_millis(500));
        });
        assert_eq!(controller.state.ended(), 3);
        assert_eq!(controller.state.drive(), STANDS);
        beside(&mut controller, &[(1, -10.0)], || {
            page.sequence = 0;
            page.act(Command::Release);
            page.act(start());
            page.live(Duration::from_secs(1));
        });
        assert!(page.turns() && page.speed().unwrap().rpm() > 0);
        assert_eq!(controller.arm(&[1]), 1);
    });
}

#[test]
fn a_watcher_stops_the_wheel_and_later_setpoints_start_nothing() {
    attempts(|| {
        let server = Server::start();
        let stops: [&dyn Fn(); 2] = [
            &|| {
                let mut page = server.page();
                page.wait("a challenge", |page| page.challenge != 0);
                page.act(Command::StopAll(StopReason::Operator));
                page.wait("a halt", Page::is_halted);
            },
            &|| {
                let said = ask(&server.path, "stop\nstate\n");
                assert!(said.starts_with("All motors are being stopped."), "{said}");
            },
        ];
        for stop in stops {
            let mut controller = server.driving();
            beside(&mut controller, &FAST, stop);
            controller.drive(&FAST, "a standing wheel", |state| state.drive() == STANDS);
            assert_eq!(controller.state.ended(), 4);
            let began = Instant::now();
            controller.drive(&FAST, "half a second", |state| {
                assert!(state.velocity(1).abs() < 0.2 && state.is_halted());
                began.elapsed() > Duration::from_millis(500)
            });
            // It has kept its control, but a person has to release the wheel.
            assert!(controller.state.is_armed());
            assert_eq!(controller.arm(&[1]), 6);
            assert!(ask(&server.path, "release\n").contains("may start"));
            controller.start(&[1]);
            controller.disarm();
            controller.wait("a standing wheel", |state| state.drive() == STANDS);
        }
    });
}

#[test]
fn what_a_person_has_stopped_is_released_on_a_page() {
    attempts(|| {
        let server = Server::start();
        let mut page = server.page();
        page.take_control();
        page.act(Command::StopAll(StopReason::Operator));
        page.wait("a halt", Page::is_halted);
        page.send(&ToServer::GiveUp);
        page.wait("the end of control", |page| page.epoch.is_none());
        let mut controller = server.controller();
        assert_eq!(controller.arm(&[1]), 6);
        page.take_control();
        page.act(Command::Release);
        page.wait("the release", |page| !page.is_halted());
        page.send(&ToServer::GiveUp);
        page.wait("the end of control", |page| page.epoch.is_none());
        controller.start(&[1]);
        controller.disarm();
        controller.wait("a standing wheel", |state| state.drive() == STANDS);
    });
}

#[test]
fn what_is_no_number_or_for_other_motors_stops_the_wheel() {
    attempts(|| {
        let server = Server::start();
        let cases: [(&[(u8, f32)], u8); 4] = [
            (&[(1, f32::NAN)], 11),
            (&[(1, f32::INFINITY)], 11),
            (&[(2, 10.0)], 12),
            (&[(1, 10.0), (2, 10.0)], 12),
        ];
        for (speeds, why) in cases {
            let mut controller = server.driving();
            controller.drive(speeds, "the end", |state| state.ended() != 0);
            assert_eq!(controller.state.ended(), why);
            assert!(!controller.state.is_armed());
            controller.wait("a standing wheel", |state| state.drive() == STANDS);
        }
    });
}

#[test]
fn an_arm_needs_zeros_and_a_new_challenge_and_motors_that_answer() {
    attempts(|| {
        let server = Server::start();
        let mut controller = server.controller();
        assert_eq!(controller.arm_at(&[(1, 1.0)]), 4);
        assert_eq!(controller.arm_at(&[(1, f32::NAN)]), 4);
        let old = controller.state.challenge();
        let began = Instant::now();
        controller.wait("a moment", |_| began.elapsed() > Duration::from_millis(200));
        controller.order(1, old, &[(1, 0.0)]);
        controller.wait("a refusal", |state| state.arm().1 == 3);
        controller.order(1, 0, &[(1, 0.0)]);
        assert_eq!(controller.arm(&[7]), 0);
        controller.drive(&[(7, 0.0)], "the end", |state| state.ended() == 10);
        controller.disarm();
        controller.wait("no control", |state| !state.is_armed());
        controller.start(&[1]);
        assert_eq!(controller.arm(&[1]), 5);
    });
}

/// Everything that comes until the server closes.
fn rest(mut stream: UnixStream) -> Vec<u8> {
    stream.set_read_timeout(Some(support::SOON)).unwrap();
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    bytes
}

#[test]
fn another_version_is_refused_with_both_versions() {
    let server = Server::start();
    let mut stream = UnixStream::connect(&server.path).unwrap();
    let mut hello = HELLO;
    hello[4] = 9;
    stream.write_all(&hello).unwrap();
    let said = rest(stream);
    assert_eq!(said.len(), 8 + 416);
    assert_eq!(said[8..10], [2, 1]);
    let text = String::from_utf8_lossy(&said[12..]).into_owned();
    assert!(
        text.contains("version 9") && text.contains("version 1"),
        "{text}"
    );
}

#[test]
fn garbage_gets_an_error_and_is_closed_and_the_wheel_is_stopped() {
    attempts(|| {
        let server = Server::start();
        let garbage: [&[u8]; 4] = [
            b"\x00\x01",
            b"GET / HTTP/1.1\r\n",
            b"\x89PNG\r\n\x1a\n",
            b"steer\n",
        ];
        for bytes in garbage {
            let mut stream = UnixStream::connect(&server.path).unwrap();
            stream.write_all(bytes).unwrap();
            stream.shutdown(std::net::Shutdown::Write).unwrap();
            let said = rest(stream);
            let said = String::from_utf8_lossy(&said);
            assert!(
                said.contains("neither a hello nor a command"),
                "{bytes:?}: {said}"
            );
        }
        for kind in [0, 9] {
            let mut controller = server.driving();
            controller.order(kind, controller.state.challenge(), &FAST);
            let error = loop {
                if let Err(error) = controller.next() {
                    break error;
                }
            };
            assert_eq!(error, format!("no message is of kind {kind}"));
            let mut watcher = server.controller();
            watcher.wait("a standing wheel", |state| {
                state.motors() == 1 && state.velocity(1).abs() < 0.2
            });
            assert_eq!(watcher.state.holder().0, 0);
        }
        // A flood.
        let mut controller = server.controller();
        let error = loop {
            for _ in 0..100 {
                controller.setpoints(&FAST);
            }
            if let Err(error) = controller.next() {
                break error;
            }
        };
        assert!(error.contains("2000 messages"), "{error}");
    });
}

#[test]
fn a_client_that_takes_nothing_delays_nobody_and_reads_new_states_afterwards() {
    attempts(|| {
        let server = Server::start();
        let mut slow = server.controller();
        let mut controller = server.driving();
        let began = Instant::now();
        let mut oldest = Duration::ZERO;
        controller.drive(&FAST, "two seconds", |state| {
            oldest = oldest.max(state.age(1));
            began.elapsed() > Duration::from_secs(2)
        });
        assert!(oldest < Duration::from_millis(100), "{oldest:?}");
        // The system has kept a few old states for it.
        slow.stream.set_nonblocking(true).unwrap();
        let mut old = Vec::new();
        let _ = slow.stream.read_to_end(&mut old);
        assert!((1..20).contains(&(old.len() / 416)), "{} bytes", old.len());
        slow.stream.set_nonblocking(false).unwrap();
        let position = controller.state.position(1);
        slow.wait("a new state", |state| state.position(1) >= position);
    });
}

#[test]
fn clients_are_limited() {
    let server = Server::start();
    let mut clients: Vec<_> = (0..8).map(|_| server.controller()).collect();
    let mut ninth = UnixStream::connect(&server.path).unwrap();
    ninth.write_all(&HELLO).unwrap();
    let said = rest(ninth);
    assert_eq!(said[8..10], [2, 5]);
    assert!(ask(&server.path, "state\n").contains("too many clients"));
    clients.pop();
    sleep(Duration::from_millis(200));
    assert!(ask(&server.path, "state\n").contains("motor 1 idle"));
    // A stop needs no place.
    clients.push(server.controller());
    assert!(ask(&server.path, "state\n").contains("too many clients"));
    assert!(ask(&server.path, "stop\n").contains("All motors are being stopped"));
}

#[test]
fn the_text_form_shows_motors_and_who_has_control() {
    attempts(|| {
        let server = Server::start();
        let said = ask(&server.path, "state");
        assert!(
            said.starts_with("control: nobody, DDSM115\nmotor 1 idle: "),
            "{said}"
        );
        assert!(said.contains(" degC, faults 0x00, reply "), "{said}");
        assert!(ask(&server.path, "help\n").contains("docs/socket.md"));
        // A state of its time, though nobody was there meanwhile.
        assert!(ask(&server.path, "stop\n").contains("being stopped"));
        sleep(Duration::from_millis(200));
        let said = ask(&server.path, "state\n");
        assert!(
            said.starts_with("control: nobody, all motors stopped, DDSM115\n"),
            "{said}"
        );
        ask(&server.path, "release\n");
        let mut controller = server.driving();
        let mut watch = UnixStream::connect(&server.path).unwrap();
        watch.write_all(b"watch\n").unwrap();
        watch.set_read_timeout(Some(support::SOON)).unwrap();
        let mut said = String::new();
        let began = Instant::now();
        while said.matches("motor 1 driven: ").count() < 3 {
            controller.next().unwrap();
            controller.setpoints(&FAST);
            watch.set_nonblocking(true).unwrap();
            let mut bytes = [0; 512];
            if let Ok(got) = watch.read(&mut bytes) {
                said.push_str(std::str::from_utf8(&bytes[..got]).unwrap());
            }
            assert!(began.elapsed() < support::SOON, "{said}");
        }
        assert!(said.contains("(socket), DDSM115\n"), "{said}");
        assert_eq!(controller.state.drive(), DRIVEN);
    });
}
