//! The state that the worker reports, as the page reads it.

use motorlink_messages::{
    Adapter,
    bus::{Answer, Counters, LinkQuality, Sample, StopReport},
    protocol::{CoarsePosition, Detail, Position, Setpoint, SpeedTarget},
};

use super::*;
use crate::model::names_and_sides::Side;

pub(crate) const ID: MotorId = MotorId::FIRST;

/// A motor that last answered a query at this moment.
pub(crate) fn status(at_ms: u64, mode: Mode, rpm: i16) -> MotorStatus {
    let reply = Reply {
        id: ID,
        mode,
        current: Some(Current::from_raw(100)),
        speed: Some(Rpm::new(rpm)),
        detail: Detail::Query {
            temperature: Celsius::new(33),
            position: CoarsePosition::from_raw(47),
        },
        faults: Faults::NONE,
    };
    let at = Instant::from_millis(at_ms);
    MotorStatus {
        waiting: None,
        id: ID,
        activity: Activity::Idle,
        last: Some(Sample { at, reply }),
        speed: Some((at, Rpm::new(rpm))),
        current: Some((at, Current::from_raw(100))),
        position: None,
        temperature: Some((at, Celsius::new(33))),
        turns: None,
        answer: Answer::Comes,
        may_turn: false,
        turns_unasked: false,
        link: LinkQuality::default(),
        counters: Counters::default(),
    }
}

pub(crate) fn session(now_ms: u64, motor: MotorStatus) -> Session {
    Session {
        now: Instant::from_millis(now_ms),
        connection: Connection::Connected(Adapter::VIRTUAL),
        motors: vec![motor],
        ..Session::default()
    }
}

fn update(halted: bool, notices: Vec<Notice>) -> Update {
    Update {
        now: Instant::from_millis(1),
        connection: Connection::Connected(Adapter::VIRTUAL),
        halted,
        job: None,
        raw: None,
        line: None,
        motors: vec![],
        samples: vec![],
        notices,
    }
}

#[test]
fn a_stop_is_remembered_until_it_is_released() {
    let mut session = Session::default();
    let reason = StopReason::PageSilent;
    session.apply(&update(true, vec![Notice::StopBegan(reason)]));
    let begun = session.stop.as_ref().unwrap();
    assert_eq!((begun.ended, &begun.outcomes), (false, &vec![]));

    let outcome = StopOutcome {
        id: ID,
        confirmed: false,
        speed: None,
    };
    let report = StopReport {
        reason,
        motors: vec![outcome],
    };
    session.apply(&update(true, vec![Notice::StopEnded(report)]));
    session.apply(&update(true, vec![Notice::StopBegan(StopReason::OneMotor)]));
    let stop = session.stop.clone().unwrap();
    assert_eq!(stop.reason, reason);
    assert_eq!(stop.outcomes, [outcome]);

    session.apply(&update(false, vec![]));
    assert_eq!(session.stop, None);
}

/// Disconnect joins a stop of all motors, and then the report has its reason.
#[test]
fn the_outcomes_of_a_stop_that_a_disconnect_ended_are_kept() {
    let mut session = Session::default();
    let begun = Notice::StopBegan(StopReason::Operator);
    session.apply(&update(true, vec![begun]));
    let motors = vec![StopOutcome {
        id: ID,
        confirmed: false,
        speed: None,
    }];
    let reason = StopReason::Disconnect;
    let ended = Notice::StopEnded(StopReport { reason, motors });
    session.apply(&update(true, vec![ended]));
    let stop = session.stop.unwrap();
    assert_eq!(stop.reason, StopReason::Operator);
    assert_eq!((stop.outcomes.len(), stop.ended), (1, true));
}

/// An odometry reply has no current, and the first one no speed.
#[test]
fn each_value_is_as_old_as_the_reply_that_told_it() {
    let mut motor = status(1_000, Mode::Velocity, 0);
    motor.speed = Some((Instant::from_millis(800), Rpm::new(7)));
    motor.current = None;
    let session = session(1_100, motor);
    let speed = session.speed(ID).unwrap();
    assert_eq!((speed.value, speed.age.as_millis()), (Rpm::new(7), 300));
    assert_eq!(session.current(ID), None);
}

#[test]
fn the_first_cause_of_a_stop_and_the_last_outcome_of_each_motor_stay_until_release() {
    let mut session = Session::default();
    let (first, second) = (StopReason::PageSilent, StopReason::Operator);
    let ended = |reason, motors| Notice::StopEnded(StopReport { reason, motors });
    let outcome = |id: u8, confirmed| StopOutcome {
        id: MotorId::new(id).unwrap(),
        confirmed,
        speed: None,
    };
    let begun = Notice::StopBegan(first);
    let motors = vec![outcome(1, true), outcome(2, false)];
    session.apply(&update(true, vec![begun, ended(first, motors.clone())]));
    session.apply(&update(true, vec![Notice::StopBegan(second)]));
    let stop = session.stop.clone().unwrap();
    assert_eq!((stop.reason, &stop.outcomes), (first, &motors));
    // Only the motor that did not stand is stopped again.
    let again = vec![outcome(2, true)];
    session.apply(&update(true, vec![ended(second, again)]));
    let stop = session.stop.clone().unwrap();
    let both = vec![outcome(1, true), outcome(2, true)];
    assert_eq!((stop.reason, stop.outcomes), (first, both));
    // Nothing was driven.
    session.apply(&update(true, vec![ended(second, vec![])]));
    assert_eq!(session.stop.as_ref().unwrap().outcomes.len(), 2);

    session.apply(&update(false, vec![]));
    session.apply(&update(true, vec![Notice::StopBegan(second)]));
    assert_eq!(session.stop.unwrap().reason, second);
}

