//! Which frame goes next, and when.

use motorlink_protocol::{
    Drive, Layout, Mode, Setpoint, SpeedTarget,
    family::{Model, Request},
};

use super::*;
use crate::{mode_switch::Switch, motor::Driven, silence::Withheld, timing::STOP_PERIOD};

const NOW: Instant = Instant::from_millis(10_000);
/// Of [`PACING`].
const USUAL: Duration = ms(5);
const PACING: Pacing = Pacing {
    usual: USUAL,
    period: ms(20),
    last_frame: LastFrame::Other,
    just_freed: false,
    queries_from: Instant::ZERO,
    silent_stopped: None,
    stops_first: false,
    drive_waits_for_proof: false,
};

const fn ms(millis: u64) -> Duration {
    Duration::from_millis(millis)
}

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

fn next(motors: &[Motor]) -> Turn {
    next_turn(motors, None, NOW, PACING)
}

/// A motor that is asked at this time.
fn asked(address: u8, at: Instant) -> Motor {
    let mut motor = Motor::new(NOW, Model::Ddsm115, id(address));
    motor.next_query = at;
    motor
}

/// A motor that is driven for a second, gets its next drive frame at this time, and is asked long after it.
fn driven(address: u8, at: Instant) -> Motor {
    let mut motor = asked(address, NOW + ms(1_000));
    let setpoint = Setpoint::velocity(SpeedTarget::new(100).unwrap());
    motor.control = Control::Driven(Driven {
        next_frame: at,
        is_new: false,
        ..Driven::begin(NOW - ms(1_000), setpoint, None)
    });
    motor
}

/// A motor that is stopped since a second, got its last frame at one time and gets its next at the other.
fn stopped(address: u8, last: Instant, next: Instant) -> Motor {
    let mut motor = asked(address, NOW);
    let mut stop = Stopping::begin(NOW - ms(1_000), Some(Mode::Velocity), None);
    let drive = Drive::from(Setpoint::Brake);
    let brake = Request::Drive {
        id: id(address),
        drive,
    };
    stop.sent(last, Model::Ddsm115, brake, next.since(last), true);
    motor.control = Control::Stopping(stop);
    motor
}

#[test]
fn a_frame_goes_one_step_of_the_clock_early() {
    let motors = [driven(1, NOW + EARLY)];
    assert_eq!(next(&motors), Turn::Now(DueFrame::Drive(id(1))));
    let later = NOW + EARLY + Duration::from_micros(1);
    assert_eq!(next(&[driven(1, later)]), Turn::At(later));
}

#[test]
fn a_driven_motor_gets_neutral_frames_while_its_loop_is_switched() {
    let mut motor = asked(1, NOW + ms(1_000));
    let mut switch = Switch::begin(NOW, Mode::Current, Some(Mode::Velocity));
    switch.frame_sent(NOW);
    assert!(switch.neutral_drive.is_some());
    motor.control = Control::Switching(switch);
    assert_eq!(next(&[motor]), Turn::Now(DueFrame::Drive(id(1))));
}

/// Motor 1 has drive frames due, and an old temperature.
fn with_old_temperature() -> Motor {
    let mut motor = driven(1, NOW);
    motor.late.asked_otherwise(NOW - ms(10));
    motor
}

#[test]
fn a_query_for_an_old_temperature_goes_before_drive_frames_unless_another_motor_has_waited_long() {
    let ask = |address| Turn::Now(DueFrame::Query(id(address)));
    assert_eq!(next(&[with_old_temperature()]), ask(1));
    for (waits_ms, asked_first) in [(0, 1), (299, 1), (300, 2)] {
        let other = asked(2, NOW - ms(waits_ms));
        assert_eq!(
            next(&[with_old_temperature(), other]),
            ask(asked_first),
            "{waits_ms} ms"
        );
    }
}

#[test]
fn while_requests_are_withheld_no_query_goes_for_an_old_temperature() {
    let withheld_until = |until: Instant| {
        let mut motor = driven(2, NOW + ms(50));
        let silence = Silence::begin(
            NOW - ms(100),
            None,
            until.since(NOW - ms(100)),
            Withheld::Requests,
        );
        motor.driven_mut().unwrap().silence = Some(silence);
        next(&[with_old_temperature(), motor])
    };
    assert_eq!(
        withheld_until(NOW + ms(1)),
        Turn::Now(DueFrame::Drive(id(1)))
    );
    assert_eq!(withheld_until(NOW), Turn::Now(DueFrame::Query(id(1))));
}

