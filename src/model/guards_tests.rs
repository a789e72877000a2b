//! Which controls can be used, and the reasons.

use motorlink_messages::bus::Answer;
use motorlink_messages::{
    bus::JobStatus,
    protocol::{Faults, Setpoint, SpeedTarget},
};

use super::*;
use crate::model::snapshot::tests::{ID, session, status};

const MODES: [Mode; 3] = Mode::ALL;

#[test]
fn a_motor_that_reports_a_loop_can_be_started_in_each() {
    for reported in MODES {
        let turning = session(1_000, status(1_000, reported, 50));
        for mode in MODES {
            assert_eq!(drive_blocked_by(&turning, ID, mode), None);
        }
    }
}

#[test]
fn nothing_drives_while_it_must_not() {
    let good = session(1_000, status(1_000, Mode::Velocity, 0));
    assert_eq!(drive_blocked_by(&good, ID, Mode::Velocity), None);

    let mut cases = vec![];
    let mut case = |words: &'static str, change: &dyn Fn(&mut Session)| {
        let mut session = good.clone();
        change(&mut session);
        cases.push((words, session));
    };
    case("Not connected", &|s| {
        s.connection = Connection::Disconnected;
    });
    case("Opening the port", &|s| {
        s.connection = Connection::Connecting;
    });
    case("Press Release", &|s| s.halted = true);
    case("bus scan is running", &|s| {
        s.job = Some(JobStatus::Stopping);
    });
    case("raw frame", &|s| s.motors[0].activity = Activity::DrivenRaw);
    case("has not replied", &|s| s.motors.clear());
    case("has not replied", &|s| {
        s.motors = vec![status(400, Mode::Velocity, 0)];
    });
    case("No reply from motor 0x01 for 2 s", &|s| {
        s.motors = vec![status(400, Mode::Velocity, 0)];
        s.motors[0].answer = Answer::Missing;
    });
    // One state, one sentence: that of the notice.
    case("No valid reply from 0x01 for 2 s", &|s| {
        s.motors = vec![status(400, Mode::Velocity, 0)];
        s.motors[0].answer = Answer::Corrupted;
    });
    case("stall", &|s| {
        let sample = s.motors[0].last.as_mut().unwrap();
        sample.reply.faults = Faults::from_byte(8);
    });
    for (words, session) in cases {
        let reason = drive_blocked_by(&session, ID, Mode::Velocity).unwrap();
        assert!(reason.contains(words), "{reason}");
    }
}

/// The bus drives what stands in its new loop, one motor or a group. What is held never waits.
#[test]
fn what_stops_or_switches_or_is_in_another_loop_can_be_started() {
    let mut session = session(1_000, status(1_000, Mode::Current, 0));
    let members = vec![(ID, Side::Left)];
    for activity in [
        Activity::Idle,
        Activity::Switching { to: Mode::Velocity },
        Activity::Stopping { confirmed: false },
    ] {
        session.motors[0].activity = activity;
        for mode in MODES {
            assert_eq!(drive_blocked_by(&session, ID, mode), None);
        }
        assert_eq!(group_drive_blocked_by(&session, &members), None);
        // The pad drives at once or not at all.
        let held = steer_blocked_by(&session, &members).unwrap();
        let words = match activity {
            Activity::Switching { .. } => "switching loops",
            Activity::Stopping { .. } => "is stopping",
            _ => "Press its Stop",
        };
        assert!(held.contains(words), "{held}");
    }
    session.motors[0].last.as_mut().unwrap().reply.faults = Faults::from_byte(8);
    let fault = drive_blocked_by(&session, ID, Mode::Velocity).unwrap();
    assert!(fault.contains("stall"), "{fault}");
    let group = group_drive_blocked_by(&session, &members).unwrap();
    assert!(group.contains("stall"), "{group}");
}

#[test]
fn a_setup_is_taken_in_while_no_motor_is_in_use() {
    let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
    assert_eq!(import_blocked_by(&session, false), None);
    assert_eq!(import_blocked_by(&Session::default(), false), None);
    let held = import_blocked_by(&session, true).unwrap();
    assert!(held.contains("drive pad"), "{held}");
    let setpoint = Setpoint::velocity(SpeedTarget::clamped(100));
    for activity in [
        Activity::Driven { setpoint },
        Activity::DrivenRaw,
        Activity::Switching { to: Mode::Current },
        Activity::Stopping { confirmed: false },
    ] {
        session.motors[0].activity = activity;
        let reason = import_blocked_by(&session, false).unwrap();
        assert!(reason.contains("Motor 0x01 is in use"), "{reason}");
    }
}

