//! `motorlink control` on a terminal of its own.

use std::{
    fs::File,
    io::{Read, Write},
    os::{fd::OwnedFd, unix::ffi::OsStrExt},
    process::Stdio,
    thread::{self, sleep},
    time::Duration,
};

use rustix::{
    fs::{Mode, OFlags, open},
    pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
    termios::{Winsize, tcsetwinsize},
};

use crate::bench::Bench;

/// Both ends of a terminal of 100 columns.
fn terminal() -> (File, OwnedFd) {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let name = ptsname(&master, Vec::new()).unwrap();
    let path = std::path::Path::new(std::ffi::OsStr::from_bytes(name.to_bytes()));
    let slave = open(path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap();
    let size = Winsize {
        ws_row: 24,
        ws_col: 100,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    tcsetwinsize(&slave, size).unwrap();
    (master.into(), slave)
}

#[test]
fn a_key_drives_for_as_long_as_it_is_held_and_q_leaves_a_motor_that_stands() {
    let mut bench = Bench::new(&[]);
    let (mut keys, slave) = terminal();
    let mut screen = keys.try_clone().unwrap();
    let mut command = bench.command("control --rpm 100");
    let ends = [0, 1].map(|_| Stdio::from(slave.try_clone().unwrap()));
    let [input, output] = ends;
    let mut child = command.stdin(input).stdout(output).spawn().unwrap();
    drop((command, slave));
    // A terminal that nobody reads blocks the program.
    let shown = thread::spawn(move || {
        let mut shown = Vec::new();
        // It ends with an error when the program has closed its end.
        let _ = screen.read_to_end(&mut shown);
        String::from_utf8_lossy(&shown).into_owned()
    });
    sleep(Duration::from_millis(1500));
    bench.until(|rpm| {
        keys.write_all(b"f").unwrap();
        rpm > 90.0
    });
    // Let go.
    bench.until(|rpm| rpm.abs() < 1.0);
    bench.until(|rpm| {
        keys.write_all(b"b").unwrap();
        rpm < -90.0
    });
    keys.write_all(b"q").unwrap();
    let code = child.wait().unwrap().code();
    assert_eq!(code, Some(0));
    assert!(bench.stands());
    let shown = shown.join().unwrap();
    assert!(shown.contains("hold a key to run"), "{shown}");
    // The screen of before is back.
    assert!(shown.contains("\u{1b}[?1049l"), "{shown}");
}
