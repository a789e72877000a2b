//! The telemetry of the selected motor.

pub(crate) mod angle_dial;
pub(crate) mod fault_history;
pub(crate) mod fault_record;
pub(crate) mod gauge;
pub(crate) mod instruments;
pub(crate) mod read_out;
pub(crate) mod readings;
pub(crate) mod recent;
pub(crate) mod scale;
pub(crate) mod sparkline;
pub mod twin;

use leptos::{html, prelude::*};
use motorlink_i18n::{
    terms::{self, in_language},
    tr,
};
use motorlink_messages::{
    bus::{Activity, MotorStatus},
    protocol::{Angle, Faults, Mode, MotorId, Setpoint},
};

use self::{
    fault_record::FaultRecord,
    read_out::{ReadOut, Shown},
};
use crate::{
    features::telemetry::{readings::Readings, twin::turns_text},
    model::{
        heat::Band,
        snapshot::{Reading, Session},
        terms::loop_name,
    },
    ui::{format, reactive::memo},
};

/// Region `Telemetry`.
#[component]
pub(crate) fn Telemetry(readings: Readings) -> impl IntoView {
    let page = readings.page;
    let mode = memo(move || {
        let id = page.selected.get();
        page.shown.with(|session| mode(session, id))
    });
    let section = NodeRef::<html::Section>::new();
    instruments::draw_on_change(readings, section);
    view! {
        <section class="telemetry" aria-label=tr!("Telemetry") node_ref=section>
            <ReadOut
                name=tr!("Speed")
                class="speed"
                shown=page.of_motor(speed)
                drawing=instruments::sparkline_markup()
            />
            <ReadOut
                name=tr!("Current" as "electric")
                class="current"
                shown=page.of_motor(current)
                drawing=instruments::sparkline_markup()
            />
            <ReadOut
                name=tr!("Position")
                class="position"
                shown=page.of_motor(position)
                drawing=angle_dial::MARKUP
            />
            <ReadOut
                name=tr!("Temperature")
                class="temperature"
                shown=page.of_motor(move |session, id| {
                    let limits = page.preferences.with(|chosen| chosen.limits);
                    temperature(session, id, limits.temperature_c())
                })
                drawing=gauge::MARKUP
            />
            <ReadOut name=tr!("Faults") class="faults" shown=page.of_motor(faults) drawing="" />
            <FaultRecord readings />
            <ReadOut name=tr!("Mode") class="mode" shown=mode drawing="" />
        </section>
    }
}

fn speed(session: &Session, id: MotorId) -> Option<Shown> {
    let reading = session.speed(id)?;
    let shown = Shown::new(&reading, format::speed(reading.value), format::rpm());
    Some(shown.with_detail(mirrored(session, id)))
}

fn current(session: &Session, id: MotorId) -> Option<Shown> {
    let reading = session.current(id)?;
    let is_certain = session.is_current_certain();
    let (figure, unit) = format::current_in(reading.value, is_certain);
    let shown = Shown::new(&reading, figure, unit);
    let mirrored = mirrored(session, id);
    if is_certain {
        return Some(shown.with_detail(mirrored));
    }
    let words = [tr!("scale uncertain"), &mirrored].join("\n");
    let shown = shown.with_detail(words.trim_end().to_owned());
    Some(shown.with_hint(tr!(
        "Sources disagree about the unit of this model's current: 8 A or 3.28 A at 32\u{202F}767."
    )))
}

/// The mark beside a value with the reversed sign.
fn mirrored(session: &Session, id: MotorId) -> String {
    let word = session.mirror(id).is_mirrored().then(|| tr!("mirrored"));
    word.unwrap_or_default().to_owned()
}

fn position(session: &Session, id: MotorId) -> Option<Shown> {
    let reading = session.angle(id)?;
    let degrees = in_language(format::fixed(reading.value.degrees(), 1));
    let raw = match reading.value {
        Angle::Fine(position) => tr!("raw {position}", position = position.raw()),
        Angle::Coarse(position) => tr!("raw {position}/255", position = position.raw()),
    };
    let turns = session.motor(id).and_then(|motor| motor.turns);
    let detail = match turns {
        Some(turns) => format!("{raw}\n{}", turns_text(turns.tenths())),
        None => raw,
    };
    Some(Shown::new(&reading, degrees, "°").with_detail(detail))
}

fn temperature(session: &Session, id: MotorId, limit_c: u16) -> Option<Shown> {
    let reading = session.temperature(id)?;
    let degrees = reading.value.degrees().to_string();
    let band = Band::of(reading.value);
    let shown = Shown::new(&reading, degrees, "°C").with_detail(band.words(limit_c));
    Some(match band {
        Band::Normal => shown,
        Band::Warm => shown.warm(),
        Band::Hot => shown.bad(),
    })
}