#[test]
fn motors_drive_together_where_each_of_them_may() {
    let good = session(1_000, status(1_000, Mode::Velocity, 0));
    let members = vec![(ID, Side::Left)];
    assert_eq!(group_drive_blocked_by(&good, &members), None);
    assert_eq!(steer_blocked_by(&good, &members), None);
    let missing = MotorId::new(9).unwrap();
    let too_many: GroupMembers = MotorId::all().take(17).map(|id| (id, Side::Left)).collect();
    for (words, members) in [
        ("Select the motors", vec![]),
        ("at most 16 motors", too_many),
        (
            "Motor 0x09 has not replied",
            vec![(ID, Side::Left), (missing, Side::Right)],
        ),
    ] {
        let reason = group_drive_blocked_by(&good, &members).unwrap();
        assert!(reason.contains(words), "{reason}");
        assert_eq!(steer_blocked_by(&good, &members), Some(reason));
    }
    let mut cases = vec![];
    let mut case = |words: &'static str, change: &dyn Fn(&mut Session)| {
        let mut session = good.clone();
        change(&mut session);
        cases.push((words, session));
    };
    case("Not connected", &|s| {
        s.connection = Connection::Disconnected;
    });
    case("Press Release", &|s| s.halted = true);
    case("bus scan is running", &|s| {
        s.job = Some(JobStatus::Stopping);
    });
    for (words, session) in cases {
        let reason = group_drive_blocked_by(&session, &members).unwrap();
        assert!(reason.contains(words), "{reason}");
    }
    let sideless = vec![(ID, Side::None)];
    assert_eq!(group_drive_blocked_by(&good, &sideless), None);
    assert!(
        steer_blocked_by(&good, &sideless)
            .unwrap()
            .contains("side of motor 0x01")
    );
}

#[test]
fn one_scan_at_a_time_and_no_frame_beside_it() {
    let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
    assert_eq!(scan_blocked_by(&session), None);
    assert!(cancel_blocked_by(&session).is_some());
    session.job = Some(JobStatus::Stopping);
    assert!(scan_blocked_by(&session).is_some());
    assert!(send_blocked_by(&session, false).is_some());
    assert_eq!(cancel_blocked_by(&session), None);
    session.job = None;
    session.halted = true;
    assert_eq!(scan_blocked_by(&session), None);
    assert!(id_change_blocked_by(&session).is_some());
    session.connection = Connection::Disconnected;
    assert!(scan_blocked_by(&session).is_some());
}

#[test]
fn while_all_motors_are_stopped_only_a_query_is_sent() {
    let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
    session.halted = true;
    assert_eq!(send_blocked_by(&session, false), None);
    assert!(send_blocked_by(&session, true).unwrap().contains("Release"));
}

#[test]
fn a_side_is_not_changed_while_the_motor_is_in_hand() {
    let setpoint = Setpoint::velocity(SpeedTarget::ZERO);
    for (activity, allowed) in [
        (Activity::Idle, true),
        (Activity::Driven { setpoint }, false),
        (Activity::DrivenRaw, false),
        (Activity::Stopping { confirmed: false }, false),
        (Activity::Switching { to: Mode::Current }, false),
    ] {
        let mut motor = status(1_000, Mode::Velocity, 0);
        motor.activity = activity;
        let reason = side_change_blocked_by(&session(1_000, motor), ID);
        assert_eq!(reason.is_none(), allowed, "{activity:?}");
    }
    assert_eq!(
        side_change_blocked_by(&Session::default(), ID),
        None,
        "nobody answers"
    );
}

#[test]
fn a_driven_motor_takes_another_target() {
    let mut driven = status(1_000, Mode::Velocity, 50);
    driven.activity = Activity::Driven {
        setpoint: Setpoint::velocity(SpeedTarget::ZERO),
    };
    let session = session(1_000, driven);
    assert_eq!(drive_blocked_by(&session, ID, Mode::Velocity), None);
}

#[test]
fn a_stop_waits_for_nothing_but_a_port() {
    let mut session = session(9_000, status(0, Mode::Position, 90));
    session.halted = true;
    assert_eq!(stop_blocked_by(&session), None);
    session.connection = Connection::Disconnected;
    assert!(stop_blocked_by(&session).is_some());
}
