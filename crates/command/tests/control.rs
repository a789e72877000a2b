//! `motorlink control` on a terminal of its own.

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
