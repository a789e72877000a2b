//! Raw frames: what is sent, and what is answered.

use crate::fixture::{Fixture, ID, amps, id, longest_gap, ms, rpm};
use motorlink_bus::{
    Activity, Command, Consent, Event, RawAnswer, RawInterval, RawStatus, Refusal, Repeat,
    StopReason,
};
use motorlink_protocol::{CurrentTarget, Frame, Layout, Mode, Request, Rpm};
use motorlink_simulator::{Echo, WireFaults, WorldConfig};

const QUERY: &str = "01 74 00 00 00 00 00 00 00 04";
const DRIVE_100: &str = "01 64 00 64 00 00 00 00 00 4F";

fn every(count: u32, interval_ms: u16) -> Repeat {
    let interval = RawInterval::new(interval_ms).unwrap();
    Repeat::Times { count, interval }
}

fn raw(text: &str, repeat: Repeat) -> Command {
    raw_frame(text.parse().unwrap(), repeat)
}

fn raw_frame(frame: Frame, repeat: Repeat) -> Command {
    Command::SendRaw {
        frame,
        repeat,
        consent: Consent::None,
    }
}

fn status(fixture: &Fixture) -> RawStatus {
    fixture.bus.raw().unwrap()
}

fn times_sent(fixture: &Fixture, text: &str) -> Vec<motorlink_protocol::Instant> {
    let frame: Frame = text.parse().unwrap();
    let sent = fixture.sent.iter().filter(|sent| sent.frame == frame);
    sent.map(|sent| sent.at).collect()
}

#[test]
fn a_frame_is_sent_as_it_is_and_its_reply_is_reported() {
    let mut fixture = Fixture::one_motor();
    fixture.command(raw(QUERY, Repeat::Once)).unwrap();
    fixture.run(ms(20));
    let status = status(&fixture);
    assert_eq!(
        (status.sent, status.answered, status.running),
        (1, 1, false)
    );
    match status.last.unwrap() {
        RawAnswer::Reply {
            frame,
            asked,
            after_us,
        } => {
            assert!(frame.crc_holds());
            assert_eq!(asked, Some(Layout::Query));
            assert!((2_000..5_000).contains(&after_us), "{after_us} us");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn silence_is_reported_and_no_motor_is_queried_for_telemetry() {
    let mut fixture = Fixture::one_motor();
    let no_motor = Request::Query { id: id(9) }.frame();
    fixture.command(raw_frame(no_motor, Repeat::Once)).unwrap();
    fixture.run(ms(100));
    assert!(matches!(
        status(&fixture).last,
        Some(RawAnswer::Silence { .. })
    ));
    assert_eq!(fixture.bus.motors(fixture.now).count(), 1);
}

#[test]
fn a_frame_with_a_wrong_crc_goes_out_and_the_motor_is_silent() {
    let mut fixture = Fixture::one_motor();
    let wrong = "01 74 00 00 00 00 00 00 00 05";
    fixture.command(raw(wrong, Repeat::Once)).unwrap();
    fixture.run(ms(50));
    assert_eq!(times_sent(&fixture, wrong).len(), 1);
    assert!(matches!(
        status(&fixture).last,
        Some(RawAnswer::Silence { .. })
    ));
}

#[test]
fn a_repeated_frame_keeps_its_interval_and_its_count() {
    let mut fixture = Fixture::one_motor();
    fixture.command(raw(DRIVE_100, every(50, 20))).unwrap();
    fixture.run(ms(2_000));
    let times = times_sent(&fixture, DRIVE_100);
    assert_eq!(times.len(), 50);
    assert!(longest_gap(&times) < ms(25), "{:?}", longest_gap(&times));
    assert_eq!(
        (status(&fixture).sent, status(&fixture).running),
        (50, false)
    );
}

#[test]
fn while_stopped_only_harmless_frames_go_out() {
    let mut fixture = Fixture::one_motor();
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(500));
    assert_eq!(
        fixture.command(raw(DRIVE_100, Repeat::Once)),
        Err(Refusal::Halted)
    );
    fixture.command(raw(QUERY, Repeat::Once)).unwrap();
}

#[test]
fn one_wheel_is_driven_in_one_way_at_a_time() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(50)).unwrap();
    assert_eq!(
        fixture.command(raw(DRIVE_100, Repeat::Once)),
        Err(Refusal::Driven(ID))
    );
    fixture.command(raw(QUERY, Repeat::Once)).unwrap();
    fixture.run(ms(100));
    assert!(
        matches!(fixture.activity(), Activity::Driven { .. }),
        "a query disturbs no motor"
    );

    let mut fixture = Fixture::one_motor();
    fixture.command(raw(DRIVE_100, every(0, 20))).unwrap();
    fixture.run(ms(100));
    assert_eq!(fixture.drive(rpm(50)), Err(Refusal::RawRunning));
    let switch = Command::SwitchMode {
        id: ID,
        mode: Mode::Current,
    };
    assert_eq!(fixture.command(switch), Err(Refusal::RawRunning));
}

