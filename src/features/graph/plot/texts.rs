//! The graph's name, and its values as text for screen readers.

use motorlink_i18n::{terms::in_language, tr};

use crate::features::graph::plot::{
    comparison::Comparison,
    crosshair::Values,
    ticks::{thousandths, time_of_day},
    trace::{Trace, Traces},
    view::{View, Watch},
};

/// The text before the first reply.
pub(crate) fn no_data() -> String {
    tr!("No data yet.").to_owned()
}

/// The time of day of a moment, from its microseconds on the history's clock.
pub(crate) type TimeOfDay<'a> = &'a dyn Fn(u64) -> u64;

/// `60 s`, `2.5 s`, `5 min`
pub(crate) fn span(span_us: u64) -> String {
    let tenths = (span_us + 50_000) / 100_000;
    match (tenths / 10, tenths % 10) {
        (seconds, 0) if seconds >= 120 && seconds.is_multiple_of(60) => {
            format!("{} min", seconds / 60)
        }
        (seconds, 0) => format!("{seconds} s"),
        (seconds, tenth) if seconds < 60 => in_language(format!("{seconds}.{tenth} s")),
        (seconds, _) => format!("{seconds} s"),
    }
}

/// `Speed and current, last 60 s`; while the view is paused, `Speed and current, 60 s up to 13:15:36`; in a
/// comparison, `Speed of each motor, last 60 s`.
///
/// `day_ms` gives the time of day of a moment, in milliseconds since midnight.
pub(crate) fn name(compare: Option<Trace>, view: View, day_ms: TimeOfDay) -> String {
    let subject = compare.map_or_else(
        || tr!("Speed and current").to_owned(),
        |trace| tr!("{trace} of each motor", trace = trace.name()),
    );
    let span = span(view.span_us);
    match view.watch {
        Watch::Live => tr!("{subject}, last {span}", subject, span),
        Watch::Panned(right_us) | Watch::Paused(right_us) => {
            let until = time_of_day(day_ms(right_us), 1_000);
            tr!("{subject}, {span} up to {until}", subject, span, until)
        }
    }
}

/// The values of the visible traces at a moment as a sentence.
pub(crate) fn sentence(when: &str, values: Option<&Values>, traces: Traces) -> String {
    let Some(values) = values else {
        return no_data();
    };
    let on = Trace::ALL.into_iter().filter(|trace| traces.has(*trace));
    let words: Vec<String> = on
        .map(|trace| format!("{} {}", trace.name_in_sentence(), values.text(trace)))
        .collect();
    tr!("{when}: {values}.", when, values = words.join(", "))
}

/// The values of one trace of several motors at a moment as a sentence, from the motors' names and values.
pub(crate) fn compared_sentence(
    when: &str,
    comparison: &Comparison,
    motors: &[(String, String)],
) -> String {
    if motors.is_empty() {
        return no_data();
    }
    let words = motors.iter().map(|(name, value)| format!("{name} {value}"));
    let words: Vec<String> = words.chain(comparison.more()).collect();
    tr!(
        "{when}: {trace}: {values}.",
        when,
        trace = comparison.trace.name_in_sentence(),
        values = words.join(", ")
    )
}

/// ` Marks: 13:15:36 Start: +100 rpm, 13:15:40 Stop.`; nothing without a mark.
pub(crate) fn marks<'a>(marks: impl Iterator<Item = (String, &'a str)>) -> String {
    let marks: Vec<String> = marks
        .map(|(time, words)| format!("{time} {words}"))
        .collect();
    if marks.is_empty() {
        return String::new();
    }
    format!(" {}", tr!("Marks: {marks}.", marks = marks.join(", ")))
}

/// `14.1 s ago`
pub(crate) fn ago(us: u64) -> String {
    let tenths = us / 100_000;
    match tenths {
        0 => tr!("now").to_owned(),
        1..1_200 => tr!(
            "{seconds} s ago",
            seconds = in_language(format!("{}.{}", tenths / 10, tenths % 10))
        ),
        _ => tr!(
            "{minutes} min ago",
            minutes = format!("{}:{:02}", tenths / 600, tenths / 10 % 60)
        ),
    }
}

/// `Δt 1.240 s`, with its sign: the time from the second cursor to the crosshair.
pub(crate) fn since(to_us: u64, from_us: u64) -> String {
    let sign = if to_us < from_us { "\u{2212}" } else { "" };
    let ms = to_us.abs_diff(from_us) / 1_000;
    in_language(format!("Δt {sign}{} s", thousandths(ms, 1)))
}

