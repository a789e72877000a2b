//! The terms of the bus in the language that is spoken. Its own crate says them in English, for other
//! programs.

pub(crate) use motorlink_i18n::terms::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::Mode;
use motorlink_messages::{
    Adapter,
    bus::{Crossed, NotTogether, Refusal, Together},
};

use crate::ui::format;

/// `CH340 · 1a86:7523`
pub(crate) fn adapter(adapter: Adapter) -> String {
    match adapter {
        Adapter::Virtual => tr!("Virtual motor").to_owned(),
        Adapter::Serial(None) => tr!("Serial port").to_owned(),
        // By its make, which is a name.
        named @ Adapter::Serial(Some(_)) => named.to_string(),
    }
}

/// What a limit was crossed by.
pub(crate) fn crossed(crossed: Crossed) -> String {
    match crossed {
        // Without a sign, which a mirrored motor has the other way round.
        Crossed::Speed { reached, limit } => tr!(
            "{reached} rpm, above your limit of {limit} rpm",
            reached = reached.magnitude(),
            limit
        ),
        Crossed::Current { reached, limit } => tr!(
            "{reached} A, above your limit of {limit} A",
            reached = in_language(reached.scaled().to_string()),
            limit = format::milliamps(limit)
        ),
        Crossed::Temperature { reached, limit } => tr!(
            "{reached} °C, above your limit of {limit} °C",
            reached = reached.degrees(),
            limit
        ),
    }
}

/// Why motors cannot be driven as one.
pub(crate) fn not_together(why: NotTogether) -> String {
    match why {
        NotTogether::Nobody => tr!("No motor is chosen.").to_owned(),
        NotTogether::TooMany => tr!(
            "At most {count} motors are driven together.",
            count = Together::MAX
        ),
        NotTogether::Twice(id) => tr!("Motor {id} is named twice.", id),
    }
}

/// Why the bus does not do what was asked.
pub(crate) fn refusal(refusal: Refusal) -> String {
    match refusal {
        Refusal::Halted => tr!("All motors are stopped. Press Release to drive again.").to_owned(),
        Refusal::NotHeard(id) => tr!(
            "Motor {id} has not answered, so its loop is not known. Check its power and ID.",
            id
        ),
        Refusal::OtherLoop {
            id,
            asked,
            reported,
        } => tr!(
            "Motor {id} reports the {reported}. Switch it to the {asked} first.",
            id,
            reported = mode(reported),
            asked = mode(asked)
        ),
        Refusal::SpeedUnknown(id) => tr!(
            "The position loop needs a known speed, and motor {id} has reported none in the last 500 ms.",
            id
        ),
        Refusal::TooFast(speed) => tr!(
            "The position loop needs less than 10 rpm; the wheel turns at {speed}. Stop it first.",
            speed = format!("{} rpm", format::speed(speed))
        ),
        Refusal::FaultActive { id, faults } => tr!(
            "Motor {id} reports {faults} and ignores commands until that clears. Press again then.",
            id,
            faults = motorlink_i18n::terms::faults(faults)
        ),
        Refusal::NeedsConsent(current) => tr!(
            "{current} is above 6.1 A: confirm that it is meant.",
            current = format::amps_of(current)
        ),
        Refusal::AboveSpeedLimit(limit) => tr!(
            "That is above your speed limit of {limit} rpm. Ask for less, or raise the limit.",
            limit
        ),
        Refusal::TooHot { id, crossed } => tr!(
            "Motor {id} has {crossed}. Let it cool, or raise the limit.",
            id,
            crossed = self::crossed(crossed)
        ),
        Refusal::Stopping(id) => tr!(
            "Motor {id} is being stopped. Press again when it stands.",
            id
        ),
        Refusal::NotHolding(id) => tr!(
            "Motor {id} is not driven in the position loop: there is nothing to stop.",
            id
        ),
        Refusal::NotDriven(id) => tr!("Motor {id} is not driven. Press Start.", id),
        Refusal::PageSilent => {
            tr!("The page had stopped answering when this was pressed. Press again.").to_owned()
        }
        Refusal::Together(id) => tr!(
            "Motor {id} is driven together with others. Stop them first.",
            id
        ),
        Refusal::Switching(id) => tr!(
            "Motor {id} is changing its loop. Press again when it has.",
            id
        ),
        Refusal::Driven(id) => tr!("Motor {id} is driven. Stop it first.", id),
        Refusal::Surveying => {
            tr!("The bus is being scanned. Wait for its end, or cancel it.").to_owned()
        }
        Refusal::NotProvedAlone => tr!(
            "An ID is set on every motor that hears it. Make a full scan first: it has to find exactly one motor."
        )
        .to_owned(),
        Refusal::SameId(id) => tr!("The motor has ID {id} already.", id),
        Refusal::RawRunning => {
            tr!("A raw frame is being repeated. Stop that first.").to_owned()
        }
        Refusal::ReversesTorque(id) => tr!(
            "Motor {id} may still follow the opposite current. Send it 0 first.",
            id
        ),
        Refusal::NotAssignable(id) => tr!(
            "No motor may have ID {id}: no scan finds 0x00 and 0xFF, and 0xC8 starts the ID query. Use another.",
            id = format!("0x{id:02X}")
        ),
    }
}

/// The name of a loop, as a heading.
pub(crate) fn loop_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Current => tr!("Current loop"),
        Mode::Velocity => tr!("Velocity loop"),
        Mode::Position => tr!("Position loop"),
    }
}
