//! What is said about each wheel.

use motorlink_i18n::{terms, tr};
use motorlink_messages::protocol::MotorId;

use crate::{
    model::{
        heat::Band,
        snapshot::{Reading, Session},
        terms::trouble_of_replies,
    },
    ui::format::{self, UNKNOWN},
};

/// The texts of a wheel's card.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Card {
    /// In rpm; + is forward.
    pub(crate) speed: String,
    /// Current and temperature.
    pub(crate) rest: String,
    /// What is wrong, if anything is.
    pub(crate) trouble: String,
    /// The look of card and wheel.
    pub(crate) look: &'static str,
}

/// The card of a wheel. The session has the operator's signs.
pub(crate) fn card(session: &Session, id: MotorId) -> Card {
    let speed = session.speed(id).filter(Reading::is_fresh);
    let shown = |value: Option<String>| value.unwrap_or_else(|| UNKNOWN.to_owned());
    let amps = session.current(id).filter(Reading::is_fresh);
    let amps = amps.map(|reading| format::current(reading.value));
    let temperature = session.temperature(id);
    let degrees = temperature.map(|reading| reading.value.degrees().to_string());
    let faults = session.faults(id).filter(Reading::is_fresh);
    let faults = faults.filter(|faults| !faults.value.is_none());
    let band = temperature.map(|reading| Band::of(reading.value));
    let (trouble, look) = match (speed, faults, band) {
        (None, ..) => {
            let of_motor = session.motor(id);
            let words = of_motor.and_then(|it| trouble_of_replies(it.answer));
            (words.unwrap_or(tr!("No reply")).to_owned(), "lost")
        }
        (_, Some(faults), _) => (terms::faults(faults.value), "fault"),
        (_, _, Some(Band::Hot)) => (tr!("too hot").to_owned(), "hot"),
        (_, _, Some(Band::Warm)) => (tr!("warm").to_owned(), "warm"),
        _ => (String::new(), "good"),
    };
    Card {
        speed: shown(speed.map(|reading| format::speed(reading.value))),
        rest: format!("{} A · {} °C", shown(amps), shown(degrees)),
        trouble: format::capitalized(&trouble),
        look,
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use motorlink_messages::{
        bus::Answer,
        protocol::{Celsius, Faults, Mode},
    };

    use super::*;
    use crate::model::{
        names_and_sides::Side,
        snapshot::tests::{ID, session, status},
    };

    fn texts(card: &Card) -> (&str, &str, &str, &str) {
        (&card.speed, &card.rest, &card.trouble, card.look)
    }

    #[test]
    fn a_wheel_reads_forward_as_plus_on_either_side() {
        let session = session(1_016, status(1_000, Mode::Velocity, -100));
        let now = card(&session, ID);
        assert_eq!(texts(&now), ("\u{2212}100", "+0.02 A · 33 °C", "", "good"));
        let mut names = crate::model::names_and_sides::NamesAndSides::default();
        names.change(ID, |member| member.side = Side::Right);
        let mirrored = card(&session.with_mirroring(&names), ID);
        assert_eq!(mirrored.speed, "+100");
    }

    #[test]
    fn heat_and_faults_are_told_in_words_and_by_the_look() {
        let of = |degrees, faults| {
            let mut motor = status(1_000, Mode::Velocity, 0);
            motor.temperature = motor.temperature.map(|(at, _)| (at, Celsius::new(degrees)));
            motor.last.as_mut().unwrap().reply.faults = Faults::from_byte(faults);
            let card = card(&session(1_016, motor), ID);
            (card.trouble, card.look)
        };
        assert_eq!(of(69, 0), (String::new(), "good"));
        assert_eq!(of(70, 0), ("Warm".to_owned(), "warm"));
        assert_eq!(of(80, 0), ("Too hot".to_owned(), "hot"));
        assert_eq!(of(80, 8), ("Stall".to_owned(), "fault"));
    }

    #[test]
    fn what_is_no_longer_reported_is_unknown() {
        let mut session = session(1_016, status(1_000, Mode::Velocity, 100));
        session.now = session.now + Duration::from_secs(1);
        let old = card(&session, ID);
        assert_eq!(texts(&old), ("–", "– A · 33 °C", "No reply", "lost"));
        session.motors[0].answer = Answer::Corrupted;
        assert_eq!(card(&session, ID).trouble, "Bad replies");
        assert_eq!(card(&Session::default(), ID).rest, "– A · – °C");
    }
}