#[test]
fn a_high_current_asks_each_time() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    let high = Request::drive(ID, amps(7.0)).frame();
    assert_eq!(
        fixture.command(raw_frame(high, Repeat::Once)),
        Err(Refusal::NeedsConsent(CurrentTarget::from_amps(7.0)))
    );
    fixture
        .command(Command::SendRaw {
            frame: high,
            repeat: Repeat::Once,
            consent: Consent::HighCurrent,
        })
        .unwrap();
}

#[test]
fn a_raw_switch_to_the_position_loop_needs_a_slow_wheel() {
    let mut fixture = Fixture::one_motor();
    let switch = Request::SwitchMode {
        id: ID,
        mode: Mode::Position,
    }
    .frame();
    fixture.command(raw(DRIVE_100, every(40, 20))).unwrap();
    fixture.run(ms(850));
    assert!(matches!(
        fixture.command(raw_frame(switch, Repeat::Once)),
        Err(Refusal::TooFast(_))
    ));
}

/// A person may paste a reply: the adapter echoes it, and it must not count as telemetry.
#[test]
fn echo_of_a_raw_frame_that_looks_like_a_reply_is_no_telemetry() {
    let echo = WorldConfig {
        faults: WireFaults {
            echo: Echo::Whole,
            ..WireFaults::default()
        },
        ..WorldConfig::default()
    };
    let mut fixture = Fixture::watching(echo, &[ID]);
    let pasted = Frame::with_crc([1, 2, 0, 0, 0, 200, 0x20, 0xF6, 0x00]);
    fixture.command(raw_frame(pasted, Repeat::Once)).unwrap();
    fixture.run(ms(200));
    assert_eq!(status(&fixture).sent, 1);
    assert!(matches!(
        status(&fixture).last,
        Some(RawAnswer::Silence { .. })
    ));
    let samples = fixture.events.iter().filter_map(|(_, event)| match event {
        Event::Telemetry(sample) => sample.reply.speed.map(Rpm::magnitude),
        _ => None,
    });
    let speeds: Vec<u16> = samples.collect();
    assert!(!speeds.is_empty());
    assert!(speeds.iter().all(|speed| *speed == 0), "{speeds:?}");
}

#[test]
fn raw_mode_switch_reports_that_it_has_no_answer() {
    let mut fixture = Fixture::one_motor();
    let mode = Mode::Velocity;
    let switch = Request::SwitchMode { id: ID, mode }.frame();
    fixture.command(raw_frame(switch, Repeat::Once)).unwrap();
    fixture.run(ms(100));
    assert_eq!(status(&fixture).last, Some(RawAnswer::NoneExpected));
}

#[test]
fn answer_to_the_frame_before_does_not_count_for_a_new_raw_frame() {
    let mut fixture = Fixture::one_motor();
    let query = |id| raw_frame(Request::Query { id }.frame(), Repeat::Once);
    fixture.run(ms(10));
    fixture.command(query(ID)).unwrap();
    fixture.run(ms(1));
    assert_eq!((status(&fixture).sent, status(&fixture).answered), (1, 0));
    fixture.command(query(id(9))).unwrap();
    fixture.run(ms(60));
    let status = status(&fixture);
    assert_eq!((status.sent, status.answered), (1, 0), "{status:?}");
    assert!(matches!(status.last, Some(RawAnswer::Silence { .. })));
}
