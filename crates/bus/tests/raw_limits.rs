//! Limits hold for what a person writes byte by byte, and for what every motor hears.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{
    Bench, ID, amps, drive_frame, every, id, is_set_id, ms, raw, rpm, scan_report, status, two,
};
use motorlink_bus::{
    Activity, Command, Event, Limits, Refusal, Repeat, StopReason, WithdrawReason,
};
use motorlink_protocol::{Frame, Mode, MotorId, Request};
use motorlink_simulator::WorldConfig;

/// First bytes that no motor has for itself: all may obey what stands behind them.
const EVERYONE: [u8; 3] = [0xC8, 0x00, 0xFF];

fn limited(bench: &mut Bench, rpm: u16) {
    let limits = Limits::new(rpm, 2_700, 75).unwrap();
    bench.command(Command::SetLimits(limits)).unwrap();
}

fn value(first: u8, value: i32) -> Command {
    let [.., high, low] = value.to_be_bytes();
    let frame = Frame::with_crc([first, 0x64, high, low, 0, 0, 0, 0, 0]);
    raw(frame, every(0, 20))
}

fn switch(motor: MotorId, mode: Mode) -> Command {
    raw(
        Request::SwitchMode { id: motor, mode }.frame(),
        every(5, 20),
    )
}

fn withdrawn(bench: &Bench) -> Vec<(MotorId, WithdrawReason)> {
    let withdrawn = bench.events.iter().filter_map(|(_, event)| match event {
        Event::Withdrawn { id, reason } => Some((*id, *reason)),
        _ => None,
    });
    withdrawn.collect()
}

const ABOVE: [i32; 9] = [21, -21, 330, 331, -331, 5_000, 32_767, -32_767, -32_768];

#[test]
fn a_raw_speed_above_the_limit_is_refused_however_large_it_is() {
    let refused = Err(Refusal::AboveSpeedLimit(20));
    for above in ABOVE {
        let mut bench = Bench::one_motor();
        limited(&mut bench, 20);
        assert_eq!(bench.command(value(1, above)), refused, "{above}");
        bench.run(ms(200));
        assert!(bench.true_rpm().abs() < 1.0);
        // Of one that has not answered, the loop is not known.
        assert_eq!(bench.command(value(9, above)), refused, "{above} unknown");
    }
    for within in [20, -20] {
        let mut bench = Bench::one_motor();
        limited(&mut bench, 20);
        assert_eq!(bench.command(value(1, within)), Ok(()), "{within}");
    }
}

#[test]
fn a_raw_value_in_a_loop_without_a_speed_limit_is_sent() {
    for mode in [Mode::Current, Mode::Position] {
        let mut bench = Bench::one_motor();
        limited(&mut bench, 20);
        bench.switch(mode);
        assert_eq!(bench.command(value(1, 5_000)), Ok(()), "{mode}");
    }
}

#[test]
fn a_raw_value_is_a_speed_while_the_loop_is_in_the_air() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Current);
    bench.command(switch(ID, Mode::Velocity)).unwrap();
    bench.run_until(ms(300), |bench| bench.bus.raw().unwrap().sent == 5);
    assert_eq!(
        bench.command(value(1, 5_000)),
        Err(Refusal::AboveSpeedLimit(330))
    );
}

#[test]
fn a_limit_that_is_lowered_ends_raw_frames_above_it() {
    let mut bench = Bench::one_motor();
    bench.command(value(1, 100)).unwrap();
    bench.run(ms(500));
    bench.forget_the_past();
    limited(&mut bench, 95);
    bench.run(ms(500));
    assert!(!status(&bench).running);
    let drives = |sent: &bench::Sent| sent.drive_of(ID).is_some_and(|drive| !drive.brakes());
    assert!(!bench.sent.iter().any(drives));
    assert!(bench.true_rpm().abs() < 1.0, "{}", bench.true_rpm());
}

#[test]
fn what_every_motor_hears_is_limited_by_each_of_them() {
    for first in EVERYONE {
        for above in ABOVE {
            let mut bench = two();
            limited(&mut bench, 20);
            let refused = Err(Refusal::AboveSpeedLimit(20));
            assert_eq!(bench.command(value(first, above)), refused, "{first:02X}");
        }
        let mut nobody_known = Bench::new(WorldConfig::default());
        let refused = Err(Refusal::AboveSpeedLimit(330));
        assert_eq!(nobody_known.command(value(first, 331)), refused);

        let mut bench = two();
        assert_eq!(bench.command(value(first, 20)), Ok(()));

        let mut hot = two();
        limited(&mut hot, 330);
        hot.world.motor_mut(id(2)).unwrap().set_temperature_c(78.0);
        hot.run(ms(300));
        let refused = hot.command(value(first, 20));
        assert!(
            matches!(refused, Err(Refusal::TooHot { id: hot, .. }) if hot == id(2)),
            "{refused:?}"
        );

        let mut driven = two();
        driven.drive(rpm(50)).unwrap();
        driven.run(ms(100));
        assert_eq!(driven.command(value(first, 20)), Err(Refusal::Driven(ID)));
    }
}

