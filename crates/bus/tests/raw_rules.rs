//! What a person writes byte by byte is under the rules of any driving: the ways round them.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{Bench, ID, amps, drive_frame, every, id, ms, raw, rpm, status};
use motorlink_bus::{Command, Event, Refusal, Repeat, StopReason};
use motorlink_protocol::{Drive, Frame, Mode, Request};
use motorlink_simulator::{Echo, WireFaults, WorldConfig};

#[test]
fn the_highest_current_of_all_asks_too() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Current);
    let f = Frame::with_crc([1, 0x64, 0x80, 0x00, 0, 0, 0, 0, 0]);
    let r = bench.command(raw(f, every(0, 20)));
    bench.run(ms(50));
    assert!(matches!(r, Err(Refusal::NeedsConsent(_))), "{r:?}");
}

#[test]
fn a_lookalike_drive_frame_asks_too() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Current);
    let f = Frame::with_crc([1, 0x64, 0x7F, 0xFF, 0, 0, 0, 0, 1]);
    let r = bench.command(raw(f, Repeat::Once));
    assert!(matches!(r, Err(Refusal::NeedsConsent(_))), "{r:?}");
}

#[test]
fn a_lookalike_switch_to_position_is_checked_and_stopped_as_one() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1000));
    bench.command(Command::Stop(ID)).unwrap();
    bench.run(ms(20));
    let f: Frame = "01 A0 00 00 00 00 00 00 01 03".parse().unwrap();
    let mut bench = Bench::one_motor();
    bench.command(raw(f, every(5, 20))).unwrap();
    bench.run_until(ms(300), |bench| bench.bus.raw().unwrap().sent == 5);
    bench.forget_the_past();
    bench.command(Command::Stop(ID)).unwrap();
    bench.run(ms(10));
    assert!(bench.sent[0].is_switch(), "{:?}", bench.sent[0]);
}

#[test]
fn torque_reversal_of_raw_passes_zero() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Current);
    bench
        .command(raw(drive_frame(ID, amps(2.0)), every(0, 20)))
        .unwrap();
    bench.run(ms(100));
    bench.forget_the_past();
    let r = bench.command(raw(drive_frame(ID, amps(-2.0)), every(0, 20)));
    bench.run(ms(60));
    let v: Vec<_> = bench
        .sent
        .iter()
        .filter_map(|s| s.drive_of(ID))
        .map(Drive::signed)
        .collect();
    assert!(r.is_err() || v[0] == 0, "{r:?} {v:?}");
}

#[test]
fn a_query_does_not_let_a_wheel_coast() {
    let mut bench = Bench::one_motor();
    bench
        .command(raw(drive_frame(ID, rpm(100)), every(0, 20)))
        .unwrap();
    bench.run(ms(1000));
    bench.forget_the_past();
    let r = bench.command(raw(Request::Query { id: ID }.frame(), Repeat::Once));
    bench.run(ms(800));
    assert!(
        r.is_err() || bench.true_rpm().abs() < 1.0,
        "{r:?}, still {} rpm, {:?}, stop began {}",
        bench.true_rpm(),
        bench.activity(),
        bench.happened(|e| matches!(e, Event::StopBegan(_)))
    );
}

#[test]
fn raw_frames_begun_with_unknown_loop_do_not_reach_another_loop() {
    let mut bench = Bench::one_motor();
    bench
        .command(raw(
            Request::SwitchMode {
                id: ID,
                mode: Mode::Current,
            }
            .frame(),
            every(5, 20),
        ))
        .unwrap();
    bench.run_until(ms(300), |bench| bench.bus.raw().unwrap().sent == 5);
    bench
        .command(raw(drive_frame(ID, amps(0.05)), every(0, 20)))
        .unwrap();
    bench.run(ms(300));
    bench.world.motor_mut(ID).unwrap().power(false);
    bench.run(ms(100));
    bench.world.motor_mut(ID).unwrap().power(true);
    bench.run(ms(2000));
    assert!(
        !status(&bench).running,
        "still running, {} rpm, {:?}",
        bench.true_rpm(),
        bench.world.motor(ID).unwrap().mode()
    );
}

