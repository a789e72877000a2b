//! The next frame of a stop, and what replies of uncertain age change.

use motorlink_protocol::{Current, Detail, Faults, Rpm};

use super::*;

const ID: MotorId = MotorId::FIRST;
const BEGAN: Instant = Instant::from_millis(1_000);

fn stop_of(mode: Option<Mode>) -> Stopping {
    Stopping::begin(BEGAN, mode, None)
}

fn brake() -> Request {
    let drive = Drive::from(Setpoint::Brake);
    Request::Drive { id: ID, drive }
}

fn switch() -> Request {
    let mode = Mode::Velocity;
    Request::SwitchMode { id: ID, mode }
}

/// The stop sends `count` switches, each a switch period after the last.
fn send_switches(stop: &mut Stopping, count: u8, answers: bool) -> Instant {
    let mut now = BEGAN;
    for _ in 0..count {
        now = now + SWITCH_PERIOD;
        stop.sent(now, Model::Ddsm115, switch(), STOP_PERIOD, answers);
    }
    now
}

fn standing(mode: Mode) -> Reply {
    Reply {
        id: ID,
        mode,
        current: Some(Current::from_raw(0)),
        speed: Some(Rpm::new(0)),
        detail: Detail::Undetermined([0, 0]),
        faults: Faults::NONE,
    }
}

#[test]
fn behind_a_switch_a_silent_motor_is_asked_only_after_every_fifth() {
    for (switches, is_asked) in [(1, false), (4, false), (5, true), (6, false), (10, true)] {
        let mut stop = stop_of(None);
        let now = send_switches(&mut stop, switches, false);
        let next = if is_asked { now } else { now + SWITCH_PERIOD };
        assert_eq!(stop.next_frame, next, "after {switches} switches");
    }
}

#[test]
fn behind_a_switch_the_next_frame_is_sent_at_once_if_it_is_answered_or_brakes() {
    for (mode, answers) in [(None, true), (Some(Mode::Current), false)] {
        let mut stop = stop_of(mode);
        let now = send_switches(&mut stop, 1, answers);
        assert_eq!(stop.next_frame, now, "{mode:?}, answers: {answers}");
    }
}

#[test]
fn an_uncertain_reply_from_the_position_loop_ends_the_brake() {
    let mut stop = stop_of(Some(Mode::Velocity));
    for _ in 1..STANDSTILL_REPLIES {
        stop.record_reply(&standing(Mode::Velocity), Some(true));
    }
    stop.record_uncertain_reply(Mode::Position);
    let request = |stop: &Stopping, at| stop.next_request(at, Model::Ddsm115, ID, false, false);
    assert_eq!(request(&stop, BEGAN), Request::Query { id: ID });
    assert_eq!(request(&stop, BEGAN + STOP_PERIOD), switch());
    stop.record_reply(&standing(Mode::Velocity), Some(true));
    assert!(!stop.confirmed(), "standstill is counted again");
}

#[test]
fn an_uncertain_reply_from_another_loop_changes_no_plan_and_no_count() {
    for mode in [Mode::Velocity, Mode::Current] {
        let mut stop = stop_of(Some(Mode::Velocity));
        for _ in 1..STANDSTILL_REPLIES {
            stop.record_reply(&standing(Mode::Velocity), Some(true));
        }
        stop.record_uncertain_reply(mode);
        let next = stop.next_request(BEGAN + STOP_PERIOD, Model::Ddsm115, ID, false, false);
        assert_eq!(next, brake());
        assert!(!stop.confirmed());
        stop.record_reply(&standing(Mode::Velocity), Some(true));
        assert!(stop.confirmed());
    }
}

/// A motor that is silent all along gets the brake after many switches, unless it was last known in the position loop.
#[test]
fn many_switches_are_enough_for_a_silent_motor_only_if_its_loop_was_never_known() {
    for (fresh, last, next) in [
        (None, None, brake()),
        (None, Some(Mode::Position), Request::Query { id: ID }),
        (Some(Mode::Position), None, Request::Query { id: ID }),
    ] {
        let mut stop = Stopping::begin(BEGAN, fresh, last);
        for switches in [SILENT_SWITCHES, u8::MAX] {
            let now = send_switches(&mut stop, switches, false);
            let request = stop.next_request(now, Model::Ddsm115, ID, false, false);
            assert_eq!(
                request, next,
                "{fresh:?} {last:?}, {switches} more switches"
            );
        }
    }
}

