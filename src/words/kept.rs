//! What the browser keeps, in words.

use motorlink_messages::journal::{KeptSession, NotKept};

use super::log_lines::Line;
use crate::{
    clock::{local_date, local_time},
    format::grouped,
    kept::Offer,
};

/// What became of what was kept.
pub(crate) const fn of_erased(all: bool) -> &'static str {
    if all {
        "Erased. What is done from now on is kept anew."
    } else {
        "Erased, but for what other tabs of this page have open. Close them and erase again."
    }
}

/// What is said of the session that is kept. `now_ms` is on the wall clock.
pub(crate) fn of_offer(offer: &Offer, now_ms: f64) -> String {
    match offer {
        Offer::None => String::new(),
        Offer::Open(session) => {
            let date = local_date(session.from_ms);
            let day = if date == local_date(now_ms) {
                String::new()
            } else {
                format!("{date}, ")
            };
            format!(
                "A session of {day}{} is kept in this browser: {}.",
                of_hours(session),
                of_content(session)
            )
        }
        Offer::Restoring(session) => {
            format!("The session of {} is being restored.", of_hours(session))
        }
    }
}

/// A line of the log.
pub(crate) fn of_restored(session: &KeptSession) -> String {
    format!(
        "The session of {} was restored: {}",
        of_hours(session),
        of_content(session)
    )
}

/// A line of the log.
pub(crate) fn of_forgotten(session: &KeptSession) -> String {
    format!("The session of {} was forgotten", of_hours(session))
}

/// A line of the log.
pub(crate) fn of_not_kept(why: NotKept) -> Line {
    let why = match why {
        NotKept::NoRoom => "it has no room for it",
        NotKept::Failed => "its storage fails",
    };
    Line {
        error: true,
        text: format!(
            "This browser keeps no copy of the session: {why}. Log and recording go on; export them before \
             the page is closed."
        ),
    }
}

/// `13:05 to 13:25`
fn of_hours(session: &KeptSession) -> String {
    let minute = |ms| {
        let mut time = local_time(ms);
        time.truncate("13:05".len());
        time
    };
    format!("{} to {}", minute(session.from_ms), minute(session.to_ms))
}

/// `40 210 packets, 3 min recorded`
fn of_content(session: &KeptSession) -> String {
    let packets = grouped(session.packets);
    let recorded = match session.recorded_ms / 1000 {
        _ if session.recorded == 0 => String::new(),
        seconds @ 0..120 => format!(", {seconds} s recorded"),
        seconds => format!(", {} min recorded", seconds / 60),
    };
    let plural = if session.packets == 1 { "" } else { "s" };
    format!("{packets} packet{plural}{recorded}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(packets: u64, recorded: u64, recorded_ms: u64) -> String {
        let session = KeptSession {
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
        for why in [NotKept::NoRoom, NotKept::Failed] {
            let line = of_not_kept(why);
            assert!(line.error && line.text.contains("keeps no copy"));
            assert!(line.text.contains("export"));
        }
    }
}
