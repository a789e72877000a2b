//! The messages of the page in the packet log, as events of a session.
//!
//! The page stores a message as its English text with the values apart (`motorlink_i18n::untranslated`). That text
//! identifies the message, so it says what has happened.

use motorlink_bus::StopOutcome;
use motorlink_i18n::{Language, current_language, number_of, set_language, translate};
use motorlink_protocol::MotorId;

use crate::record::{Event, EventKind};

/// Begins a message with values, separates them, and ends it: see `motorlink_i18n::untranslated`.
const MARKS: [char; 3] = ['\u{2}', '\u{1F}', '\u{3}'];

/// A text of the page. It does not compile if the page has no such text any more.
macro_rules! text {
    ($text:literal) => {{
        const _: usize = number_of($text);
        $text
    }};
}

/// The kinds of messages, by their texts.
const KINDS: [(&str, EventKind); 12] = [
    (text!("Connected to {adapter}"), EventKind::Connected),
    (text!("Disconnected"), EventKind::Disconnected),
    (text!("Adapter unplugged"), EventKind::Disconnected),
    (text!("Adapter reconnected"), EventKind::Connected),
    (text!("Stopping a motor or group"), EventKind::StopBegan),
    // In files of earlier versions.
    ("Stopping one motor", EventKind::StopBegan),
    (text!("Stopping. {why}"), EventKind::StopBegan),
    (text!("Stopped: no motor was running"), EventKind::StopEnded),
    (CONFIRMED, EventKind::StopEnded),
    (RUN_BEGAN, EventKind::Run),
    (text!("Run ended: {how}"), EventKind::Run),
    (
        text!("Standstill not confirmed: {motors}"),
        EventKind::StopEnded,
    ),
];

const RUN_BEGAN: &str = text!("Run began: {name}");

const CONFIRMED: &str = text!("Stopped, standstill confirmed: {motors}");

/// A message with one of these in it tells which limit stopped a motor.
const LIMITS: [&str; 3] = [
    text!("{reached} rpm, above your limit of {limit} rpm"),
    text!("{reached} A, above your limit of {limit} A"),
    text!("{reached} °C, above your limit of {limit} °C"),
];

impl Event {
    /// The event of a message of the page, as the packet log stores it. Its text is English.
    #[must_use]
    pub fn of_page(stored: &str, error: bool) -> Self {
        let shown_in = current_language();
        set_language(Language::English);
        let mut event = Self::new(kind(stored), translate(stored));
        set_language(shown_in);
        event.error = error;
        event.motors = confirmed(stored);
        event
    }

    /// Whether this is the start of a run.
    pub(crate) fn begins_run(&self) -> bool {
        let before_name = RUN_BEGAN.split('{').next().unwrap_or_default();
        self.kind == EventKind::Run && self.text.starts_with(before_name)
    }
}

fn kind(stored: &str) -> EventKind {
    if LIMITS.iter().any(|limit| stored.contains(limit)) {
        return EventKind::Limit;
    }
    let english = stored.split(MARKS).find(|text| !text.is_empty());
    let known = KINDS.iter().find(|(text, _)| Some(*text) == english);
    known.map_or(EventKind::Notice, |(_, kind)| *kind)
}

/// The motors of a confirmed stop.
fn confirmed(stored: &str) -> Vec<StopOutcome> {
    let mut texts = stored.split(MARKS).filter(|text| !text.is_empty());
    if texts.next() != Some(CONFIRMED) {
        return Vec::new();
    }
    let ids = texts.next().unwrap_or_default().split(", ");
    let outcomes = ids.filter_map(|id| {
        let number = u8::from_str_radix(id.strip_prefix("0x")?, 16).ok()?;
        Some(StopOutcome {
            id: MotorId::new(number).ok()?,
            confirmed: true,
            speed: None,
        })
    });
    outcomes.collect()
}

#[cfg(test)]
mod tests {
    use motorlink_i18n::{tr, untranslated};

    use super::*;

    fn event(text: impl FnOnce() -> String) -> Event {
        Event::of_page(&untranslated(text), false)
    }

    #[test]
    fn a_message_is_an_event_of_its_kind_in_english() {
        let connected = event(|| tr!("Connected to {adapter}", adapter = "CH343"));
        assert_eq!(
            (connected.kind, connected.text.as_str()),
            (EventKind::Connected, "Connected to CH343")
        );
        let why = || {
            tr!(
                "{reached} rpm, above your limit of {limit} rpm",
                reached = 80,
                limit = 60
            )
        };
        let limit = event(|| tr!("Stopping motor {id}: {why}", id = "0x01", why = why()));
        assert_eq!(limit.kind, EventKind::Limit);
        assert!(
            limit.text.ends_with("above your limit of 60 rpm"),
            "{}",
            limit.text
        );
        let plain = event(|| tr!("Disconnected").to_owned());
        assert_eq!(plain.kind, EventKind::Disconnected);
        assert_eq!(event(|| "anything else".to_owned()).kind, EventKind::Notice);
        assert_eq!(event(String::new).kind, EventKind::Notice);
    }

    #[test]
    fn a_run_of_an_experiment_begins_and_ends() {
        let began = event(|| tr!("Run began: {name}", name = "Warm-up"));
        assert_eq!(began.kind, EventKind::Run);
        assert_eq!(began.text, "Run began: Warm-up");
        let ended = event(|| tr!("Run ended: {how}", how = "stopped by you"));
        assert_eq!(ended.kind, EventKind::Run);
        assert_eq!(ended.text, "Run ended: stopped by you");
    }

    #[test]
    fn a_confirmed_stop_names_its_motors() {
        let motors = "0x01, 0xFE";
        let event = event(|| tr!("Stopped, standstill confirmed: {motors}", motors));
        assert_eq!(event.kind, EventKind::StopEnded);
        let ids: Vec<u8> = event.motors.iter().map(|motor| motor.id.get()).collect();
        assert_eq!(ids, [1, 254]);
        assert!(event.motors.iter().all(|motor| motor.confirmed));
    }
}
