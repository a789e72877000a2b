//! The texts of the saved session.

use motorlink_i18n::tr;
use motorlink_messages::recorder::{NotSaved, SavedSession};

use crate::{
    features::saved_session::offer::Offer,
    model::log_lines::Line,
    ui::{
        clock::{local_date, local_time},
        format::grouped,
    },
};

/// The text of the offer. `now_ms` is on the wall clock.
pub(crate) fn of_offer(offer: &Offer, now_ms: f64) -> String {
    match offer {
        Offer::None => String::new(),
        Offer::Open(session) => {
            let date = local_date(session.from_ms);
            let hours = of_hours(session);
            let hours = if date == local_date(now_ms) {
                hours
            } else {
                format!("{date}, {hours}")
            };
            let content = of_content(session);
            tr!("Session from {hours}: {content}.", hours, content)
        }
        Offer::Restoring(session) => {
            tr!(
                "Restoring the session from {hours}.",
                hours = of_hours(session)
            )
        }
    }
}

/// A line of the log.
pub(crate) fn of_restored(session: &SavedSession) -> String {
    tr!(
        "Restored the session from {hours}: {content}",
        hours = of_hours(session),
        content = of_content(session)
    )
}

/// A line of the log.
pub(crate) fn of_forgotten(session: &SavedSession) -> String {
    tr!(
        "Deleted the session from {hours}",
        hours = of_hours(session)
    )
}

/// A line of the log.
pub(crate) fn of_not_saved(why: NotSaved) -> Line {
    let why = match why {
        NotSaved::NoRoom => tr!("the browser storage is full"),
        NotSaved::Failed => tr!("the browser storage failed"),
    };
    Line {
        error: true,
        text: tr!(
            "The session is not stored: {why}. Log and recording continue; export them before you \
             close the page.",
            why
        ),
    }
}

/// `13:05 to 13:25`
fn of_hours(session: &SavedSession) -> String {
    let minute = |ms| {
        let mut time = local_time(ms);
        time.truncate("13:05".len());
        time
    };
    tr!(
        "{from} to {to}",
        from = minute(session.from_ms),
        to = minute(session.to_ms)
    )
}

/// `40 210 packets, 3 min recorded`
fn of_content(session: &SavedSession) -> String {
    let packets = match session.packets {
        1 => tr!("1 packet").to_owned(),
        count => tr!("{count} packets", count = grouped(count)),
    };
    match session.recorded_ms / 1000 {
        _ if session.recorded == 0 => packets,
        seconds @ 0..120 => tr!("{packets}, {seconds} s recorded", packets, seconds),
        seconds => tr!(
            "{packets}, {minutes} min recorded",
            packets,
            minutes = seconds / 60
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(packets: u64, recorded: u64, recorded_ms: u64) -> String {
        let session = SavedSession {
            from_ms: 0.0,
            to_ms: 0.0,
            packets,
            recorded,
            recorded_ms,
        };
        of_content(&session).replace('\u{202F}', " ")
    }

    #[test]
    fn a_session_is_counted_in_packets_and_recorded_time() {
        assert_eq!(
            content(40_210, 9_000, 200_000),
            "40 210 packets, 3 min recorded"
        );
        assert_eq!(content(1, 0, 0), "1 packet");
        assert_eq!(content(0, 7, 1_400), "0 packets, 1 s recorded");
    }

    #[test]
    fn a_session_that_is_not_kept_says_why_and_what_to_do() {
        for why in [NotSaved::NoRoom, NotSaved::Failed] {
            let line = of_not_saved(why);
            assert!(line.error && line.text.contains("is not stored"));
            assert!(line.text.contains("export"));
        }
    }
}
