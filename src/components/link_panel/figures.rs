//! The line in figures, as HTML. Their places have their widths in the style sheet, so that no figure
//! moves another.

use motorlink_messages::bus::{Counters, LineStatus, ROUND_TRIP_CLASSES_US, RoundTripStatus};

use super::markup::push;
use crate::{
    doctor::{echoed, garbled},
    format::{UNKNOWN, grouped, milliseconds},
    session::Session,
};

/// Exchanges, bus time, round trip, histogram, motors, and what the line carries: the last is empty
/// where it carries the `asked_hz` drive frames a second that each driven motor is to get.
pub(super) fn of(session: &Session, asked_hz: u16) -> [String; 6] {
    let line = session.line.as_ref();
    let round_trip = line.map(|line| line.round_trip).unwrap_or_default();
    let carries = line.and_then(|line| line.carries_hz).map(|carried_hz| {
        let (carried, asked) = (carried_hz.to_string(), asked_hz.to_string());
        [
            "The line carries ",
            &carried,
            " Hz for each driven motor; ",
            &asked,
            " Hz are asked.",
        ]
        .concat()
    });
    let mut median_and_p99 = String::new();
    push_figure(
        &mut median_and_p99,
        round_trip.median_us.map(milliseconds),
        "ms median",
    );
    push_figure(
        &mut median_and_p99,
        round_trip.p99_us.map(milliseconds),
        "ms p99",
    );
    let mut exchanges = String::new();
    let exchanges_hz = line.map(|line| line.exchanges_hz.to_string());
    push_figure(&mut exchanges, exchanges_hz, "a second");
    [
        exchanges,
        bus_time(line),
        median_and_p99,
        histogram(&round_trip),
        motors(session),
        carries.unwrap_or_default(),
    ]
}

/// A number in its place, and what it is.
fn push_figure(html: &mut String, number: Option<String>, of: &str) {
    let number = number.unwrap_or_else(|| UNKNOWN.to_owned());
    push(html, &["<span><b>", &number, "</b> ", of, "</span> "]);
}

/// In percent; what is left is nobody's.
fn bus_time(line: Option<&LineStatus>) -> String {
    let shares = line.map(|line| {
        [
            line.drive_per_mille,
            line.query_per_mille,
            line.other_per_mille,
            line.waiting_per_mille,
        ]
    });
    let names = ["% drive", "% queries", "% other", "% waiting"];
    let mut html = String::new();
    for (place, name) in names.into_iter().enumerate() {
        let share = shares.and_then(|shares| shares.get(place).copied());
        let percent = share.map(|per_mille| ((per_mille + 5) / 10).to_string());
        push_figure(&mut html, percent, name);
    }
    html
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
        if let Some(end_us) = ROUND_TRIP_CLASSES_US.get(class) {
            let place = ((class + 1) * WIDTH).to_string();
            let end = milliseconds(*end_us);
            let end = end.trim_end_matches(".0");
            push(
                &mut ends,
                &["<text x=\"", &place, "\" y=\"74\">", end, "</text>"],
            );
        }
    }
    push(&mut bars, &[&ends, "</svg>"]);
    bars
}

const MOTORS_HEAD: &str = concat!(
    "<thead><tr><td></td>",
    r#"<th scope="col" title="Requests answered in time">Replies</th>"#,
    r#"<th scope="col" title="Requests after which nothing came">Silences</th>"#,
    r#"<th scope="col" title="Replies with wrong bits, or cut short">Bad CRC</th>"#,
    r#"<th scope="col" title="Requests that came back">Echoes</th>"#,
    r#"<th scope="col" title="Good frames of a motor that was not asked">Foreign</th>"#,
    "</tr></thead><tbody>",
);

/// A row for every motor, and one for what came while none was asked.
fn motors(session: &Session) -> String {
    let mut html = MOTORS_HEAD.to_owned();
    for motor in &session.motors {
        push_row(&mut html, &motor.id.to_string(), &motor.counters);
    }
    if let Some(line) = &session.line {
        push_row(&mut html, "Others", &line.unaddressed);
    }
    push(&mut html, &["</tbody>"]);
    html
}

fn push_row(html: &mut String, name: &str, counters: &Counters) {
    push(html, &["<tr><th scope=\"row\">", name, "</th>"]);
    for count in [
        counters.replies,
        counters.silences,
        garbled(counters),
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
    use crate::session::tests::{session, status};

    fn on(line: LineStatus) -> [String; 6] {
        let mut motor = status(1_000, Mode::Velocity, 0);
        motor.counters = Counters {
            requests: 1_240,
            replies: 1_234,
            silences: 3,
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
        of(&session, 200)
    }

    #[test]
    fn the_line_is_shown_in_figures() {
        let [exchanges, bus_time, round_trip, _, motors, carries] = on(LineStatus {
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
        assert_eq!(exchanges, "<span><b>87</b> a second</span> ");
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
            "<tr><th scope=\"row\">0x01</th><td>1\u{202F}234</td><td>3</td><td>2</td><td>5</td>\
             <td>0</td></tr>"
        ));
        assert!(motors.contains("Others"));
        assert!(motors.contains("<td>9</td></tr></tbody>"));
        assert_eq!(carries, "");
    }

    #[test]
    fn a_line_that_is_too_slow_says_what_it_carries() {
        let [.., carries] = on(LineStatus {
            carries_hz: Some(54),
            ..LineStatus::default()
        });
        assert_eq!(
            carries,
            "The line carries 54 Hz for each driven motor; 200 Hz are asked."
        );
    }

    #[test]
    fn unknown_is_not_zero() {
        let [exchanges, bus_time, .., motors, _] = of(&Session::default(), 50);
        assert_eq!(exchanges, "<span><b>–</b> a second</span> ");
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
        assert_eq!(svg.matches("<text").count(), 11);
    }
}
