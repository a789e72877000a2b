//! Start in any loop: the wheel stands first, the loop is switched and confirmed, and only then is it driven.

use std::time::Duration;

use motorlink_bus::{Activity, BusSettings, Command, Consent, Event, Limits, Refusal, StopReason};
use motorlink_protocol::{Instant, Mode, Setpoint, family::Model};

use crate::fixture::driven_models::{on, setpoint};
use crate::fixture::{Fixture, ID, amps, degrees, ms, rpm, scan_report, two};

fn drive(setpoint: Setpoint) -> Command {
    Command::Drive {
        id: ID,
        setpoint,
        consent: Consent::None,
    }
}

fn turning() -> Fixture {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    fixture
}

fn at(fixture: &Fixture, wanted: impl Fn(&Event) -> bool) -> Option<Instant> {
    let found = fixture.events.iter().find(|(_, event)| wanted(event));
    found.map(|(at, _)| *at)
}

fn why_not(fixture: &Fixture) -> Option<Refusal> {
    fixture.events.iter().find_map(|(_, event)| match event {
        Event::NotStarted { refusal, .. } => Some(*refusal),
        _ => None,
    })
}

/// The drive frames that are neither zero nor brakes.
fn moving_frames(fixture: &Fixture) -> Vec<Instant> {
    let moves = |sent: &&crate::fixture::Sent| {
        let drive = sent.drive_of(ID);
        drive.is_some_and(|drive| drive.signed() != 0)
    };
    fixture.sent.iter().filter(moves).map(|it| it.at).collect()
}

#[test]
fn a_turning_wheel_is_stopped_then_switched_then_driven() {
    let mut fixture = turning();
    fixture.start(degrees(90.0)).unwrap();
    assert_eq!(fixture.status(ID).waiting, Some(degrees(90.0)));
    fixture.run(ms(3_000));
    let stands = |event: &Event| matches!(event, Event::StopEnded(report) if report.motors.iter().all(|it| it.confirmed));
    let stood = at(&fixture, stands).unwrap();
    let mode = Mode::Position;
    let switched = at(&fixture, |it| *it == Event::ModeSwitched { id: ID, mode }).unwrap();
    let driven = moving_frames(&fixture);
    assert!(stood < switched && switched <= driven[0], "{driven:?}");
    assert_eq!(
        fixture.activity(),
        Activity::Driven {
            setpoint: degrees(90.0)
        }
    );
    assert_eq!(fixture.status(ID).waiting, None);
    let (_, angle) = fixture.status(ID).position.unwrap();
    assert!((angle.degrees() - 90.0).abs() < 2.0, "{}", angle.degrees());
}

#[test]
fn a_wheel_that_stands_is_switched_without_a_stop() {
    let mut fixture = Fixture::one_motor();
    fixture.start(amps(0.5)).unwrap();
    fixture.run(ms(400));
    assert!(!fixture.happened(|event| matches!(event, Event::StopBegan(_))));
    assert_eq!(
        fixture.activity(),
        Activity::Driven {
            setpoint: amps(0.5)
        }
    );
}

#[test]
fn in_its_own_loop_a_motor_is_driven_at_once() {
    let mut fixture = turning();
    fixture.start(rpm(-50)).unwrap();
    assert_eq!(fixture.activity(), Activity::Driven { setpoint: rpm(-50) });
    assert!(!fixture.happened(|event| matches!(event, Event::StopBegan(_))));
}

/// The stops that a page may send, whatever of the start it has heard.
fn stops() -> [Command; 6] {
    [
        Command::Stop(ID),
        Command::StopAll(StopReason::Operator),
        Command::Hold(ID),
        drive(amps(0.0)),
        drive(rpm(0)),
        drive(Setpoint::Brake),
    ]
}

#[test]
fn any_stop_ends_a_start_that_waits() {
    for stop in stops() {
        let mut waited = 0;
        for late_ms in (0..600).step_by(7) {
            let mut fixture = turning();
            fixture.start(degrees(90.0)).unwrap();
            fixture.run(ms(late_ms));
            if fixture.status(ID).waiting.is_none() {
                break;
            }
            waited += 1;
            let stopped = fixture.now;
            fixture.command(stop).unwrap();
            fixture.run(ms(2_000));
            let moves = moving_frames(&fixture).into_iter().any(|at| at > stopped);
            assert!(!moves, "{stop:?} after {late_ms} ms");
            assert_eq!(
                fixture.activity(),
                Activity::Idle,
                "{stop:?} after {late_ms} ms"
            );
            assert!(fixture.true_rpm().abs() < 1.0);
        }
        assert!(waited > 20, "{stop:?}: the start waited {waited} times");
    }
}

/// Three presses before the page hears of the first: switch, start, stop. The page stops in the loop that it knows.
#[test]
fn zero_in_the_loop_that_a_motor_leaves_ends_what_waits_for_the_next() {
    for stop in [drive(rpm(0)), drive(Setpoint::Brake), Command::Hold(ID)] {
        for was_driven in [false, true] {
            let mut fixture = if was_driven {
                turning()
            } else {
                Fixture::one_motor()
            };
            let mode = Mode::Current;
            let switch = Command::SwitchMode { id: ID, mode };
            fixture.command(switch).unwrap();
            fixture.command(drive(amps(1.0))).unwrap();
            fixture.command(stop).unwrap();
            fixture.forget_the_past();
            fixture.run(ms(2_000));
            assert_eq!(moving_frames(&fixture), [], "{stop:?}, driven {was_driven}");
            assert_eq!(fixture.activity(), Activity::Idle);
        }
    }
}