/// One number would be a speed to one of them and a torque to the other.
#[test]
fn what_every_motor_hears_needs_one_loop_and_stays_below_the_speed_limit_in_any() {
    for first in EVERYONE {
        let mut bench = two();
        bench.switch(Mode::Current);
        assert_eq!(
            bench.command(value(first, 10)),
            Err(Refusal::OtherLoop {
                id: id(2),
                asked: Mode::Current,
                reported: Mode::Velocity
            })
        );
        let mode = Mode::Current;
        bench
            .command(Command::SwitchMode { id: id(2), mode })
            .unwrap();
        bench.run(ms(400));
        // A third motor that nobody watches may read it as a speed.
        for beyond in [331, 1_000, -25_000] {
            let refused = bench.command(value(first, beyond));
            assert_eq!(refused, Err(Refusal::AboveSpeedLimit(330)), "{beyond}");
        }
        assert_eq!(bench.command(value(first, 330)), Ok(()));
    }
}

#[test]
fn a_switch_to_the_position_loop_that_every_motor_hears_needs_every_speed() {
    for first in EVERYONE {
        let frame = Frame::new([first, 0xA0, 0, 0, 0, 0, 0, 0, 0, 3]);
        let mut bench = two();
        assert_eq!(bench.command(raw(frame, Repeat::Once)), Ok(()));
        let mut bench = two();
        bench.world.motor_mut(id(2)).unwrap().power(false);
        bench.run(ms(600));
        assert_eq!(
            bench.command(raw(frame, Repeat::Once)),
            Err(Refusal::SpeedUnknown(id(2)))
        );
    }
}

#[test]
fn motors_that_hear_one_frame_are_stopped_together_when_one_of_them_must_be() {
    for first in EVERYONE {
        for reason in ["silent", "fault", "limit"] {
            let mut bench = two();
            bench.command(value(first, 100)).unwrap();
            bench.run(ms(400));
            assert!(status(&bench).running, "{first:02X} {reason}");
            for motor in [ID, id(2)] {
                assert_eq!(bench.status(motor).activity, Activity::DrivenRaw);
            }
            bench.forget_the_past();
            let second = bench.world.motor_mut(id(2)).unwrap();
            match reason {
                "silent" => second.mute(true),
                "fault" => second.set_temperature_c(90.0),
                _ => second.set_temperature_c(78.0),
            }
            bench.run(ms(700));
            assert!(!status(&bench).running, "{first:02X} {reason}");
            let withdrawn = withdrawn(&bench);
            assert_eq!(withdrawn[0].0, id(2), "{withdrawn:?}");
            assert!(bench.happened(|event| *event == Event::StopBegan(StopReason::OneMotor)));
            for motor in [ID, id(2)] {
                let brakes = |sent: &bench::Sent| {
                    sent.frame
                        .bytes()
                        .starts_with(&[motor.get(), 0x64, 0, 0, 0, 0, 0, 0xFF])
                };
                assert!(bench.sent.iter().any(brakes), "{motor} {reason}");
            }
        }
    }
}

/// Even at the shortest interval, or nothing would tell when to stop.
#[test]
fn motors_that_hear_one_frame_are_asked_for_telemetry_meanwhile() {
    for first in EVERYONE {
        let mut bench = two();
        let Command::SendRaw { frame, .. } = value(first, 100) else {
            panic!("no raw frame");
        };
        bench.command(raw(frame, every(0, 2))).unwrap();
        bench.run(ms(1_000));
        for motor in [ID, id(2)] {
            let asked = |sent: &&bench::Sent| sent.frame == Request::Query { id: motor }.frame();
            let times = bench.sent.iter().filter(asked).count();
            assert!((4..=20).contains(&times), "{first:02X} {motor}: {times}");
        }
        assert!(status(&bench).running);
    }
}

#[test]
fn an_id_that_no_scan_would_find_is_never_set() {
    for new in [0x00, 0xFF, 0xC8] {
        for last in [0x00, 0x01] {
            let mut bench = Bench::new(WorldConfig::default());
            assert_eq!(scan_report(&mut bench).found, [ID]);
            let frame = Frame::new([0xAA, 0x55, 0x53, new, 0, 0, 0, 0, 0, last]);
            let refused = bench.command(raw(frame, every(5, 20)));
            assert_eq!(refused, Err(Refusal::NotAssignable(new)));
            bench.run(ms(500));
            assert!(!bench.sent.iter().any(is_set_id));
            // The proof is not used up by it.
            let frame = Request::SetId { id: bench::to(5) }.frame();
            assert_eq!(bench.command(raw(frame, every(5, 20))), Ok(()));
        }
    }
}

#[test]
fn a_frame_for_one_motor_leaves_the_others_alone() {
    let mut bench = two();
    bench
        .command(raw(drive_frame(ID, rpm(100)), every(0, 20)))
        .unwrap();
    bench.run(ms(300));
    bench.world.motor_mut(id(2)).unwrap().mute(true);
    bench.run(ms(700));
    assert!(status(&bench).running);
    assert_eq!(bench.status(id(2)).activity, Activity::Idle);
}

#[test]
fn a_raw_frame_does_not_reverse_a_current_that_may_be_followed() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Current);
    let frame = |value| drive_frame(ID, amps(value));
    bench.command(raw(frame(1.0), Repeat::Once)).unwrap();
    bench.run(ms(50));
    let reversed = bench.command(raw(frame(-1.0), Repeat::Once));
    assert_eq!(reversed, Err(Refusal::ReversesTorque(ID)));
    bench.command(raw(frame(0.0), Repeat::Once)).unwrap();
    bench.run(ms(50));
    bench.command(raw(frame(-1.0), Repeat::Once)).unwrap();
}