fn faults(session: &Session, id: MotorId) -> Option<Shown> {
    let reading: Reading<Faults> = session.faults(id)?;
    let byte = format!("0x{:02X}", reading.value.byte());
    let shown = Shown::new(
        &reading,
        format::capitalized(&terms::faults(reading.value)),
        "",
    );
    Some(if reading.value.is_none() {
        shown.with_detail(byte).good()
    } else {
        shown.with_detail(byte).bad()
    })
}

fn mode(session: &Session, id: MotorId) -> Option<Shown> {
    let reading = session.mode(id)?;
    let asked = session.motor(id).and_then(next_loop);
    let shown = Shown::new(&reading, loop_name(reading.value).to_owned(), "");
    Some(match asked.filter(|asked| *asked != reading.value) {
        Some(asked) => shown.with_detail(tr!("target: {mode}", mode = terms::mode(asked))),
        None => shown,
    })
}

/// The loop that a motor is being switched to, or will be.
fn next_loop(motor: &MotorStatus) -> Option<Mode> {
    match motor.activity {
        Activity::Switching { to } => Some(to),
        _ => motor.waiting.map(Setpoint::mode),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        bus::{LineStatus, Turns},
        protocol::{Celsius, PositionTarget, family::Model},
    };

    use super::*;
    use crate::model::snapshot::tests::{ID, session, status};

    fn text(shown: Option<Shown>) -> String {
        let shown = shown.unwrap();
        format!("{}{} {}", shown.figure, shown.unit, shown.detail)
    }

    #[test]
    fn read_outs_say_what_the_motor_reports() {
        let mut session = session(1_016, status(1_000, Mode::Velocity, -100));
        assert_eq!(text(speed(&session, ID)), "\u{2212}100rpm ");
        assert_eq!(text(current(&session, ID)), "+0.02A ");
        assert_eq!(text(position(&session, ID)), "66.4° raw 47/255");
        let mut mirrored = session.clone();
        mirrored.mirrored.push(ID);
        assert_eq!(text(speed(&mirrored, ID)), "\u{2212}100rpm mirrored");
        assert_eq!(text(current(&mirrored, ID)), "+0.02A mirrored");
        session.motors[0].turns = Some(Turns::new(12.4));
        let with_turns = "66.4° raw 47/255\n+12.4 turns";
        assert_eq!(text(position(&session, ID)), with_turns);
        assert_eq!(text(temperature(&session, ID, 75)), "33°C limit 75 °C");
        assert_eq!(text(faults(&session, ID)), "OK 0x00");
        let sample = session.motors[0].last.as_mut().unwrap();
        sample.reply.faults = Faults::from_byte(0x18);
        assert_eq!(text(faults(&session, ID)), "Stall, over-temperature 0x18");
    }

    #[test]
    fn a_current_of_uncertain_scale_is_shown_raw_and_says_so() {
        let mut session = session(1_016, status(1_000, Mode::Velocity, 0));
        session.line = Some(LineStatus {
            model: Model::Ddsm210,
            ..LineStatus::default()
        });
        let shown = current(&session, ID);
        assert!(shown.as_ref().unwrap().hint.contains("3.28 A"));
        assert_eq!(text(shown), "+100raw scale uncertain");
        session.mirrored.push(ID);
        assert_eq!(
            text(current(&session, ID)),
            "+100raw scale uncertain\nmirrored"
        );
    }

    #[test]
    fn a_hot_winding_is_told_by_its_look_and_in_words() {
        for (degrees, look, words) in [
            (69, "", "limit 75 °C"),
            (70, "warm", "warm\nlimit 75 °C"),
            (79, "warm", "warm\nlimit 75 °C"),
            (80, "bad", "too hot\nlimit 75 °C"),
        ] {
            let mut motor = status(1_000, Mode::Velocity, 0);
            motor.temperature = motor.temperature.map(|(at, _)| (at, Celsius::new(degrees)));
            let shown = temperature(&session(1_016, motor), ID, 75).unwrap();
            let noted = if words.is_empty() { "" } else { " noted" };
            assert_eq!(shown.classes(), [look, noted]);
            assert_eq!(shown.detail, words);
        }
    }

    #[test]
    fn the_loop_that_comes_next_is_named() {
        let mut session = session(1_016, status(1_000, Mode::Velocity, 0));
        assert_eq!(text(mode(&session, ID)), "Velocity loop ");
        session.motors[0].activity = Activity::Switching { to: Mode::Position };
        let waits_for_position = "Velocity loop target: position loop";
        assert_eq!(text(mode(&session, ID)), waits_for_position);
        session.motors[0].activity = Activity::Stopping { confirmed: false };
        session.motors[0].waiting = Some(Setpoint::Position(PositionTarget::default()));
        assert_eq!(text(mode(&session, ID)), waits_for_position);
    }

    #[test]
    fn what_was_never_reported_is_not_shown_as_zero() {
        let nothing = Session::default();
        assert!(speed(&nothing, ID).is_none() && temperature(&nothing, ID, 75).is_none());
    }
}