/// The page asks nothing of a motor that it knows nothing of.
#[test]
fn a_motor_that_does_not_answer_is_not_started() {
    let mut fixture = Fixture::one_motor();
    fixture.world.motor_mut(ID).unwrap().mute(true);
    fixture.run(ms(1_000));
    let refused = fixture.start(degrees(90.0));
    assert_eq!(refused, Err(Refusal::NotAnswering(ID)));
}

#[test]
fn a_stop_that_is_not_confirmed_starts_nothing_and_says_so() {
    let mut fixture = turning();
    fixture.start(degrees(90.0)).unwrap();
    fixture.world.motor_mut(ID).unwrap().mute(true);
    fixture.run(ms(4_000));
    assert_eq!(why_not(&fixture), Some(Refusal::NotStopped(ID)));
    fixture.world.motor_mut(ID).unwrap().mute(false);
    fixture.run(ms(2_000));
    assert_eq!(moving_frames(&fixture), []);
    assert_eq!(fixture.activity(), Activity::Idle);
}

#[test]
fn what_forbids_the_drive_meanwhile_is_said() {
    let slow = BusSettings {
        limits: Limits::new(20, 2_700, 75).unwrap(),
        ..BusSettings::default()
    };
    let mut fixture = Fixture::one_motor();
    fixture.start(amps(0.5)).unwrap();
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    fixture.start(rpm(50)).unwrap();
    fixture.command(Command::Configure(slow)).unwrap();
    fixture.run(ms(3_000));
    assert_eq!(why_not(&fixture), Some(Refusal::AboveSpeedLimit(20)));

    let mut fixture = Fixture::one_motor();
    fixture.start(amps(0.5)).unwrap();
    fixture.world.motor_mut(ID).unwrap().set_temperature_c(95.0);
    fixture.run(ms(3_000));
    assert!(fixture.happened(|event| matches!(event, Event::Withdrawn { .. })));
    assert_eq!(moving_frames(&fixture), []);

    let mut fixture = turning();
    fixture.start(degrees(90.0)).unwrap();
    let _ = scan_report(&mut fixture);
    assert_eq!(moving_frames(&fixture), []);
}

#[test]
fn the_last_start_wins_and_a_drag_changes_what_waits() {
    let mut fixture = turning();
    fixture.start(degrees(90.0)).unwrap();
    fixture.run(ms(30));
    fixture.start(degrees(180.0)).unwrap();
    let drag = |setpoint| Command::Adjust {
        id: ID,
        setpoint,
        consent: Consent::None,
    };
    assert_eq!(fixture.command(drag(rpm(20))), Err(Refusal::NotDriven(ID)));
    for degree in 181..=200_u16 {
        fixture.command(drag(degrees(degree.into()))).unwrap();
        fixture.run(ms(15));
    }
    fixture.run(ms(2_000));
    assert_eq!(
        fixture.activity(),
        Activity::Driven {
            setpoint: degrees(200.0)
        }
    );
}

#[test]
fn a_start_during_a_stop_waits_for_its_end() {
    let mut fixture = turning();
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run(ms(40));
    fixture.start(rpm(50)).unwrap();
    fixture.run(ms(2_000));
    assert_eq!(fixture.activity(), Activity::Driven { setpoint: rpm(50) });
}

#[test]
fn another_motor_drives_on_meanwhile() {
    let mut fixture = two();
    fixture.drive(rpm(100)).unwrap();
    let other = crate::fixture::id(2);
    let setpoint = rpm(60);
    let consent = Consent::None;
    fixture
        .command(Command::Drive {
            id: other,
            setpoint,
            consent,
        })
        .unwrap();
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    fixture.start(degrees(90.0)).unwrap();
    fixture.run(ms(2_000));
    assert_eq!(
        fixture.status(other).activity,
        Activity::Driven { setpoint }
    );
    let gap = crate::fixture::longest_gap(&fixture.drive_times(other));
    assert!(gap < ms(90), "{gap:?}");
}

/// The whole way from one loop to another, of every model.
#[test]
fn each_model_is_driven_in_each_loop_within_a_second_of_its_start() {
    for model in Model::ALL {
        for from in Mode::ALL.into_iter().filter(|mode| model.has(*mode)) {
            for to in Mode::ALL.into_iter().filter(|mode| model.has(*mode)) {
                let mut fixture = on(model);
                let mut took = Duration::ZERO;
                for mode in [from, to] {
                    fixture.start(setpoint(mode)).unwrap();
                    took = fixture.run_until(ms(5_000), |fixture| {
                        fixture.activity()
                            == Activity::Driven {
                                setpoint: setpoint(mode),
                            }
                    });
                    fixture.run(ms(100));
                }
                assert!(took <= ms(1_000), "{model} from {from} to {to}: {took:?}");
                let now = fixture.world.motor(ID).unwrap().mode();
                assert_eq!(now, to, "{model} from {from}");
            }
        }
    }
}