/// Local year, month, day, hour, minute, second.
pub(crate) type LocalTime = [u32; 6];

/// `motorlink-graph-20251121-131536.png`, with `png` or another ending.
pub(crate) fn file_name(
    [year, month, day, hour, minute, second]: LocalTime,
    ending: &str,
) -> String {
    format!("motorlink-graph-{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}.{ending}")
}

/// `2025-11-21 13:15:36`
pub(crate) fn date_and_time([year, month, day, hour, minute, second]: LocalTime) -> String {
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}")
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::{Current, Rpm};

    use super::*;
    use crate::model::{
        history::{
            History,
            tests::{sample, update},
        },
        names_and_sides::NamesAndSides,
        scan_texts::tests::id,
    };

    const SECOND: u64 = 1_000_000;

    #[test]
    fn a_span_is_said_as_people_say_it() {
        for (span_us, words) in [
            (10 * SECOND, "10 s"),
            (60 * SECOND, "60 s"),
            (300 * SECOND, "5 min"),
            (90 * SECOND, "90 s"),
            (2_500_000, "2.5 s"),
            (200_000, "0.2 s"),
            (75_400_000, "75 s"),
        ] {
            assert_eq!(span(span_us), words);
        }
    }

    #[test]
    fn the_name_follows_the_window() {
        let day_ms = |us: u64| 13 * 3_600_000 + us / 1_000;
        let view = View::default();
        assert_eq!(name(None, view, &day_ms), "Speed and current, last 10 s");
        let minute = view.with_span(60 * SECOND);
        assert_eq!(name(None, minute, &day_ms), "Speed and current, last 60 s");
        let held = view.paused(936_500_000);
        assert_eq!(
            name(None, held, &day_ms),
            "Speed and current, 10 s up to 13:15:36"
        );
        assert_eq!(
            name(Some(Trace::Temperature), view, &day_ms),
            "Temperature of each motor, last 10 s"
        );
    }

    #[test]
    fn the_values_are_a_sentence() {
        let values = Values {
            speed: Some(Rpm::new(-60)),
            current: Some(Current::from_amps(-0.11)),
            ..Values::default()
        };
        let traces = Traces::default();
        let said = sentence("Now", Some(&values), traces);
        assert_eq!(said, "Now: speed −60 rpm, current −0.11 A, target –.");
        assert_eq!(sentence("Now", None, traces), no_data());
    }

    #[test]
    fn compared_motors_are_told_one_by_one_and_so_is_who_is_left_out() {
        let said = |count: u8, names: &[&str]| {
            let mut history = History::default();
            let samples = (1..=count).map(|of| sample(id(of), 1_000, 5)).collect();
            history.take(&update(1_000, samples, vec![]));
            let comparison =
                Comparison::new(Trace::Speed, &history, &NamesAndSides::default(), id(1));
            let motors = names
                .iter()
                .map(|name| ((*name).to_owned(), "+5 rpm".to_owned()));
            compared_sentence("Now", &comparison, &motors.collect::<Vec<_>>())
        };
        assert_eq!(
            said(2, &["0x01 Port", "0x02"]),
            "Now: speed: 0x01 Port +5 rpm, 0x02 +5 rpm."
        );
        assert_eq!(
            said(9, &["0x01"]),
            "Now: speed: 0x01 +5 rpm, and 1 more, not shown."
        );
        assert_eq!(said(0, &[]), no_data());
    }

    #[test]
    fn how_long_ago_is_said_to_a_tenth() {
        assert_eq!(ago(14_149_000), "14.1 s ago");
        assert_eq!(ago(50_000), "now");
        assert_eq!(ago(185_000_000), "3:05 min ago");
    }

    #[test]
    fn marks_are_told_with_their_time() {
        let said = marks([("13:15:36".to_owned(), "Stop")].into_iter());
        assert_eq!(said, " Marks: 13:15:36 Stop.");
        assert_eq!(marks([].into_iter()), "");
    }

    #[test]
    fn the_time_between_two_cursors_has_a_sign() {
        assert_eq!(since(3_500_000, 2_260_000), "Δt 1.240 s");
        assert_eq!(since(2_260_000, 3_500_000), "Δt \u{2212}1.240 s");
    }

    #[test]
    fn a_picture_has_its_time_in_its_name() {
        let time = [2025, 1, 9, 3, 15, 6];
        assert_eq!(
            file_name(time, "png"),
            "motorlink-graph-20250109-031506.png"
        );
        assert_eq!(date_and_time(time), "2025-01-09 03:15:06");
    }
}
