//! `motorlink control` on a terminal of its own.

use std::{thread::sleep, time::Duration};

use crate::{bench::Bench, terminal::Terminal};

#[test]
fn a_key_drives_for_as_long_as_it_is_held_and_q_leaves_a_motor_that_stands() {
    let mut bench = Bench::new(&[]);
    let mut terminal = Terminal::run(bench.command("control --rpm 100"));
    terminal.expect("hold a key to run");
    bench.until(|rpm| {
        terminal.press("f");
        rpm > 90.0
    });
    // Let go.
    bench.until(|rpm| rpm.abs() < 1.0);
    bench.until(|rpm| {
        terminal.press("b");
        rpm < -90.0
    });
    terminal.press("q");
    let (code, shown) = terminal.end();
    assert_eq!(code, Some(0));
    assert!(bench.stands());
    // The screen of before is back.
    assert!(shown.contains("\u{1b}[?1049l"), "{shown}");
}

/// No signal comes: the terminal is not that of a session.
#[test]
fn a_terminal_that_is_closed_stops_the_wheel_and_ends_the_program() {
    let mut bench = Bench::new(&[]);
    let mut terminal = Terminal::run(bench.command("control --latch"));
    terminal.expect("keys latch");
    terminal.press("f");
    bench.until(|rpm| rpm > 20.0);
    let status = terminal.hang_up(Duration::from_secs(5));
    let code = status.expect("it still runs").code();
    assert_eq!(code, Some(1));
    assert!(bench.stands());
}

#[test]
fn another_loop_stops_the_wheel_first_and_drives_only_while_a_key_is_held() {
    let mut bench = Bench::new(&[]);
    let mut terminal = Terminal::run(bench.command("control --rpm 60 --amps 0.4"));
    terminal.expect("±60");
    bench.until(|rpm| {
        terminal.press("f");
        rpm > 50.0
    });
    // The choice starts nothing.
    terminal.press("c");
    terminal.expect("±0.40");
    bench.until(|rpm| rpm.abs() < 1.0);
    assert!(state(&mut bench).contains("mode=velocity"));
    // The current is constant, so a free wheel turns faster and faster.
    bench.until(|rpm| {
        terminal.press("b");
        rpm < -80.0
    });
    assert!(state(&mut bench).contains("mode=current"));
    bench.until(|rpm| rpm.abs() < 1.0);

    terminal.press("p");
    terminal.expect("position");
    until_at(&mut bench, 180.0, || terminal.press("3"));
    terminal.press("\u{1b}[C");
    until_at(&mut bench, 190.0, || ());
    terminal.press("q");
    let (code, shown) = terminal.end();
    assert_eq!(code, Some(0), "{shown}");
    assert!(state(&mut bench).contains("mode=velocity"), "stopped");
    assert!(bench.stands());
}

fn state(bench: &mut Bench) -> String {
    bench.motors.command("state 1")
}

/// Does this until the wheel is held at so many degrees.
fn until_at(bench: &mut Bench, degrees: f64, mut act: impl FnMut()) {
    let mut at = f64::NAN;
    for _ in 0..400 {
        act();
        let state = state(bench);
        let (_, rest) = state.split_once("angle=").unwrap();
        at = rest.split(' ').next().unwrap().parse().unwrap();
        if (at - degrees).abs() < 2.0 && state.contains("mode=position") {
            return;
        }
        sleep(Duration::from_millis(50));
    }
    panic!("at {at}, not at {degrees} degrees");
}

#[test]
fn a_current_above_6_1_a_needs_its_flag() {
    let bench = Bench::new(&[]);
    for (line, why) in [
        ("control --amps 7", "add --high-current"),
        ("control --amps 9", "-8 to 8 A"),
        ("control --mode torque", "torque"),
    ] {
        let said = bench.run(line);
        assert_eq!(said.code, Some(2), "{said:?}");
        assert!(said.err.contains(why), "{said:?}");
    }
}
