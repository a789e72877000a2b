//! Raw frames that every motor hears: the limits of each of them hold, and they are stopped together.

use crate::fixture;
use crate::fixture::raw_commands::{ABOVE, limited, value, withdrawn};
use crate::fixture::{Fixture, ID, every, id, ms, raw, rpm, status, two};
use motorlink_bus::{Activity, Command, Event, Refusal, Repeat, StopReason};
use motorlink_protocol::{Frame, Mode, Request};
use motorlink_simulator::WorldConfig;

/// First bytes that no motor has for itself: all may obey what stands behind them.
const EVERYONE: [u8; 3] = [0xC8, 0x00, 0xFF];

#[test]
fn what_every_motor_hears_is_limited_by_each_of_them() {
    for first in EVERYONE {
        for above in ABOVE {
            let mut fixture = two();
            limited(&mut fixture, 20);
            let refused = Err(Refusal::AboveSpeedLimit(20));
            assert_eq!(fixture.command(value(first, above)), refused, "{first:02X}");
        }
        let mut nobody_known = Fixture::new(WorldConfig::default());
        let refused = Err(Refusal::AboveSpeedLimit(330));
        assert_eq!(nobody_known.command(value(first, 331)), refused);

        let mut fixture = two();
        assert_eq!(fixture.command(value(first, 20)), Ok(()));

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
        let mut fixture = two();
        fixture.switch(Mode::Current);
        assert_eq!(
            fixture.command(value(first, 10)),
            Err(Refusal::OtherLoop {
                id: id(2),
                asked: Mode::Current,
                reported: Mode::Velocity
            })
        );
        let mode = Mode::Current;
        fixture
            .command(Command::SwitchMode { id: id(2), mode })
            .unwrap();
        fixture.run(ms(400));
        // A third motor that is not watched may read it as a speed.
        for beyond in [331, 1_000, -25_000] {
            let refused = fixture.command(value(first, beyond));
            assert_eq!(refused, Err(Refusal::AboveSpeedLimit(330)), "{beyond}");
        }
        assert_eq!(fixture.command(value(first, 330)), Ok(()));
    }
}

#[test]
fn a_switch_to_the_position_loop_that_every_motor_hears_needs_every_speed() {
    for first in EVERYONE {
        let frame = Frame::new([first, 0xA0, 0, 0, 0, 0, 0, 0, 0, 3]);
        let mut fixture = two();
        assert_eq!(fixture.command(raw(frame, Repeat::Once)), Ok(()));
        let mut fixture = two();
        fixture.world.motor_mut(id(2)).unwrap().power(false);
        fixture.run(ms(600));
        assert_eq!(
            fixture.command(raw(frame, Repeat::Once)),
            Err(Refusal::SpeedUnknown(id(2)))
        );
    }
}

#[test]
fn motors_that_hear_one_frame_are_stopped_together_when_one_of_them_must_be() {
    for first in EVERYONE {
        for reason in ["silent", "fault", "limit"] {
            let mut fixture = two();
            fixture.command(value(first, 100)).unwrap();
            fixture.run(ms(400));
            assert!(status(&fixture).running, "{first:02X} {reason}");
            for motor in [ID, id(2)] {
                assert_eq!(fixture.status(motor).activity, Activity::DrivenRaw);
            }
            fixture.forget_the_past();
            let second = fixture.world.motor_mut(id(2)).unwrap();
            match reason {
                "silent" => second.mute(true),
                "fault" => second.set_temperature_c(90.0),
                _ => second.set_temperature_c(78.0),
            }
            fixture.run(ms(700));
            assert!(!status(&fixture).running, "{first:02X} {reason}");
            let withdrawn = withdrawn(&fixture);
            assert_eq!(withdrawn[0].0, id(2), "{withdrawn:?}");
            assert!(fixture.happened(|event| *event == Event::StopBegan(StopReason::OneMotor)));
            for motor in [ID, id(2)] {
                let brakes = |sent: &fixture::Sent| {
                    sent.frame
                        .bytes()
                        .starts_with(&[motor.get(), 0x64, 0, 0, 0, 0, 0, 0xFF])
                };
                assert!(fixture.sent.iter().any(brakes), "{motor} {reason}");
            }
        }
    }
}

/// Even at the shortest interval, or nothing would tell when to stop.
#[test]
fn motors_that_hear_one_frame_are_asked_for_telemetry_meanwhile() {
    for first in EVERYONE {
        let mut fixture = two();
        let Command::SendRaw { frame, .. } = value(first, 100) else {
            panic!("no raw frame");
        };
        fixture.command(raw(frame, every(0, 2))).unwrap();
        fixture.run(ms(1_000));
        for motor in [ID, id(2)] {
            let asked = |sent: &&fixture::Sent| sent.frame == Request::Query { id: motor }.frame();
            let times = fixture.sent.iter().filter(asked).count();
            assert!((4..=20).contains(&times), "{first:02X} {motor}: {times}");
        }
        assert!(status(&fixture).running);
    }
}

/// An ID query takes the line for three drive periods.
#[test]
fn raw_frames_that_all_may_answer_wait_until_nothing_is_driven() {
    let query = raw(Request::IdQuery.frame(), every(0, 2));
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    assert_eq!(fixture.command(query), Err(Refusal::Driven(ID)));
    fixture.command(Command::Stop(ID)).unwrap();
    assert_eq!(fixture.command(query), Err(Refusal::Stopping(ID)));
    fixture.run(ms(1_000));
    fixture.command(query).unwrap();
    fixture.run(ms(200));
    assert!(status(&fixture).running && status(&fixture).sent > 1);
    fixture.command(Command::Stop(ID)).unwrap();
    assert!(!status(&fixture).running, "every stop ends them");
}
