//! Changing loops: five frames, confirmed by replies, and refused where the wheel would move by it.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod bench;

use bench::{Bench, ID, amps, degrees, id, longest_gap, ms, rpm};
use motorlink_bus::{Activity, Command, Event, Refusal};
use motorlink_protocol::{Drive, Mode, Setpoint};

#[test]
fn a_switch_is_sent_five_times_and_confirmed_by_replies() {
    let mut bench = Bench::one_motor();
    bench
        .command(Command::SwitchMode {
            id: ID,
            mode: Mode::Current,
        })
        .unwrap();
    bench.run(ms(400));
    let switches: Vec<_> = bench
        .sent
        .iter()
        .filter(|s| s.is_switch())
        .map(|s| s.at)
        .collect();
    assert_eq!(switches.len(), 5);
    for pair in switches.windows(2) {
        let gap = pair[1].since(pair[0]);
        assert!(gap >= ms(19) && gap <= ms(24), "{gap:?}");
    }
    assert!(bench.happened(|e| *e
        == Event::ModeSwitched {
            id: ID,
            mode: Mode::Current
        }));
    assert_eq!(bench.activity(), Activity::Idle);
}

/// Zero means 0 rpm before the switch and 0 A after it; the old setpoint would mean something else.
#[test]
fn a_driven_motor_is_driven_on_at_zero_while_it_is_switched() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_000));
    bench.forget_the_past();
    bench
        .command(Command::SwitchMode {
            id: ID,
            mode: Mode::Current,
        })
        .unwrap();
    bench.run(ms(500));
    let frames = bench.drive_times(ID);
    assert!(longest_gap(&frames) <= ms(25), "{:?}", longest_gap(&frames));
    let values = bench
        .sent
        .iter()
        .filter_map(|s| s.drive_of(ID))
        .map(Drive::signed);
    assert!(values.into_iter().all(|value| value == 0));
    assert!(bench.happened(|e| *e
        == Event::ModeSwitched {
            id: ID,
            mode: Mode::Current
        }));
}

#[test]
fn the_position_loop_is_refused_to_a_turning_wheel_and_to_an_unknown_speed() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_000));
    let to_position = |id| Command::SwitchMode {
        id,
        mode: Mode::Position,
    };
    assert!(matches!(
        bench.command(to_position(ID)),
        Err(Refusal::TooFast(_))
    ));
    assert_eq!(
        bench.command(to_position(id(9))),
        Err(Refusal::SpeedUnknown(id(9)))
    );
    bench.run(ms(100));
    assert!(!bench.sent.iter().any(bench::Sent::is_switch));
}

/// The motor silently refuses the position loop above 10 rpm; a switch that is not confirmed is said.
#[test]
fn a_switch_that_the_motor_refuses_is_reported() {
    let mut bench = Bench::one_motor();
    bench.world.motor_mut(ID).unwrap().mute(true);
    bench
        .command(Command::SwitchMode {
            id: ID,
            mode: Mode::Position,
        })
        .unwrap();
    bench.run(ms(1_000));
    assert!(bench.happened(|e| matches!(
        e,
        Event::ModeSwitchFailed {
            asked: Mode::Position,
            ..
        }
    )));
}

#[test]
fn the_position_loop_reaches_its_target_and_holds_where_it_is_told_to() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Position);
    bench.drive(degrees(90.0)).unwrap();
    bench.run(ms(3_000));
    let angle = |bench: &Bench| bench.status(ID).position.unwrap().1.degrees();
    assert!((angle(&bench) - 90.0).abs() < 2.0, "{}", angle(&bench));
    bench.drive(degrees(200.0)).unwrap();
    bench.run(ms(60));
    bench.command(Command::Hold(ID)).unwrap();
    bench.run(ms(5)); // the next reply says where it is
    let Activity::Driven {
        setpoint: Setpoint::Position(held),
    } = bench.activity()
    else {
        panic!("{:?}", bench.activity())
    };
    bench.run(ms(2_000));
    assert!((angle(&bench) - held.degrees()).abs() < 3.0);
}

/// The drive that was given during the switch is carried out behind its fifth frame, 100 ms later.
#[test]
fn a_motor_that_loses_power_during_a_switch_is_not_started_behind_it() {
    for cut_ms in (0..120).step_by(3) {
        let mut bench = Bench::one_motor();
        bench.switch(Mode::Current);
        // Driven, it reports its loop with every frame, long before the fifth switch.
        bench.drive(amps(0.0)).unwrap();
        bench.run(ms(200));
        bench.forget_the_past();
        let switch = Command::SwitchMode {
            id: ID,
            mode: Mode::Velocity,
        };
        bench.command(switch).unwrap();
        bench.drive(rpm(100)).unwrap();
        bench.run(ms(cut_ms));
        bench.world.motor_mut(ID).unwrap().power(false);
        let cut = bench.now;
        bench.run(ms(1_500));
        let last = bench.drive_times(ID).into_iter().filter(|at| {
            let moves = |sent: &&bench::Sent| {
                sent.at == *at && sent.drive_of(ID).is_some_and(|drive| drive.signed() != 0)
            };
            bench.sent.iter().any(|sent| moves(&sent))
        });
        // As if it had been driven all along.
        let late = last.max().map_or(ms(0), |at| at.since(cut));
        assert!(
            late <= ms(250),
            "driven {late:?} after the cut at {cut_ms} ms"
        );
    }
}
