//! What the motor feels.

mod read_out;

use leptos::prelude::*;
use motorlink_messages::protocol::{Faults, MotorId};

use self::read_out::{ReadOut, Shown};
use super::wheel_panel::loop_name;
use crate::{
    desk::use_desk,
    format,
    session::{Angle, Reading, Session},
};

/// Region `Telemetry`.
#[component]
pub(crate) fn Telemetry() -> impl IntoView {
    let desk = use_desk();
    let mode = Memo::new(move |_| {
        let (id, asked) = (desk.selected.get(), desk.asked.get());
        desk.shown.with(|session| mode(session, id, asked))
    });
    view! {
        <section class="telemetry" aria-label="Telemetry">
            <ReadOut name="Speed" class="speed" shown=desk.of_motor(speed) />
            <ReadOut name="Current" class="current" shown=desk.of_motor(current) />
            <ReadOut name="Position" class="position" shown=desk.of_motor(position) />
            <ReadOut name="Temperature" class="temperature" shown=desk.of_motor(temperature) />
            <ReadOut name="Faults" class="faults" shown=desk.of_motor(faults) />
            <ReadOut name="Mode" class="mode" shown=mode />
        </section>
    }
}

fn speed(session: &Session, id: MotorId) -> Option<Shown> {
    let reading = session.speed(id)?;
    Some(Shown::new(&reading, format::speed(reading.value), "rpm"))
}

fn current(session: &Session, id: MotorId) -> Option<Shown> {
    let reading = session.current(id)?;
    Some(Shown::new(&reading, format::current(reading.value), "A"))
}

fn position(session: &Session, id: MotorId) -> Option<Shown> {
    let reading = session.angle(id)?;
    let degrees = format!("{:.1}", reading.value.degrees());
    let raw = match reading.value {
        Angle::Fine(position) => format!("raw {}", position.raw()),
        Angle::Coarse(position) => format!("raw {}/255", position.raw()),
    };
    Some(Shown::new(&reading, degrees, "°").with_detail(raw))
}

fn temperature(session: &Session, id: MotorId) -> Option<Shown> {
    let reading = session.temperature(id)?;
    let degrees = reading.value.degrees().to_string();
    Some(Shown::new(&reading, degrees, "°C"))
}

fn faults(session: &Session, id: MotorId) -> Option<Shown> {
    let reading: Reading<Faults> = session.faults(id)?;
    let byte = format!("0x{:02X}", reading.value.byte());
    let shown = Shown::new(
        &reading,
        format::capitalized(&reading.value.to_string()),
        "",
    );
    Some(if reading.value.is_none() {
        shown.with_detail(byte).good()
    } else {
        shown.with_detail(byte).bad()
    })
}

fn mode(
    session: &Session,
    id: MotorId,
    asked: Option<motorlink_messages::protocol::Mode>,
) -> Option<Shown> {
    let reading = session.mode(id)?;
    let shown = Shown::new(&reading, loop_name(reading.value).to_owned(), "");
    Some(match asked.filter(|asked| *asked != reading.value) {
        Some(asked) => shown.with_detail(format!("asked: {asked}")).bad(),
        None => shown,
    })
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::Mode;

    use super::*;
    use crate::session::tests::{ID, session, status};

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
        assert_eq!(text(temperature(&session, ID)), "33°C ");
        assert_eq!(text(faults(&session, ID)), "OK 0x00");
        let sample = session.motors[0].last.as_mut().unwrap();
        sample.reply.faults = Faults::from_byte(0x18);
        assert_eq!(text(faults(&session, ID)), "Stall, over-temperature 0x18");
    }

    #[test]
    fn a_loop_that_was_not_asked_for_is_marked() {
        let session = session(1_016, status(1_000, Mode::Velocity, 0));
        assert_eq!(
            text(mode(&session, ID, Some(Mode::Position))),
            "Velocity loop asked: position loop"
        );
        let shown = mode(&session, ID, Some(Mode::Velocity));
        assert_eq!(text(shown), "Velocity loop ");
    }

    #[test]
    fn what_was_never_reported_is_not_shown_as_zero() {
        let nothing = Session::default();
        assert!(speed(&nothing, ID).is_none() && temperature(&nothing, ID).is_none());
    }
}
