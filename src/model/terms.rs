//! The terms of the bus in the current language. `motorlink-bus` has them in English for other programs.

pub(crate) use motorlink_i18n::terms::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    Adapter,
    bus::{Answer, ExceededLimit, GroupError, GroupSetpoints, Refusal},
    experiments::analysis::WhenSilent,
    protocol::{Mode, MotorId, family::Model},
};

use crate::ui::format;

/// `CH340 · 1a86:7523`
pub(crate) fn adapter(adapter: Adapter) -> String {
    match adapter {
        Adapter::VIRTUAL => tr!("Virtual motor").to_owned(),
        Adapter::Virtual(line) => tr!(
            "{count} virtual {model}",
            count = line.count(),
            model = line.model.spec().name
        ),
        Adapter::Serial(None) => tr!("Serial port").to_owned(),
        // Named by its manufacturer.
        named => named.to_string(),
    }
}

/// `0x01, 0x07`
pub(crate) fn ids(ids: &[MotorId]) -> String {
    let ids: Vec<String> = ids.iter().map(MotorId::to_string).collect();
    ids.join(", ")
}

/// These motors have stopped, and have confirmed it.
pub(crate) fn stopped(motors: &[MotorId]) -> String {
    tr!(
        "Stopped, standstill confirmed: {motors}",
        motors = ids(motors)
    )
}

/// What is wrong with the replies of a motor; `None` if they come.
pub(crate) fn trouble_of_replies(answer: Answer) -> Option<&'static str> {
    match answer {
        Answer::Comes => None,
        Answer::Missing => Some(tr!("No reply")),
        Answer::Corrupted => Some(tr!("Bad replies")),
    }
}

/// An exceeded limit, with the reported value.
pub(crate) fn exceeded_limit(exceeded: ExceededLimit) -> String {
    match exceeded {
        // Without a sign, because a mirrored motor has the opposite one.
        ExceededLimit::Speed { reached, limit } => tr!(
            "{reached} rpm, above your limit of {limit} rpm",
            reached = reached.magnitude(),
            limit
        ),
        ExceededLimit::Current { reached, limit } => tr!(
            "{reached} A, above your limit of {limit} A",
            reached = in_language(reached.scaled().to_string()),
            limit = format::milliamps(limit)
        ),
        ExceededLimit::Temperature { reached, limit } => tr!(
            "{reached} °C, above your limit of {limit} °C",
            reached = reached.degrees(),
            limit
        ),
    }
}

/// The name of the test of what a motor does then.
pub(crate) fn when_frames_cease() -> &'static str {
    tr!("When frames cease")
}

/// What a motor was measured to do when frames cease.
pub(crate) fn when_silent(it: WhenSilent) -> &'static str {
    match it {
        WhenSilent::Keeps => tr!("keeps its last command"),
        WhenSilent::Coasts => tr!("coasts"),
        WhenSilent::Brakes => tr!("brakes" as "the motor"),
    }
}

/// Why motors cannot be driven as a group.
pub(crate) fn not_together(why: GroupError) -> String {
    match why {
        GroupError::Empty => tr!("No motor is selected.").to_owned(),
        GroupError::TooMany => tr!(
            "A group has at most {count} motors.",
            count = GroupSetpoints::MAX
        ),
        GroupError::Duplicate(id) => tr!("Motor {id} is listed twice.", id),
    }
}

