//! `motorlink replay` of a session of ten seconds: 100 rpm for half of them, then nothing.

use std::{fs, process::Command};

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::{Frame, Instant, Layout, Mode};
use motorlink_session::{Event, EventKind, Writer};
use rustix::process::Signal;

use crate::{
    bench::{Said, signal},
    terminal::Terminal,
};

struct Fixture(tempfile::TempDir);

impl Fixture {
    fn new() -> Self {
        let mut writer = Writer::new(1_795_266_936_962_000, &[("page", "0.1.0")]);
        for n in 0..500 {
            let mode = Some(Mode::Velocity);
            let speed = if n < 250 { 100 } else { 0 };
            for id in [1, 2] {
                let at = Instant::from_millis(n * 20 + u64::from(id) * 3);
                let frame = Frame::with_crc([id, 0x64, 0, speed, 0, 0, 0, 0, 0]);
                let kind = LineEventKind::Sent { frame, mode };
                writer.line(&LineEvent { at, kind });
                let frame = Frame::with_crc([id, 2, 2, 0xCD, 0, speed, 0x17, 0xCF, 0]);
                let asked = Some(Layout::Drive);
                let kind = LineEventKind::Received { frame, asked };
                writer.line(&LineEvent { at, kind });
            }
        }
        let end = Event::new(EventKind::StopEnded, "All stand\u{1b}[2J.");
        writer.event(Instant::from_millis(10_000), &end);
        let fixture = Self(tempfile::tempdir().unwrap());
        fs::write(fixture.0.path().join("run.mcap"), writer.finish()).unwrap();
        fixture
    }

    /// Damages a chunk of the file.
    fn damage(&self) {
        let path = self.0.path().join("run.mcap");
        let mut bytes = fs::read(&path).unwrap();
        let name = bytes.windows(7).position(|seven| seven == b"\x03\0\0\0lz4");
        bytes[name.unwrap() + 100] ^= 1;
        fs::write(path, bytes).unwrap();
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_motorlink"));
        command.current_dir(self.0.path());
        command.args(line.split_ascii_whitespace());
        command
    }

    fn run(&self, line: &str) -> Said {
        Said::of(self.command(line).output().unwrap())
    }
}

#[test]
fn in_a_pipe_it_writes_the_lines_of_monitor_at_once_with_their_time() {
    let fixture = Fixture::new();
    // There is no such port, and none is opened.
    let said = fixture.run("--port /dev/none --id -2 replay run.mcap --from 4 --to 5.5");
    assert_eq!(said.code, Some(0), "{said:?}");
    let lines: Vec<_> = said.out.lines().collect();
    assert_eq!(lines.len(), 8, "{said:?}");
    assert!(
        lines[0].starts_with("    4.000 -0x02  velocity   -100 rpm"),
        "{said:?}"
    );
    assert!(lines[7].contains("+0 rpm"), "{said:?}");
    let both = fixture.run("replay run.mcap");
    assert!((98..=102).contains(&both.out.lines().count()), "{both:?}");
}

#[test]
fn csv_and_json_have_every_reply_of_the_part() {
    let fixture = Fixture::new();
    let csv = fixture.run("replay run.mcap --csv");
    let exported = fixture.run("session export run.mcap --format telemetry");
    assert_eq!(csv.out, exported.out);
    assert_eq!(csv.out.lines().count(), 1 + 1_000);
    let part = fixture.run("--id 1 replay run.mcap --csv rows.csv --from 1 --to 2");
    assert_eq!((part.code, part.out.as_str()), (Some(0), ""), "{part:?}");
    let rows = fs::read_to_string(fixture.0.path().join("rows.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 51, "{rows}");
    let json = fixture.run("--id 2 replay run.mcap --json --from 9.9");
    assert_eq!(json.out.lines().count(), 5, "{json:?}");
    let last: serde_json::Value = serde_json::from_str(json.out.lines().last().unwrap()).unwrap();
    assert_eq!(
        (&last["motor_id"], &last["mono_us"]),
        (&2.into(), &9_986_000.into())
    );
}

#[test]
fn on_a_terminal_keys_pause_jump_and_leave_and_the_screen_of_before_is_back() {
    let fixture = Fixture::new();
    let mut replay = Terminal::run(fixture.command("replay run.mcap --speed 0.1"));
    replay.expect("0:09.9");
    replay.expect("playing");
    replay.expect("+100");
    replay.press(" ");
    replay.expect("aused");
    // Ten seconds further.
    replay.press("\u{1b}[C\u{1b}[C");
    replay.expect("at the");
    // Control characters of a file reach no terminal.
    replay.expect("stand[2J.");
    replay.press("q");
    let (code, shown) = replay.end();
    assert_eq!(code, Some(0), "{shown}");
    assert!(shown.contains("\u{1b}[?1049l"), "{shown}");
}

#[test]
fn a_signal_restores_the_terminal_too() {
    let fixture = Fixture::new();
    let mut replay = Terminal::run(fixture.command("replay run.mcap"));
    replay.expect("playing");
    signal(&replay.child, Signal::TERM);
    let (code, shown) = replay.end();
    assert_eq!(code, Some(1), "{shown}");
    assert!(shown.contains("\u{1b}[?1049l"), "{shown}");
}

#[test]
fn of_a_damaged_file_it_shows_what_is_there_says_what_is_missing_and_fails() {
    let fixture = Fixture::new();
    fixture.damage();
    for line in [
        "replay run.mcap --csv",
        "replay run.mcap --json",
        "replay run.mcap",
    ] {
        let said = fixture.run(line);
        assert_eq!(said.code, Some(1), "{line}: {said:?}");
        assert!(
            said.err.contains("damaged and was left out"),
            "{line}: {said:?}"
        );
    }
    let mut replay = Terminal::run(fixture.command("replay run.mcap"));
    replay.expect("quit");
    replay.press("q");
    replay.expect("damaged and was left out");
    assert_eq!(replay.end().0, Some(1));
}

#[test]
fn what_cannot_be_replayed_is_one_line_and_exit_code_2() {
    let fixture = Fixture::new();
    fs::write(fixture.0.path().join("notes.txt"), "a,b\n1,2\n").unwrap();
    for (line, why) in [
        ("replay missing.mcap", "missing.mcap"),
        ("replay notes.txt", "no columns of a known export"),
        ("replay run.mcap --from 11", "the session lasts 9.997 s"),
        ("replay run.mcap --speed 0", "0.1 to 100"),
        ("replay run.mcap --csv --json", "--json"),
    ] {
        let said = fixture.run(line);
        assert_eq!(said.code, Some(2), "{line}: {said:?}");
        assert_eq!(said.err.lines().count(), 1, "{line}: {said:?}");
        assert!(said.err.contains(why), "{line}: {said:?}");
    }
}
