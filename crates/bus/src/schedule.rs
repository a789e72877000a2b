//! Who speaks next on the line.

use std::time::Duration;

use motorlink_protocol::{AssignableId, Instant, MotorId};

use crate::{
    motor::{Control, Motor},
    probe::Ask,
    stop::Stopping,
    timing::{EARLY, QUERY_MARGIN_MAX, QUERY_PATIENCE},
};

/// What the line is to be used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// Send this now.
    Now(Errand),
    /// Nothing is due before this.
    At(Instant),
    /// Nothing will be due.
    Never,
}

/// What the line is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Errand {
    /// The next frame of this motor's stop.
    Stop(MotorId),
    /// The next frame of this motor's mode switch.
    Switch(MotorId),
    /// This motor's setpoint, or the neutral frame during a mode switch.
    Drive(MotorId),
    /// This motor's telemetry.
    Query(MotorId),
    /// Who is there.
    IdQuery,
    /// The next question of a scan or an ID change.
    Survey(Ask),
    /// The next set-ID frame.
    SetId(AssignableId),
    /// The frame that a person wrote.
    Raw,
}

/// How fast the line is spoken on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// How long an exchange usually takes.
    pub(crate) usual: Duration,
    /// Between two drive frames to one motor.
    pub(crate) period: Duration,
    /// Whether the last frame was a query. No other makes a drive frame late then.
    pub(crate) query_was_last: bool,
    /// Whether the last exchange has only just ended.
    pub(crate) just_freed: bool,
    /// When the line may carry a query again.
    pub(crate) queries_from: Instant,
    /// The round of a stop behind which a motor that does not answer gets its next frame.
    pub(crate) silent_stop_round: u32,
    /// Whether drive frames wait until a byte proves that the line carries the last. A stop does not.
    pub(crate) drive_waits_for_proof: bool,
}

/// The first frame of a stop before everything; then mode switches, queries that have waited too
/// long, stops and drive frames by deadline, and queries where they make no drive frame late.
///
/// `raw` is when the frame that a person wrote is due; it is scheduled as a drive frame is.
pub(crate) fn next_turn(motors: &[Motor], raw: Option<Instant>, now: Instant, pace: Pace) -> Turn {
    let Pace {
        usual,
        period,
        query_was_last,
        just_freed,
        queries_from,
        silent_stop_round,
        drive_waits_for_proof,
    } = pace;
    let due = |at: Instant| now + EARLY >= at;
    let stop = next_stop(motors, silent_stop_round);
    if let Some((_, id, false)) = stop {
        return Turn::Now(Errand::Stop(id));
    }
    let stop = stop.map(|(at, id, _)| (at, Errand::Stop(id)));
    let switch = earliest(motors, |motor| match &motor.control {
        Control::Switching(switch) => switch.next_frame(),
        _ => None,
    })
    .map(|(at, id)| (at, Errand::Switch(id)));
    let drive = earliest(motors, |motor| match &motor.control {
        Control::Driven(driven) => Some(driven.next_frame),
        Control::Switching(switch) => switch.meanwhile.map(|meanwhile| meanwhile.next_frame),
        _ => None,
    })
    .map(|(at, id)| (at, Errand::Drive(id)));
    let query = next_query(motors);

    if let Some((_, errand)) = switch.filter(|(at, _)| due(*at)) {
        return Turn::Now(errand);
    }
    // A stop that goes on does not take the line from the motors that are driven beside it.
    let raw = raw.map(|at| (at, Errand::Raw));
    let frames = stop.into_iter().chain(drive).chain(raw);
    let frame = match stop.filter(|(at, _)| drive_waits_for_proof && due(*at)) {
        Some(stop) => Some(stop),
        None => frames.min_by_key(|(at, _)| *at),
    };
    let next_appointment = frame.into_iter().chain(switch).map(|(at, _)| at).min();

    // Right behind a reply a query makes the next frame least late.
    let squeezes = next_appointment.is_some_and(|at| at < now + usual);
    let waits = |frame: Option<(Instant, Errand)>| frame.is_some_and(|(at, _)| due(at));
    let its_turn = (just_freed || !squeezes) && !(query_was_last && (waits(drive) || waits(stop)));
    let has_waited = |at: Instant| now >= (at + QUERY_PATIENCE).max(queries_from);
    if let Some((_, id)) = query.filter(|(at, _)| its_turn && has_waited(*at)) {
        return Turn::Now(Errand::Query(id));
    }
    if let Some((_, errand)) = frame.filter(|(at, _)| due(*at)) {
        return Turn::Now(errand);
    }

    let driven = motors
        .iter()
        .filter(|motor| matches!(motor.control, Control::Driven(_)));
    let frames_a_period = u32::try_from(driven.count()).unwrap_or(u32::MAX).max(1);
    let margin = (period / 2 / frames_a_period).min(QUERY_MARGIN_MAX);
    let fits = next_appointment.is_none_or(|at| now + usual + margin <= at);
    let query_turn = query.map(|(at, id)| match (due(at.max(queries_from)), fits) {
        (true, true) => Turn::Now(Errand::Query(id)),
        // It goes behind the next reply.
        (true, false) if has_waited(at) => Turn::Never,
        (true, false) => Turn::At((at + QUERY_PATIENCE).max(queries_from)),
        (false, _) => Turn::At(at.max(queries_from)),
    });
    match (query_turn, next_appointment) {
        (Some(Turn::At(query_at)), Some(at)) => Turn::At(at.min(query_at)),
        (None | Some(Turn::Never), Some(at)) => Turn::At(at),
        (Some(turn), _) => turn,
        (None, None) => Turn::Never,
    }
}