/// The last uncertain reply decides whether many switches are enough for the brake.
#[test]
fn a_motor_that_last_reported_the_position_loop_is_not_braked_after_many_switches() {
    let mut stop = stop_of(None);
    stop.record_uncertain_reply(Mode::Position);
    let now = send_switches(&mut stop, SILENT_SWITCHES, false);
    assert_eq!(
        stop.next_request(now, Model::Ddsm115, ID, false, false),
        Request::Query { id: ID }
    );
    stop.record_uncertain_reply(Mode::Velocity);
    assert_eq!(
        stop.next_request(now, Model::Ddsm115, ID, false, false),
        brake()
    );
}

#[test]
fn a_motor_may_have_got_nothing_until_an_answer_or_the_third_frame() {
    let mut stop = stop_of(Some(Mode::Velocity));
    assert!(!stop.may_have_got_nothing());
    for may_have in [true, true, false] {
        stop.sent(BEGAN, Model::Ddsm115, brake(), STOP_PERIOD, true);
        assert_eq!(stop.may_have_got_nothing(), may_have);
    }
    let mut stop = stop_of(Some(Mode::Velocity));
    stop.sent(BEGAN, Model::Ddsm115, brake(), STOP_PERIOD, true);
    stop.answered();
    assert!(!stop.may_have_got_nothing());
}

/// A DDSM210 does not name the loop in its reply to a brake, so it is asked for the loop too.
#[test]
fn between_two_switches_a_motor_is_braked_and_where_its_reply_does_not_name_the_loop_asked() {
    let query = Request::ModeQuery { id: ID };
    for (model, between) in [
        (Model::Ddsm115, vec![brake()]),
        (Model::Ddsm210, vec![brake(), query]),
    ] {
        let mut stop = stop_of(Some(Mode::Current));
        let mut now = BEGAN + STOP_PERIOD;
        for request in [vec![switch()], between, vec![switch()]].concat() {
            assert_eq!(stop.next_request(now, model, ID, false, false), request);
            stop.sent(now, model, request, STOP_PERIOD, true);
            now = now + SWITCH_PERIOD;
        }
    }
}

#[test]
fn a_reply_has_the_layout_of_the_requests_since_if_they_were_all_alike() {
    let at = |ms| BEGAN + Duration::from_millis(ms);
    let mut stop = stop_of(Some(Mode::Velocity));
    stop.sent(at(10), Model::Ddsm115, brake(), STOP_PERIOD, true);
    assert_eq!(stop.layout_since(BEGAN), Some(Layout::Drive));
    assert_eq!(stop.layout_since(at(10)), Some(Layout::Drive));
    assert_eq!(stop.layout_since(at(11)), None, "nothing was sent since");
    assert_eq!(
        stop.layout_since(BEGAN - STOP_PERIOD),
        None,
        "before the stop"
    );
    let query = Request::Query { id: ID };
    stop.sent(at(20), Model::Ddsm115, query, STOP_PERIOD, true);
    assert_eq!(stop.layout_since(at(11)), Some(Layout::Query));
    assert_eq!(stop.layout_since(at(10)), None, "both were sent");
}

#[test]
fn a_wheel_with_1_rpm_does_not_stand() {
    for (rpm, stands) in [(0, true), (1, false), (-1, false)] {
        let mut stop = stop_of(Some(Mode::Velocity));
        for _ in 0..STANDSTILL_REPLIES {
            let reply = Reply {
                speed: Some(Rpm::new(rpm)),
                ..standing(Mode::Velocity)
            };
            stop.record_reply(&reply, Some(true));
        }
        assert_eq!(stop.confirmed(), stands, "{rpm} rpm");
    }
}

#[test]
fn a_motor_waits_for_a_brake_until_one_is_sent_in_the_velocity_loop() {
    for (mode, waits) in [(Mode::Velocity, false), (Mode::Current, true)] {
        let mut stop = stop_of(Some(mode));
        assert!(stop.waits_for_brake());
        stop.sent(BEGAN, Model::Ddsm115, brake(), STOP_PERIOD, true);
        assert_eq!(stop.waits_for_brake(), waits, "{mode:?}");
    }
}
