//! The line in figures, as HTML. Their places have their widths in the style sheet, so that no figure
//! moves another.

use motorlink_diagnosis::{echoed, garbled};
use motorlink_i18n::tr;
use motorlink_messages::bus::{Counters, LineStatus, ROUND_TRIP_BINS_US, RoundTripStatus};

use crate::{
    features::link_doctor::markup::push,
    model::snapshot::Session,
    ui::{
        format::{UNKNOWN, grouped, milliseconds},
        frame_rate::FrameRate,
    },
};

/// Exchanges, bus time, round trip, histogram, motors, what the line carries, and how often the page draws. What
/// the line carries is empty where it carries the `asked_hz` drive frames a second that each driven motor is to
/// get.
pub(crate) fn of(session: &Session, asked_hz: u16, frame_rate: FrameRate) -> [String; 7] {
    let line = session.line.as_ref();
    let round_trip = line.map(|line| line.round_trip).unwrap_or_default();
    let carries = line.and_then(|line| line.carries_hz).map(|carried_hz| {
        tr!(
            "The bus allows only {carried} Hz per motor. Lower the command rate ({asked} Hz).",
            carried = carried_hz,
            asked = asked_hz
        )
    });
    let median = bold(round_trip.median_us.map(milliseconds));
    let p99 = bold(round_trip.p99_us.map(milliseconds));
    let median_and_p99 = figures(&[
        tr!("{number} ms median", number = median),
        tr!("{number} ms p99", number = p99),
    ]);
    let exchanges_hz = bold(line.map(|line| line.exchanges_hz.to_string()));
    let exchanges = figures(&[tr!("{number}/s", number = exchanges_hz)]);
    [
        exchanges,
        bus_time(line),
        median_and_p99,
        histogram(&round_trip),
        motors(session),
        carries.unwrap_or_default(),
        drawing(frame_rate),
    ]
}

/// How often the page draws, and why not more often.
fn drawing(frame_rate: FrameRate) -> String {
    match frame_rate.hertz() {
        None => tr!("at the full frame rate").to_owned(),
        Some(hertz) => tr!("at {rate} fps to keep the wire on time", rate = hertz),
    }
}

/// A number that has its place among the words.
fn bold(number: Option<String>) -> String {
    let number = number.unwrap_or_else(|| UNKNOWN.to_owned());
    ["<b>", &number, "</b>"].concat()
}

/// Numbers with what they are, each in its place.
fn figures(words: &[String]) -> String {
    let mut html = String::new();
    for words in words {
        push(&mut html, &["<span>", words, "</span> "]);
    }
    html
}

/// In percent; what is left is nobody's.
fn bus_time(line: Option<&LineStatus>) -> String {
    let percent =
        |share: fn(&LineStatus) -> u16| bold(line.map(|line| ((share(line) + 5) / 10).to_string()));
    figures(&[
        tr!(
            "{number} % drive",
            number = percent(|line| line.drive_per_mille)
        ),
        tr!(
            "{number} % queries",
            number = percent(|line| line.query_per_mille)
        ),
        tr!(
            "{number} % other",
            number = percent(|line| line.other_per_mille)
        ),
        tr!(
            "{number} % waiting",
            number = percent(|line| line.waiting_per_mille)
        ),
    ])
}

/// Bars of the last replies, the tallest as high as there is room for.
fn histogram(round_trip: &RoundTripStatus) -> String {
    const WIDTH: usize = 30;
    const HEIGHT: u32 = 60;
    let most = round_trip.histogram.iter().copied().max().unwrap_or(0);
    let mut bars = String::from("<svg viewBox=\"0 0 360 76\"><path d=\"");
    let mut ends = String::from("\"/>");
    for (class, count) in round_trip.histogram.iter().enumerate() {
        // One reply of 256 is seen.
        let height = (u32::from(*count) * HEIGHT).div_ceil(u32::from(most.max(1)));
        let (left, height) = ((class * WIDTH + 1).to_string(), height.to_string());
        push(
            &mut bars,
            &["M", &left, " 60v-", &height, "h28v", &height, "z"],
        );
        if let Some(end_us) = ROUND_TRIP_BINS_US.get(class) {
            let place = ((class + 1) * WIDTH).to_string();
            let end = milliseconds(*end_us);
            let end = end.trim_end_matches(".0");
            push(
                &mut ends,
                &["<text x=\"", &place, "\" y=\"74\">", end, "</text>"],
            );
        }
    }
    push(
        &mut bars,
        &[&ends, "<text x=\"350\" y=\"74\">ms</text></svg>"],
    );
    bars
}