#[test]
fn a_query_that_has_waited_goes_if_its_usual_exchange_ends_before_the_next_frame() {
    let waits = asked(1, NOW - QUERY_PATIENCE);
    let with_next_at = |at| next(&[waits.clone(), driven(2, at)]);
    assert_eq!(with_next_at(NOW + USUAL), Turn::Now(DueFrame::Query(id(1))));
    let sooner = NOW + USUAL - Duration::from_micros(1);
    assert_eq!(with_next_at(sooner), Turn::At(sooner));
}

/// Half a period, divided by two driven motors: 5 ms.
#[test]
fn a_query_that_is_due_leaves_a_margin_before_the_next_frame() {
    let is_due = asked(1, NOW);
    let with_next_at = |at| next(&[is_due.clone(), driven(2, at), driven(3, NOW + ms(100))]);
    let fits = NOW + USUAL + ms(5);
    assert_eq!(with_next_at(fits), Turn::Now(DueFrame::Query(id(1))));
    let sooner = fits - Duration::from_micros(1);
    assert_eq!(with_next_at(sooner), Turn::At(sooner));
}

#[test]
fn a_query_that_does_not_fit_is_looked_at_again_when_it_has_waited_or_behind_the_next_frame() {
    let pacing = Pacing {
        usual: ms(30),
        ..PACING
    };
    let appointment = NOW + ms(20);
    for (waits_ms, next) in [(15, NOW + ms(5)), (25, appointment)] {
        let motors = [asked(1, NOW - ms(waits_ms)), driven(2, appointment)];
        assert_eq!(
            next_turn(&motors, None, NOW, pacing),
            Turn::At(next),
            "{waits_ms} ms"
        );
    }
}

#[test]
fn the_motor_of_a_stop_that_got_its_last_frame_first_is_next_if_it_is_due() {
    let is_next = |address| Turn::Now(DueFrame::Stop(id(address)));
    let second = stopped(2, NOW - STOP_PERIOD * 2, NOW - STOP_PERIOD);
    for (due, expected) in [
        (NOW - ms(1), 1),
        (NOW, 1),
        (NOW + ms(1), 2),
        (NOW + ms(300), 2),
    ] {
        let first = stopped(1, NOW - STOP_PERIOD * 3, due);
        assert_eq!(next(&[first, second.clone()]), is_next(expected), "{due:?}");
    }
}

#[test]
fn while_no_frame_of_a_stop_is_due_the_one_that_is_due_first_is_waited_for() {
    let first = stopped(1, NOW - ms(10), NOW + ms(290));
    let second = stopped(2, NOW - ms(3), NOW + ms(2));
    assert_eq!(next(&[first, second]), Turn::At(NOW + ms(2)));
}

#[test]
fn a_stop_goes_before_drive_frames_while_the_motor_may_have_got_none_of_its_frames() {
    let stop = stopped(1, NOW - ms(10), NOW - ms(1));
    let next_beside = |stop: &Motor, drive_due| next(&[stop.clone(), driven(2, drive_due)]);
    let stop_is_next = Turn::Now(DueFrame::Stop(id(1)));
    let drive_is_next = Turn::Now(DueFrame::Drive(id(2)));
    assert_eq!(next_beside(&stop, NOW - ms(199)), stop_is_next);
    assert_eq!(next_beside(&stop, NOW - ms(200)), drive_is_next);

    let mut answered = stop.clone();
    if let Control::Stopping(stop) = &mut answered.control {
        stop.answered();
    }
    assert_eq!(next_beside(&answered, NOW - ms(2)), drive_is_next);
    assert_eq!(next_beside(&answered, NOW), stop_is_next);

    let mut without_answer = stop;
    without_answer.unanswered_in_a_row = 3;
    assert_eq!(next_beside(&without_answer, NOW - ms(2)), drive_is_next);
}

/// The reply to a drive frame that was not answered in time comes within 50 ms, or never.
#[test]
fn a_query_waits_for_a_late_reply_to_a_drive_frame_but_not_longer_than_its_patience() {
    for (sent_ms_ago, next_in_ms) in [(45, 5), (40, 10), (10, 20)] {
        let mut motor = asked(1, NOW);
        motor
            .late
            .unanswered(Layout::Drive, NOW - ms(sent_ms_ago), 1);
        let expected = Turn::At(NOW + ms(next_in_ms));
        assert_eq!(next(&[motor]), expected, "{sent_ms_ago} ms");
    }
}
