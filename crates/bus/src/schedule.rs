//! Schedule: which frame goes out next.

use std::time::Duration;

use motorlink_protocol::{AssignableId, Instant, MotorId};

use crate::{
    motor::{Control, Motor},
    probe::Probe,
    silence::Silence,
    stop::Stopping,
    timing::{DRIVE_WAITS_FOR_STOPS_MAX, EARLY, QUERY_MARGIN_MAX, QUERY_PATIENCE, TEMPERATURE_OLD},
};

/// When the next frame goes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// Send this frame now.
    Now(DueFrame),
    /// Nothing is due before this.
    At(Instant),
    /// Nothing is scheduled.
    Never,
}

/// A frame that is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DueFrame {
    /// The next frame of this motor's stop.
    Stop(MotorId),
    /// The next frame of this motor's mode switch.
    Switch(MotorId),
    /// This motor's setpoint, or the neutral frame during a mode switch.
    Drive(MotorId),
    /// This motor's telemetry.
    Query(MotorId),
    /// The loop of a motor with separate frames, before its next drive frame.
    LoopQuery(MotorId),
    /// The ID query.
    IdQuery,
    /// The next probe of a scan or an ID change.
    Probe(Probe),
    /// The next set-ID frame.
    SetId(AssignableId),
    /// The raw frame.
    Raw,
}

/// The kind of the last sent frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LastFrame {
    /// A query, maybe followed by mode switches. A second query must not delay a drive frame.
    Query,
    /// A frame of a stop.
    Stop,
    Other,
}

/// Pacing of the line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pacing {
    /// How long an exchange usually takes.
    pub(crate) usual: Duration,
    /// Time between two drive frames to one motor.
    pub(crate) period: Duration,
    pub(crate) last_frame: LastFrame,
    /// Whether the last exchange has just ended.
    pub(crate) just_freed: bool,
    /// Earliest time of the next query.
    pub(crate) queries_from: Instant,
    /// A silent motor gets its next stop frame after every answering motor has got one since then.
    pub(crate) silent_stopped: Option<Instant>,
    /// Whether nothing but the stop goes out, no query either.
    pub(crate) stops_first: bool,
    /// Whether drive frames wait for a byte that proves that the line carried the last one. Stop
    /// frames do not wait.
    pub(crate) drive_waits_for_proof: bool,
}

