//! Compares what a replay shows with what the page has shown live.

use std::{collections::BTreeMap, fmt::Debug};

use motorlink_bus::{Activity, Counters, LineStatus, LinkQuality, MotorStatus, RoundTripStatus};
use motorlink_protocol::Setpoint;

use crate::{driver::Replay, live::Shown};

/// Each look reads the whole session.
const LOOKS: usize = 40;

/// The read-outs that differ: how often, and first how.
pub type Differences = BTreeMap<&'static str, (usize, String)>;

/// Goes to times at which the live page was looked at, and names the read-outs that differ.
///
/// Left out is what no record has: echoes, the rate that the line can carry (it depends on the settings), and the
/// motors before their first answer. Late calls of the bus are not recorded either; the virtual line has none.
pub fn differences(file: &[u8], shown: &[Shown]) -> Differences {
    assert!(shown.len() > 5);
    let mut replay = Replay::of(file);
    let mut differ = Differences::new();
    for live in shown.iter().step_by(1 + shown.len() / LOOKS) {
        let update = replay.seek(live.at);
        let line = update.line.expect("a line");
        let mut note = |what: &'static str, live_has: &dyn Debug, replay_has: &dyn Debug| {
            let (a, b) = (format!("{live_has:?}"), format!("{replay_has:?}"));
            if a != b {
                let first = || (0, format!("{:?}\n live {a}\n replay {b}", live.at));
                differ.entry(what).or_insert_with(first).0 += 1;
            }
        };
        let ids = |motors: &[MotorStatus]| motors.iter().map(|motor| motor.id).collect::<Vec<_>>();
        note("motors", &ids(&live.motors), &ids(&update.motors));
        for (a, b) in live.motors.iter().zip(&update.motors) {
            note("activity", &a.activity, &noticed(b.activity));
            note("last reply", &a.last, &b.last);
            note("position", &a.position, &b.position);
            note("temperature", &a.temperature, &b.temperature);
            note("silent", &a.silent, &b.silent);
            note("link", &timed_at_the_log(a.link), &timed_at_the_log(b.link));
            note("counters", &recorded(a.counters), &recorded(b.counters));
        }
        let known = |line: LineStatus| LineStatus {
            unaddressed: recorded(line.unaddressed),
            carries_hz: None,
            // As `timed_at_the_log`; the pauses between exchanges follow from the round trip.
            round_trip: RoundTripStatus::default(),
            late_hz: 0,
            exchanges_hz: 0,
            other_per_mille: 0,
            ..line
        };
        note("line", &known(live.line), &known(line));
    }
    differ
}

/// Until the page notices that a stop has begun, its frames look like a command to brake. These tests give none.
fn noticed(activity: Activity) -> Activity {
    let setpoint = Setpoint::Brake;
    if activity == (Activity::Driven { setpoint }) {
        Activity::Stopping { confirmed: false }
    } else {
        activity
    }
}

/// The log has the time at which the bus took a reply. The bus measures the round trip to its last byte, and may take it
/// later: when the line is quiet, or at the end of the window.
fn timed_at_the_log(link: LinkQuality) -> LinkQuality {
    LinkQuality {
        round_trip_us: None,
        ..link
    }
}

fn recorded(counters: Counters) -> Counters {
    Counters {
        echoes_whole: 0,
        echoes_cut: 0,
        level_bytes: 0,
        text_bytes: 0,
        blocks: 0,
        // Only the computer that recorded knows when it was late.
        not_asked: 0,
        ..counters
    }
}

/// Nothing differs.
pub fn assert_same(file: &[u8], shown: &[Shown], context: &dyn Debug) {
    let differ = differences(file, shown);
    let first = differ.iter().next();
    assert!(first.is_none(), "{context:?}: {first:#?}");
}