/// The motor whose stop is furthest behind: of those that answer, none gets its next frame before all got
/// this one. With it, whether its first frame was sent.
///
/// A motor that does not answer costs a window each time. So between two of their frames, all that answer
/// get theirs: 15 motors without power do not let go of the 16th.
fn next_stop(motors: &[Motor], silent_round: u32) -> Option<(Instant, MotorId, bool)> {
    let furthest_behind = |of_silent: bool| {
        let stops = motors.iter().filter_map(|motor| match &motor.control {
            Control::Stopping(stop) if motor.is_without_answer() == of_silent => {
                Some((motor.id, stop))
            }
            _ => None,
        });
        stops.min_by_key(|(id, stop)| (stop.first_frame_sent, stop.round, *id))
    };
    let frame = |(id, stop): (MotorId, &Stopping)| (stop.next_frame, id, stop.first_frame_sent);
    match (furthest_behind(false), furthest_behind(true)) {
        (Some((id, answers)), Some((silent_id, silent))) => {
            // A motor that has joined since may be far behind the round that was noted.
            let is_round_over = answers.round >= silent_round || answers.round + 1 < silent_round;
            let has_its_turn = answers.first_frame_sent && is_round_over;
            let is_due = !silent.first_frame_sent || silent.next_frame <= answers.next_frame;
            let is_next = has_its_turn && is_due;
            Some(frame(if is_next {
                (silent_id, silent)
            } else {
                (id, answers)
            }))
        }
        (one, other) => one.or(other).map(frame),
    }
}

fn next_query(motors: &[Motor]) -> Option<(Instant, MotorId)> {
    earliest(motors, |motor| {
        // A stop asks for what it needs by itself.
        if let Control::Stopping(_) = motor.control {
            return None;
        }
        let patience = motor.next_query + QUERY_PATIENCE;
        let clear_at = motor
            .late
            .drive_expected_until()
            .unwrap_or(motor.next_query);
        Some(motor.next_query.max(clear_at.min(patience)))
    })
}

fn earliest(
    motors: &[Motor],
    at: impl Fn(&Motor) -> Option<Instant>,
) -> Option<(Instant, MotorId)> {
    motors
        .iter()
        .filter_map(|motor| Some((at(motor)?, motor.id)))
        .min()
}