/// Space stops what moves; a current that flows in a wheel that stands may move it at any time.
#[test]
fn what_moves_unasked_counts_as_driven() {
    let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
    assert!(!session.is_anything_driven());
    let before = session.clone();
    session.motors[0].turns_unasked = true;
    assert!(session.is_anything_driven());
    assert!(session.differs_in_state(&before), "it is shown at once");
    session.connection = Connection::Connected(Adapter::Recording);
    assert!(!session.is_anything_driven());
    assert_eq!(session.turning_unasked().count(), 0);
}

#[test]
fn rest_is_known_only_of_motors_that_answer() {
    let standing = session(1_000, status(1_000, Mode::Velocity, 0));
    assert!(standing.is_known_to_rest());
    assert!(Session::default().is_known_to_rest(), "no motor");
    let mut silent = standing.clone();
    silent.motors[0].answer = Answer::Missing;
    assert!(!silent.is_known_to_rest(), "it may turn");
    silent.connection = Connection::Disconnected;
    assert!(silent.is_known_to_rest(), "no stop could reach it");
    let turning = session(1_000, status(1_000, Mode::Velocity, 3));
    assert!(!turning.is_known_to_rest());
    let mut unconfirmed = standing.clone();
    unconfirmed.motors[0].may_turn = true;
    assert!(!unconfirmed.is_known_to_rest());
    let mut driven = standing;
    driven.motors[0].activity = Activity::DrivenRaw;
    assert!(!driven.is_known_to_rest());
}

#[test]
fn a_reading_is_fresh_for_half_a_second() {
    let at = |now_ms| {
        session(now_ms, status(1_000, Mode::Velocity, 5))
            .speed(ID)
            .unwrap()
    };
    assert!(at(1_500).is_fresh());
    assert!(!at(1_501).is_fresh());
    assert_eq!(at(1_501).value, Rpm::new(5));
    assert_eq!(Session::default().speed(ID), None);
}

#[test]
fn the_fine_angle_is_shown_while_it_is_fresh() {
    let mut motor = status(1_000, Mode::Velocity, 5);
    let fine = Position::from_raw(6_095);
    motor.position = Some((Instant::from_millis(800), fine));
    let angle = |now_ms, motor| session(now_ms, motor).angle(ID).unwrap().value;
    assert_eq!(angle(1_100, motor), Angle::Fine(fine));
    let coarse = Angle::Coarse(CoarsePosition::from_raw(47));
    assert_eq!(angle(1_400, motor), coarse);
    motor.last = None;
    assert_eq!(angle(9_000, motor), Angle::Fine(fine));
}

#[test]
fn a_mirrored_motor_is_read_with_the_other_sign_and_no_state_changes_by_it() {
    let goal = |rpm| Activity::Driven {
        setpoint: Setpoint::velocity(SpeedTarget::new(rpm).unwrap()),
    };
    let mut motor = status(1_000, Mode::Velocity, -98);
    motor.activity = goal(-100);
    let told = session(1_016, motor);
    let mut names = NamesAndSides::default();
    names.change(ID, |member| member.side = Side::Left);
    assert_eq!(told.clone().with_mirroring(&names), told);
    names.change(ID, |member| member.side = Side::Right);
    let read = told.clone().with_mirroring(&names);
    assert!(read.mirror(ID).is_mirrored() && !told.mirror(ID).is_mirrored());
    assert_eq!(read.speed(ID).unwrap().value, Rpm::new(98));
    assert_eq!(read.current(ID).unwrap().value, Current::from_raw(-100));
    assert_eq!(read.motor(ID).unwrap().activity, goal(100));
    assert_eq!(
        read.angle(ID),
        told.angle(ID),
        "the wheel stands where it stands"
    );
    assert!(!told.differs_in_state(&read) && !read.differs_in_state(&told));
    motor.activity = goal(100);
    assert!(session(1_016, motor).differs_in_state(&read));
}

#[test]
fn a_new_reading_alone_is_no_change_of_state() {
    let before = session(1_000, status(1_000, Mode::Velocity, 5));
    let after = session(1_020, status(1_020, Mode::Velocity, 9));
    assert!(!after.differs_in_state(&before));
    let switched = session(1_020, status(1_020, Mode::Current, 9));
    assert!(switched.differs_in_state(&before));
}
