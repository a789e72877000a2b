//! What ends the start of a group that waits: none of its motors is driven then.

use motorlink_bus::{
    Activity, BusSettings, Command, Consent, Event, GroupSetpoints, Limits, Refusal, StopReason,
};
use motorlink_protocol::Setpoint;

use crate::fixture::{Fixture, amps, id, ms, rpm};
use crate::group_starts::{
    IDS, activities, adjust, moving_frames, rover, speeds, start, waits, why_not,
};

/// The stops that a page may send, of the whole bus and of any member.
fn stops() -> Vec<Command> {
    let consent = Consent::None;
    let mut stops = vec![Command::StopAll(StopReason::Operator), adjust([0, 0, 0])];
    for id in IDS.map(id) {
        stops.extend([Command::Stop(id), Command::Hold(id)]);
        for setpoint in [rpm(0), amps(0.0), Setpoint::Brake] {
            stops.push(Command::Drive {
                id,
                setpoint,
                consent,
            });
        }
    }
    stops
}

#[test]
fn any_stop_of_one_ends_the_start_of_all() {
    for stop in stops() {
        let mut waited = 0;
        for late_ms in (0..900).step_by(23) {
            let Some(mut fixture) = started_ago(late_ms) else {
                break;
            };
            waited += 1;
            fixture.command(stop).unwrap();
            assert!(!waits(&fixture), "{stop:?} after {late_ms} ms");
            fixture.run(ms(2_000));
            assert_eq!(moving_frames(&fixture), [], "{stop:?} after {late_ms} ms");
            assert_eq!(activities(&fixture), [Activity::Idle; 3]);
        }
        assert!(waited > 5, "{stop:?}: the start waited {waited} times");
    }
}

/// A rover whose group was started so long ago; `None` once it no longer waits.
fn started_ago(late_ms: u64) -> Option<Fixture> {
    let mut fixture = rover();
    fixture.command(start([100, -100, 50])).unwrap();
    fixture.run(ms(late_ms));
    waits(&fixture).then_some(fixture)
}

type Cause<'a> = (&'a str, &'a dyn Fn(&mut Fixture));

/// What ends the start of all, by what happens to the motor in the middle or to the bus.
#[test]
fn a_silent_hot_or_faulty_motor_a_limit_a_scan_and_a_gap_end_the_start_of_all() {
    let slow = BusSettings {
        limits: Limits::new(20, 2_700, 75).unwrap(),
        ..BusSettings::default()
    };
    let causes: [Cause<'_>; 6] = [
        ("silent", &|it| {
            it.world.motor_mut(id(2)).unwrap().mute(true);
        }),
        ("hot", &|it| {
            it.world.motor_mut(id(2)).unwrap().set_temperature_c(95.0);
        }),
        ("ready and silent", &|it| {
            it.world.motor_mut(id(3)).unwrap().power(false);
        }),
        ("limit", &|it| it.command(Command::Configure(slow)).unwrap()),
        ("scan", &|it| it.command(Command::FullScan).unwrap()),
        ("gap", &|it| {
            it.sleep(ms(700));
            it.deliver();
        }),
    ];
    for (name, cause) in causes {
        let (mut waited, mut ended) = (0, 0);
        for late_ms in (0..900).step_by(31) {
            let Some(mut fixture) = started_ago(late_ms) else {
                break;
            };
            waited += 1;
            cause(&mut fixture);
            fixture.run(ms(5_000));
            let said = why_not(&fixture).is_some()
                || fixture.happened(|event| match event {
                    Event::ModeSwitchFailed { id: of, .. } => *of == id(2),
                    Event::StopBegan(reason) => *reason != StopReason::OneMotor,
                    _ => false,
                });
            // Until a request is not answered, it is not silent.
            let withdrawn = fixture.happened(|event| matches!(event, Event::Withdrawn { .. }));
            assert!(said || withdrawn, "{name} after {late_ms} ms");
            assert!(!waits(&fixture), "{name} after {late_ms} ms");
            let moved = !moving_frames(&fixture).is_empty();
            assert_eq!(moved, withdrawn, "{name} after {late_ms} ms");
            ended += u32::from(said);
        }
        // What a motor reports only after its stop is confirmed ends the drive instead.
        assert!(waited > 5 && ended > 0, "{name}: {ended} of {waited}");
    }
}

#[test]
fn a_scan_that_is_cancelled_before_the_stop_ends_starts_nothing() {
    for cancel in [Command::CancelJob, Command::Stop(id(3))] {
        let mut fixture = started_ago(10).unwrap();
        fixture.command(Command::FullScan).unwrap();
        assert!(!waits(&fixture), "{cancel:?}");
        fixture.command(cancel).unwrap();
        fixture.run(ms(4_000));
        assert!(moving_frames(&fixture).is_empty(), "{cancel:?}");
        let refused = why_not(&fixture).map(|(_, refusal)| refusal);
        assert_eq!(refused, Some(Refusal::JobRunning), "{cancel:?}");
    }
}

/// The page says "not started" then, so nothing may start.
#[test]
fn a_refused_start_of_one_of_its_motors_ends_the_wait_of_a_group() {
    let pad = Command::DriveGroup {
        setpoints: speeds([1, 1, 1]),
        consent: Consent::None,
    };
    let with_an_absent_one = [(id(1), rpm(50)), (id(9), rpm(50))];
    let absent = Command::StartGroup {
        setpoints: GroupSetpoints::new(&with_an_absent_one).unwrap(),
        consent: Consent::None,
    };
    for refused in [pad, absent] {
        let mut fixture = started_ago(50).unwrap();
        let refusal = fixture.command(refused).unwrap_err();
        assert!(!waits(&fixture), "{refused:?}");
        fixture.run(ms(2_500));
        assert!(moving_frames(&fixture).is_empty(), "{refused:?}");
        assert_eq!(why_not(&fixture), Some((id(1), refusal)), "{refused:?}");
    }
}