/// A row for every motor, and one for what came while none was asked.
fn motors(session: &Session) -> String {
    let mut html = "<thead><tr><td></td>".to_owned();
    for (title, name) in [
        (tr!("Requests with a valid reply in time"), tr!("Replies")),
        (tr!("Requests whose reply never came"), tr!("Lost")),
        (tr!("Replies that came after their time"), tr!("Late")),
        (tr!("Corrupted or truncated replies"), tr!("Corrupted")),
        (
            tr!("Drive frames and queries that the computer was too late to send"),
            tr!("Not asked"),
        ),
        (tr!("Requests echoed back"), tr!("Echoes")),
        (
            tr!("Valid frames from a motor that was not queried"),
            tr!("Foreign"),
        ),
    ] {
        push(
            &mut html,
            &["<th scope=\"col\" title=\"", title, "\">", name, "</th>"],
        );
    }
    push(&mut html, &["</tr></thead><tbody>"]);
    for motor in &session.motors {
        let lost = motor.counters.silences.saturating_sub(motor.counters.late);
        push_row(
            &mut html,
            &motor.id.to_string(),
            &motor.counters,
            &grouped(lost),
        );
    }
    if let Some(line) = &session.line {
        // What a scan asks at an address without a motor is not lost.
        push_row(&mut html, tr!("Others"), &line.unaddressed, UNKNOWN);
    }
    push(&mut html, &["</tbody>"]);
    html
}

fn push_row(html: &mut String, name: &str, counters: &Counters, lost: &str) {
    let replies = grouped(counters.replies);
    push(
        html,
        &[
            "<tr><th scope=\"row\">",
            name,
            "</th><td>",
            &replies,
            "</td><td>",
            lost,
            "</td>",
        ],
    );
    for count in [
        counters.late,
        garbled(counters),
        counters.not_asked,
        echoed(counters),
        counters.wrong_ids,
    ] {
        push(html, &["<td>", &grouped(count), "</td>"]);
    }
    push(html, &["</tr>"]);
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::Mode;

    use super::*;
    use crate::model::snapshot::tests::{session, status};

    fn on(line: LineStatus) -> [String; 7] {
        let mut motor = status(1_000, Mode::Velocity, 0);
        motor.counters = Counters {
            requests: 1_240,
            replies: 1_234,
            silences: 3,
            late: 1,
            not_asked: 6,
            bad_crcs: 1,
            fragments: 1,
            echoes_whole: 4,
            echoes_cut: 1,
            ..Counters::default()
        };
        let session = Session {
            line: Some(line),
            ..session(1_000, motor)
        };
        of(&session, 200, FrameRate::Full)
    }

    #[test]
    fn the_line_is_shown_in_figures() {
        let [exchanges, bus_time, round_trip, _, motors, carries, _] = on(LineStatus {
            exchanges_hz: 87,
            drive_per_mille: 414,
            query_per_mille: 115,
            waiting_per_mille: 1_000,
            round_trip: RoundTripStatus {
                median_us: Some(2_340),
                p99_us: Some(3_010),
                ..RoundTripStatus::default()
            },
            unaddressed: Counters {
                wrong_ids: 9,
                ..Counters::default()
            },
            ..LineStatus::default()
        });
        assert_eq!(exchanges, "<span><b>87</b>/s</span> ");
        assert_eq!(
            bus_time,
            "<span><b>41</b> % drive</span> <span><b>12</b> % queries</span> \
             <span><b>0</b> % other</span> <span><b>100</b> % waiting</span> "
        );
        assert_eq!(
            round_trip,
            "<span><b>2.4</b> ms median</span> <span><b>3.1</b> ms p99</span> "
        );
        assert!(motors.contains(
            "<tr><th scope=\"row\">0x01</th><td>1\u{202F}234</td><td>2</td><td>1</td><td>2</td>\
             <td>6</td><td>5</td><td>0</td></tr>"
        ));
        assert!(motors.contains("Others"));
        assert!(motors.contains("<td>9</td></tr></tbody>"));
        assert_eq!(carries, "");
    }

    #[test]
    fn a_line_that_is_too_slow_says_what_it_carries() {
        let [.., carries, _] = on(LineStatus {
            carries_hz: Some(54),
            ..LineStatus::default()
        });
        assert_eq!(
            carries,
            "The bus allows only 54 Hz per motor. Lower the command rate (200 Hz)."
        );
    }

    #[test]
    fn a_page_that_draws_less_says_why() {
        let full = "at the full frame rate";
        let lower = "at 20 fps to keep the wire on time";
        for (rate, text) in [(FrameRate::Full, full), (FrameRate::Hz20, lower)] {
            let [.., drawing] = of(&Session::default(), 50, rate);
            assert_eq!(drawing, text);
        }
    }

    #[test]
    fn unknown_is_not_zero() {
        let [exchanges, bus_time, .., motors, _, _] = of(&Session::default(), 50, FrameRate::Full);
        assert_eq!(exchanges, "<span><b>–</b>/s</span> ");
        assert!(bus_time.contains("<b>–</b> % drive"));
        assert!(!motors.contains("Others"));
    }

    #[test]
    fn a_single_reply_is_seen_beside_two_hundred() {
        let mut round_trip = RoundTripStatus::default();
        round_trip.histogram[1] = 255;
        round_trip.histogram[9] = 1;
        let svg = histogram(&round_trip);
        assert!(svg.contains("M31 60v-60h28v60z"));
        assert!(svg.contains("M271 60v-1h28v1z"));
        assert!(svg.contains("<text x=\"60\" y=\"74\">2.5</text>"));
        assert!(svg.contains("<text x=\"90\" y=\"74\">3</text>"));
        assert_eq!(svg.matches('M').count(), 12);
        assert!(svg.contains("<text x=\"350\" y=\"74\">ms</text>"));
        assert_eq!(svg.matches("<text").count(), 12);
    }
}
