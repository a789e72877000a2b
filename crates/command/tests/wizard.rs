//! `motorlink wizard`, answered as a person does. A motor without power is unplugged.

use rustix::process::Signal;

use crate::{
    bench::{Bench, signal},
    terminal::Terminal,
};

const PLUG_IN: &str = "Press Enter then, or type done if no motor is left: ";
const NEW_ID: &str = "n: leave it as it is): ";
const CONNECT_ALL: &str = "connect all motors, and switch the power on. Press Enter then: ";
const TURN: &str = "keep clear of its wheels. [y/N] ";
const WHICH: &str = "-: leave it out): ";
const DIRECTION: &str = "(f or b): ";

#[test]
fn two_motors_get_their_ids_one_after_the_other_and_each_wheel_its_name() {
    let mut bench = Bench::new(&["--ids", "5,6"]);
    let mut wizard = Terminal::run(bench.command("wizard --count 2 --first 3"));
    wizard.answer(PLUG_IN, "");
    wizard.expect("several motors answer (0x05, 0x06)");
    bench.motors.command("power 6 off");
    wizard.answer(PLUG_IN, "");
    wizard.expect("The only motor on the bus has ID 0x05.");
    wizard.answer(NEW_ID, "200");
    wizard.answer(NEW_ID, "");
    wizard.expect("Motor 1 has ID 0x03, verified.");
    bench.motors.command("power 3 off");
    bench.motors.command("power 6 on");
    wizard.answer(PLUG_IN, "");
    wizard.answer(NEW_ID, "3");
    wizard.expect("Motor 1 has ID 0x03 already.");
    wizard.answer(NEW_ID, "1");
    wizard.expect("Motor 2 has ID 0x01, verified.");

    wizard.answer(CONNECT_ALL, "");
    wizard.expect("No reply from 0x03");
    bench.motors.command("power 3 on");
    wizard.answer("Press Enter to scan again", "");
    wizard.expect("Found 0x01, 0x03.");
    wizard.answer(TURN, "y");
    // It turns, and stands when the question comes.
    bench.until(|rpm| rpm > 15.0);
    wizard.expect("Motor 0x01 stands, confirmed.");
    assert!(bench.stands());
    wizard.answer(WHICH, "front right");
    wizard.answer(DIRECTION, "b");
    wizard.answer(WHICH, "front right");
    wizard.expect("That is the wheel of motor 0x01.");
    wizard.answer(WHICH, "front left");
    wizard.answer(DIRECTION, "f");
    wizard.expect("motorlink --id -1,3 drive velocity 60");
    let (code, shown) = wizard.end();
    assert_eq!(code, Some(0), "{shown}");
    assert!(bench.stands());
}

#[test]
fn virtual_motors_rehearse_it_and_no_wheel_turns_unless_a_person_agrees() {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_motorlink"));
    command.args(["--virtual=2", "wizard"]);
    let mut wizard = Terminal::run(command);
    for id in ["0x01", "0x02"] {
        wizard.answer(PLUG_IN, "");
        wizard.answer(NEW_ID, "");
        wizard.expect(&format!("has ID {id}, verified."));
    }
    wizard.answer(CONNECT_ALL, "");
    wizard.answer(TURN, "");
    let (code, shown) = wizard.end();
    assert_eq!(code, Some(0), "{shown}");
    assert!(
        shown.contains("motorlink --id 1,2 drive velocity 60"),
        "{shown}"
    );
    assert!(!shown.contains("rpm"), "{shown}");
}

#[test]
fn a_motor_that_stays_away_is_named_and_fails_it() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    bench.motors.command("power 2 off");
    let mut wizard = Terminal::run(bench.command("wizard"));
    wizard.answer(PLUG_IN, "");
    wizard.answer(NEW_ID, "4");
    wizard.answer(PLUG_IN, "done");
    bench.motors.command("power 4 off");
    bench.motors.command("power 2 on");
    wizard.answer(CONNECT_ALL, "");
    wizard.expect("No reply from 0x04");
    wizard.expect("0x02 got no ID here.");
    wizard.answer("go on with those that answer: ", "done");
    wizard.answer(TURN, "n");
    wizard.expect("0x04 did not answer");
    assert_eq!(wizard.end().0, Some(1));
}

#[test]
fn an_interruption_at_a_question_and_in_a_turn_leaves_nothing_driven() {
    let mut bench = Bench::new(&[]);
    let mut wizard = Terminal::run(bench.command("wizard --count 3"));
    wizard.answer(PLUG_IN, "");
    wizard.answer(NEW_ID, "");
    wizard.expect(PLUG_IN);
    signal(&wizard.child, Signal::INT);
    let (code, shown) = wizard.end();
    assert_eq!(code, Some(1), "{shown}");
    assert!(
        shown.contains("To continue: motorlink wizard --first 2 --count 2"),
        "{shown}"
    );

    let mut wizard = Terminal::run(bench.command("wizard --count 0"));
    wizard.answer(CONNECT_ALL, "");
    wizard.answer(TURN, "y");
    bench.until(|rpm| rpm > 15.0);
    signal(&wizard.child, Signal::INT);
    let (code, shown) = wizard.end();
    assert_eq!(code, Some(1), "{shown}");
    assert!(shown.contains("Motor 0x01 stands, confirmed."), "{shown}");
    assert!(bench.stands());
}

#[test]
fn without_a_terminal_and_with_motors_of_its_own_it_is_refused_in_one_line() {
    let bench = Bench::new(&[]);
    let said = bench.run("wizard");
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("use set-id in scripts"), "{said:?}");
    assert_eq!(said.err.lines().count(), 1, "{said:?}");
    let (code, shown) = Terminal::run(bench.command("--id 1 wizard")).end();
    assert_eq!(code, Some(2));
    assert!(shown.contains("leave out --id"), "{shown}");
}
