//! `/events`: events between frames.

use motorlink_bus::StopOutcome;
use motorlink_protocol::{Instant, MotorId, Rpm};
use nojson::{DisplayJson, JsonFormatter, RawJson, RawJsonValue};

use super::integer;
use crate::record::{Event, EventKind};

/// The outcome of a stop for one motor, as JSON.
struct Outcome<'a>(&'a StopOutcome);

impl DisplayJson for Outcome<'_> {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        let StopOutcome {
            id,
            confirmed,
            speed,
        } = self.0;
        f.object(|f| {
            f.member("id", id.get())?;
            f.member("confirmed", *confirmed)?;
            match speed {
                Some(speed) => f.member("speed_rpm", speed.rpm()),
                None => Ok(()),
            }
        })
    }
}

/// The message of an event.
pub(crate) fn json(at: Instant, event: &Event) -> String {
    let json = nojson::object(|f| {
        f.member("mono_us", at.as_micros())?;
        f.member("kind", event.kind.name())?;
        f.member("error", event.error)?;
        f.member("text", &event.text)?;
        if event.motors.is_empty() {
            return Ok(());
        }
        let motors = nojson::array(|f| f.elements(event.motors.iter().map(Outcome)));
        f.member("motors", motors)
    });
    json.to_string()
}

/// The event in a message.
pub(crate) fn read(data: &[u8]) -> Option<(Instant, Event)> {
    let json = RawJson::parse(std::str::from_utf8(data).ok()?).ok()?;
    let message = json.value();
    let member = |name| message.to_member(name).ok()?.optional();
    let at = Instant::from_micros(integer(message, "mono_us")?);
    let text = |name| member(name)?.to_unquoted_string_str().ok();
    let motors = member("motors").and_then(|motors| motors.to_array().ok());
    let event = Event {
        kind: EventKind::from_name(&text("kind")?),
        error: member("error").is_some_and(|error| error.as_raw_str() == "true"),
        text: text("text")?.into_owned(),
        motors: motors.into_iter().flatten().filter_map(outcome).collect(),
    };
    Some((at, event))
}

fn outcome(motor: RawJsonValue<'_, '_>) -> Option<StopOutcome> {
    let confirmed = motor.to_member("confirmed").ok()?.optional()?;
    Some(StopOutcome {
        id: MotorId::new(integer(motor, "id")?).ok()?,
        confirmed: confirmed.as_raw_str() == "true",
        speed: integer(motor, "speed_rpm").map(Rpm::new),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use strum::VariantArray;

    #[test]
    fn what_was_written_is_read() {
        let outcome = |id, confirmed, speed: Option<i16>| StopOutcome {
            id: MotorId::new(id).unwrap(),
            confirmed,
            speed: speed.map(Rpm::new),
        };
        let at = Instant::from_millis(7);
        for kind in EventKind::VARIANTS.iter().copied() {
            let mut event = Event::new(kind, "a \"text\"\n°");
            assert_eq!(read(json(at, &event).as_bytes()), Some((at, event.clone())));
            event.motors = vec![outcome(1, true, Some(0)), outcome(254, false, None)];
            event = event.bad();
            assert_eq!(read(json(at, &event).as_bytes()), Some((at, event)));
        }
    }

    #[test]
    fn a_kind_of_a_later_version_is_a_notice() {
        let message = br#"{"mono_us":1,"kind":"eclipse","text":"dark","more":[]}"#;
        let (_, event) = read(message).unwrap();
        assert_eq!(event, Event::new(EventKind::Notice, "dark"));
        assert_eq!(read(b"{\"mono_us\":1}"), None);
        assert_eq!(read(b"\xFF"), None);
    }
}