#[test]
fn raw_frames_to_a_motor_that_never_answered_do_not_start_it_when_it_gets_power() {
    let mut bench = Bench::new(WorldConfig::default());
    bench.world.motor_mut(ID).unwrap().power(false);
    bench
        .command(raw(drive_frame(ID, rpm(100)), every(0, 20)))
        .unwrap();
    bench.run(ms(60_000));
    bench.world.motor_mut(ID).unwrap().power(true);
    bench.run(ms(1000));
    assert!(
        bench.true_rpm().abs() < 1.0,
        "a minute after the click: {} rpm",
        bench.true_rpm()
    );
}

#[test]
fn an_echo_of_a_raw_frame_is_no_telemetry() {
    let mut bench = Bench::watching(
        WorldConfig {
            faults: WireFaults {
                echo: Echo::Whole,
                ..WireFaults::default()
            },
            ..WorldConfig::default()
        },
        &[ID],
    );
    let pasted = Frame::with_crc([1, 2, 0, 0, 0, 200, 0x20, 0xF6, 0x00]);
    bench.command(raw(pasted, Repeat::Once)).unwrap();
    bench.run(ms(40));
    let lie = bench
        .events
        .iter()
        .find(|(_, e)| matches!(e, Event::Telemetry(s) if s.reply.speed.magnitude() == 200));
    assert!(lie.is_none(), "{lie:?} {:?}", status(&bench).last);
}

#[test]
fn a_wheel_that_raw_frames_set_in_motion_stands_before_a_scan_and_after_stop_raw() {
    for cmd in [Command::StopRaw, Command::FullScan] {
        let mut bench = Bench::one_motor();
        bench
            .command(raw(drive_frame(ID, rpm(100)), every(50, 20)))
            .unwrap();
        bench.run(ms(1_050));
        bench.command(cmd).unwrap();
        bench.run(ms(500));
        assert!(
            bench.true_rpm().abs() < 1.0,
            "{cmd:?}: {} rpm",
            bench.true_rpm()
        );
    }
}

#[test]
fn a_refusal_changes_nothing() {
    let mut bench = Bench::one_motor();
    let r = bench.command(raw(drive_frame(id(9), amps(7.0)), Repeat::Once));
    assert!(r.is_err());
    assert_eq!(bench.bus.motors(bench.now).count(), 1);
}

#[test]
fn a_motor_that_is_not_there_can_be_forgotten_after_a_raw_frame() {
    let mut bench = Bench::one_motor();
    bench
        .command(raw(drive_frame(id(9), rpm(10)), Repeat::Once))
        .unwrap();
    bench.run(ms(3000));
    bench
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    bench.run(ms(4000));
    assert_eq!(bench.command(Command::Forget(id(9))), Ok(()));
}

#[test]
fn a_raw_frame_that_nobody_answers_says_so() {
    let mut bench = Bench::one_motor();
    bench
        .command(raw(
            Request::SwitchMode {
                id: ID,
                mode: Mode::Velocity,
            }
            .frame(),
            Repeat::Once,
        ))
        .unwrap();
    bench.run(ms(100));
    assert!(status(&bench).last.is_some(), "{:?}", status(&bench));
}

#[test]
fn an_answer_belongs_to_the_frame_that_it_answers() {
    let mut bench = Bench::one_motor();
    bench.run(ms(10));
    bench
        .command(raw(Request::Query { id: ID }.frame(), Repeat::Once))
        .unwrap();
    bench.run(ms(1));
    bench
        .command(raw(Request::Query { id: id(9) }.frame(), Repeat::Once))
        .unwrap();
    bench.run(ms(60));
    let s = status(&bench);
    assert_eq!((s.sent, s.answered), (1, 0), "{s:?}");
}

#[test]
fn a_drive_frame_to_everyone_waits_until_nothing_is_driven() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(50)).unwrap();
    bench.run(ms(100));
    let r = bench.command(raw(
        Frame::with_crc([0xC8, 0x64, 0, 100, 0, 0, 0, 0, 0]),
        every(0, 20),
    ));
    assert!(r.is_err(), "{r:?}");
}

/// An ID query takes the line for three drive periods.
#[test]
fn frames_that_all_may_answer_wait_until_nothing_is_driven() {
    let query = raw(Request::IdQuery.frame(), every(0, 2));
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    assert_eq!(bench.command(query), Err(Refusal::Driven(ID)));
    bench.command(Command::Stop(ID)).unwrap();
    assert_eq!(bench.command(query), Err(Refusal::Stopping(ID)));
    bench.run(ms(1_000));
    bench.command(query).unwrap();
    bench.run(ms(200));
    bench.command(Command::Stop(ID)).unwrap();
    assert!(!status(&bench).running, "every stop ends them");
}