/// Picks the next frame. The first frame of a stop goes before everything; then mode switches,
/// queries that have waited too long, stop and drive frames by deadline, and queries that delay no
/// drive frame. A stop that a motor may not have got goes before drive frames.
///
/// `raw` is when the raw frame is due; it is scheduled like a drive frame.
pub(crate) fn next_turn(
    motors: &[Motor],
    raw: Option<Instant>,
    now: Instant,
    pacing: Pacing,
) -> Turn {
    let Pacing {
        usual,
        period,
        last_frame,
        just_freed,
        queries_from,
        silent_stopped,
        stops_first,
        drive_waits_for_proof,
    } = pacing;
    let due = |at: Instant| now + EARLY >= at;
    let stop = next_stop(motors, silent_stopped, now);
    if let Some((_, id, false)) = stop {
        return Turn::Now(DueFrame::Stop(id));
    }
    let stop = stop.map(|(at, id, _)| (at, DueFrame::Stop(id)));
    let switch = earliest(motors, |motor| match &motor.control {
        Control::Switching(switch) => switch.next_frame(),
        _ => None,
    })
    .map(|(at, id)| (at, DueFrame::Switch(id)));
    let driven = motors.iter().filter(|motor| motor.is_driven());
    let driven = u32::try_from(driven.count()).unwrap_or(u32::MAX);
    let unasked_until = unasked_until(motors);
    let may_ask = unasked_until.is_none_or(|until| now >= until);
    let asks_instead = |motor: &Motor| {
        let until = motor.asks_instead_until(now, driven);
        until.filter(|_| may_ask)
    };
    let drive = earliest(motors, |motor| match &motor.control {
        Control::Driven(driven) => {
            let due = driven.frame_due();
            Some(asks_instead(motor).map_or(due, |until| until.max(due)))
        }
        Control::Switching(switch) => switch
            .neutral_drive
            .map(|neutral_drive| neutral_drive.next_frame),
        _ => None,
    })
    .map(|(at, id)| (at, DueFrame::Drive(id)));
    let urgent = motors.iter().find(|motor| asks_instead(motor).is_some());
    let regular = next_query(motors).filter(|_| !stops_first);
    // Queries in a row do not keep the other motors from their own.
    let another_waits = |urgent: &Motor| {
        regular.is_some_and(|(at, id)| id != urgent.id && now >= at + TEMPERATURE_OLD)
    };
    let waiting = regular.map(|(at, id)| (unasked_until.map_or(at, |until| until.max(at)), id));
    let (query, queries_from) = match urgent {
        Some(urgent) if !another_waits(urgent) => (Some((now - QUERY_PATIENCE, urgent.id)), now),
        // Queries of urgent motors do not delay the query of the motor that waits.
        Some(_) => (waiting, now),
        None => (waiting, queries_from),
    };

    // The reply window of a silent motor may be as long as the time between its frames. So at most one switch or
    // query goes between two stop frames.
    let stop_is_next = last_frame != LastFrame::Stop && stop.is_some_and(|(at, _)| due(at));
    if let Some((_, due_frame)) = switch.filter(|(at, _)| due(*at) && !stop_is_next) {
        return Turn::Now(due_frame);
    }
    // A running stop does not take the line from driven motors, unless a motor may have got none of its frames, so that
    // its wheel keeps turning. Queries go between: the temperature is a limit too.
    let drive_has_waited = drive.is_some_and(|(at, _)| now >= at + DRIVE_WAITS_FOR_STOPS_MAX);
    let may_keep_turning = || motors.iter().any(may_have_got_no_stop);
    let stop_before_drive = drive_waits_for_proof || !drive_has_waited && may_keep_turning();
    let raw = raw.map(|at| (at, DueFrame::Raw));
    let frames = stop.into_iter().chain(drive).chain(raw);
    let frame = match stop.filter(|(at, _)| stop_before_drive && due(*at)) {
        Some(stop) => Some(stop),
        None => frames.min_by_key(|(at, _)| *at),
    };
    let next_appointment = frame.into_iter().chain(switch).map(|(at, _)| at).min();

    // Right after a reply a query delays the next frame least.
    let squeezes = next_appointment.is_some_and(|at| at < now + usual);
    let waits = |frame: Option<(Instant, DueFrame)>| frame.is_some_and(|(at, _)| due(at));
    let its_turn = (just_freed || !squeezes)
        && !stop_is_next
        && !(last_frame == LastFrame::Query && (waits(drive) || waits(stop)));
    let has_waited = |at: Instant| now >= (at + QUERY_PATIENCE).max(queries_from);
    if let Some((_, id)) = query.filter(|(at, _)| its_turn && has_waited(*at)) {
        return Turn::Now(DueFrame::Query(id));
    }
    if let Some((_, due_frame)) = frame.filter(|(at, _)| due(*at)) {
        return Turn::Now(due_frame);
    }

    let margin = (period / 2 / driven.max(1)).min(QUERY_MARGIN_MAX);
    let fits = next_appointment.is_none_or(|at| now + usual + margin <= at);
    let query_turn = query.map(|(at, id)| match (due(at.max(queries_from)), fits) {
        (true, true) => Turn::Now(DueFrame::Query(id)),
        // It goes after the next reply.
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

/// The next frame of a stop, and whether the first frame was sent. Of the answering motors whose
/// frame is due, the one whose last frame is the oldest is next, also if it was silent or joins later.
///
/// A silent motor costs a reply window each time. So all answering motors get their frame between
/// two frames of silent ones: 15 motors without power do not release the 16th.
fn next_stop(
    motors: &[Motor],
    silent_stopped: Option<Instant>,
    now: Instant,
) -> Option<(Instant, MotorId, bool)> {
    let longest_without = |of_silent: bool| {
        let stops = motors.iter().filter_map(|motor| match &motor.control {
            Control::Stopping(stop) if motor.is_without_answer() == of_silent => {
                Some((motor.id, stop))
            }
            _ => None,
        });
        // A motor without a frame comes first.
        stops.min_by_key(|(id, stop)| (stop.next_frame.max(now), stop.last_sent(), *id))
    };
    let frame =
        |(id, stop): (MotorId, &Stopping)| (stop.next_frame, id, stop.last_sent().is_some());
    match (longest_without(false), longest_without(true)) {
        (Some((id, answers)), Some((silent_id, silent))) => {
            let has_its_turn = answers.last_sent() > silent_stopped;
            let is_due = silent.last_sent().is_none() || silent.next_frame <= answers.next_frame;
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

/// Whether this motor may have got no frame of its stop. A motor that is known not to answer does not take the line from
/// driven motors.
fn may_have_got_no_stop(motor: &Motor) -> bool {
    match &motor.control {
        Control::Stopping(stop) => !motor.is_without_answer() && stop.may_have_got_nothing(),
        _ => false,
    }
}

/// Until when the line carries no query.
fn unasked_until(motors: &[Motor]) -> Option<Instant> {
    let silences = motors.iter().filter_map(Motor::silence);
    silences.filter_map(Silence::unasked_until).max()
}

/// The motor that has waited longest for its query, and since when.
fn next_query(motors: &[Motor]) -> Option<(Instant, MotorId)> {
    earliest(motors, |motor| {
        // A stop queries the motor by itself.
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

#[cfg(test)]
#[path = "schedule_tests.rs"]
mod tests;