/// Why the bus refuses a command.
pub(crate) fn refusal(refusal: Refusal) -> String {
    match refusal {
        Refusal::Halted => tr!("STOP is active. Press Release to drive again.").to_owned(),
        Refusal::NotAnswering(id) => tr!(
            "Motor {id} has not replied, so its loop is unknown. Check its power and ID.",
            id
        ),
        Refusal::OtherLoop {
            id,
            asked,
            reported,
        } => tr!(
            "Motor {id} is in the {reported}. Switch it to the {asked} first.",
            id,
            reported = mode(reported),
            asked = mode(asked)
        ),
        Refusal::SpeedUnknown(id) => tr!(
            "The position loop needs a known speed. Motor {id} has reported none for 500 ms: check \
             the link.",
            id
        ),
        Refusal::TooFast(speed) => tr!(
            "The wheel turns at {speed}. The position loop needs less than 10 rpm: stop the motor \
             first.",
            speed = format::speed_in_rpm(speed)
        ),
        Refusal::FaultActive { id, faults } => tr!(
            "Motor {id} reports a fault ({faults}) and ignores commands. When the fault clears, \
             press again.",
            id,
            faults = motorlink_i18n::terms::faults(faults)
        ),
        Refusal::NeedsConsent(current) => tr!(
            "{current} is above 6.1 A. Confirm to continue.",
            current = format::amps_of(current)
        ),
        Refusal::AboveSpeedLimit(limit) => tr!(
            "Above your speed limit of {limit} rpm. Lower the target, or raise the limit.",
            limit
        ),
        Refusal::TooHot { id, exceeded } => tr!(
            "Motor {id} is at {crossed}. Let it cool, or raise the limit.",
            id,
            crossed = exceeded_limit(exceeded)
        ),
        Refusal::Stopping(id) => tr!(
            "Motor {id} is stopping. Press again when it has stopped.",
            id
        ),
        Refusal::NotStopped(id) => tr!("Motor {id} has not confirmed standstill.", id),
        Refusal::NotHolding(id) => tr!(
            "Motor {id} is not running in the position loop: nothing to stop.",
            id
        ),
        Refusal::NotDriven(id) => tr!("Motor {id} is not running. Press Start.", id),
        Refusal::PageSilent => tr!("The page was not responding. Press again.").to_owned(),
        Refusal::InGroup(id) => tr!(
            "Motor {id} is running in a group. Stop the group first.",
            id
        ),
        Refusal::Switching(id) => tr!("Motor {id} is switching loops. Press again afterwards.", id),
        Refusal::Driven(id) => tr!("Motor {id} is running. Stop it first.", id),
        Refusal::JobRunning => {
            tr!("A bus scan is running. Wait until it ends, or cancel it.").to_owned()
        }
        Refusal::NotProvedAlone => tr!(
            "Setting an ID affects every motor on the bus. Run a full scan first: it must find \
             exactly one motor."
        )
        .to_owned(),
        Refusal::SameId(id) => tr!("The motor already has ID {id}.", id),
        Refusal::RawRunning => tr!("A raw frame is repeating. Stop it first.").to_owned(),
        Refusal::ReversesTorque(id) => tr!(
            "Motor {id} may still run at the opposite current. Send 0 first.",
            id
        ),
        Refusal::NoSuchLoop { model, mode: asked } => tr!(
            "A {model} has no {mode}. Choose another loop.",
            model,
            mode = mode(asked)
        ),
        Refusal::AboveSpeedOfModel(model) => tr!(
            "A {model} takes at most {speed} rpm. Set less.",
            model,
            speed = model.spec().speed_rpm_max
        ),
        Refusal::StopsFirst => tr!(
            "Motors that were running when the connection was lost are being stopped. Press again \
             when they stand."
        )
        .to_owned(),
        Refusal::OtherModel { expected, found } => other_model(expected, found),
        Refusal::NotAssignable(id) => tr!(
            "ID {id} is not allowed: a scan cannot find 0x00 or 0xFF, and 0xC8 is reserved for the \
             ID query. Use another ID.",
            id = format!("0x{id:02X}")
        ),
    }
}

/// A motor of another model answers.
pub(crate) fn other_model(expected: Model, found: Model) -> String {
    tr!(
        "A {found} answers on this line, not a {expected}. Choose {found} under Model, or \
         remove it and press Release.",
        expected,
        found
    )
}

/// The name of a loop, as a heading.
pub(crate) fn loop_name(mode: Mode) -> &'static str {
    match mode {
        Mode::OpenLoop => tr!("Open loop"),
        Mode::Current => tr!("Current loop"),
        Mode::Velocity => tr!("Velocity loop"),
        Mode::Position => tr!("Position loop"),
    }
}
