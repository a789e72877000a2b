//! Frames that a person wrote.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{Bench, ID, amps, id, longest_gap, ms, rpm};
use motorlink_bus::{
    Activity, Command, Consent, Event, RawAnswer, RawInterval, RawStatus, Refusal, Repeat,
    StopReason, WithdrawReason,
};
use motorlink_protocol::{CurrentTarget, Frame, Layout, Mode, Request};
use motorlink_simulator::WireFaults;

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

fn status(bench: &Bench) -> RawStatus {
    bench.bus.raw().unwrap()
}

fn times_sent(bench: &Bench, text: &str) -> Vec<motorlink_protocol::Instant> {
    let frame: Frame = text.parse().unwrap();
    let sent = bench.sent.iter().filter(|sent| sent.frame == frame);
    sent.map(|sent| sent.at).collect()
}

#[test]
fn a_frame_is_sent_as_it_is_and_its_reply_is_told() {
    let mut bench = Bench::one_motor();
    bench.command(raw(QUERY, Repeat::Once)).unwrap();
    bench.run(ms(20));
    let status = status(&bench);
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
fn silence_is_told_and_asks_nobody_for_telemetry() {
    let mut bench = Bench::one_motor();
    let nobody = Request::Query { id: id(9) }.frame();
    bench.command(raw_frame(nobody, Repeat::Once)).unwrap();
    bench.run(ms(100));
    assert!(matches!(
        status(&bench).last,
        Some(RawAnswer::Silence { .. })
    ));
    assert_eq!(bench.bus.motors(bench.now).count(), 1);
}

#[test]
fn a_frame_with_a_wrong_crc_goes_out_and_the_motor_says_nothing() {
    let mut bench = Bench::one_motor();
    let wrong = "01 74 00 00 00 00 00 00 00 05";
    bench.command(raw(wrong, Repeat::Once)).unwrap();
    bench.run(ms(50));
    assert_eq!(times_sent(&bench, wrong).len(), 1);
    assert!(matches!(
        status(&bench).last,
        Some(RawAnswer::Silence { .. })
    ));
}

#[test]
fn a_repeated_frame_keeps_its_interval_and_its_count() {
    let mut bench = Bench::one_motor();
    bench.command(raw(DRIVE_100, every(50, 20))).unwrap();
    bench.run(ms(2_000));
    let times = times_sent(&bench, DRIVE_100);
    assert_eq!(times.len(), 50);
    assert!(longest_gap(&times) < ms(25), "{:?}", longest_gap(&times));
    assert_eq!((status(&bench).sent, status(&bench).running), (50, false));
}

#[test]
fn a_wheel_driven_by_raw_frames_is_stopped_by_every_stop() {
    let stops = [
        Command::StopAll(StopReason::Operator),
        Command::StopAll(StopReason::PageGone),
        Command::Stop(ID),
        Command::StopRaw,
        Command::FullScan,
    ];
    for stop in stops {
        let mut bench = Bench::one_motor();
        bench.command(raw(DRIVE_100, every(0, 20))).unwrap();
        bench.run(ms(1_000));
        assert!(bench.true_rpm() > 90.0);
        assert!(bench.bus.is_active(bench.now));
        assert_eq!(bench.activity(), Activity::DrivenRaw);
        bench.forget_the_past();
        bench.command(stop).unwrap();
        assert!(!status(&bench).running);
        bench.run(ms(500));
        assert!(times_sent(&bench, DRIVE_100).is_empty(), "{stop:?}");
        assert!(
            bench.true_rpm().abs() < 1.0,
            "{stop:?}: braked, not left to coast"
        );
    }
}

#[test]
fn a_page_that_is_silent_stops_raw_frames() {
    let mut bench = Bench::one_motor();
    bench.command(raw(DRIVE_100, every(0, 20))).unwrap();
    bench.run(ms(500));
    bench.page_lives = false;
    bench.run(ms(1_500));
    assert!(bench.bus.is_halted() && !status(&bench).running);
    assert!(bench.true_rpm().abs() < 1.0);
}

#[test]
fn a_stop_of_all_reaches_a_wheel_that_one_raw_frame_moved() {
    let mut bench = Bench::one_motor();
    bench.command(raw(DRIVE_100, every(50, 20))).unwrap();
    bench.run(ms(1_050));
    assert!(
        !status(&bench).running && bench.true_rpm() > 50.0,
        "it coasts"
    );
    assert!(
        bench.bus.is_active(bench.now),
        "the line is not let go while it turns"
    );
    bench
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    bench.run(ms(500));
    assert!(bench.true_rpm().abs() < 1.0);
}

#[test]
fn while_stopped_only_harmless_frames_go_out() {
    let mut bench = Bench::one_motor();
    bench
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    bench.run(ms(500));
    assert_eq!(
        bench.command(raw(DRIVE_100, Repeat::Once)),
        Err(Refusal::Halted)
    );
    bench.command(raw(QUERY, Repeat::Once)).unwrap();
}

#[test]
fn one_wheel_is_driven_in_one_way_at_a_time() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(50)).unwrap();
    assert_eq!(
        bench.command(raw(DRIVE_100, Repeat::Once)),
        Err(Refusal::Driven(ID))
    );
    bench.command(raw(QUERY, Repeat::Once)).unwrap();
    bench.run(ms(100));
    assert!(
        matches!(bench.activity(), Activity::Driven { .. }),
        "a query disturbs nobody"
    );

    let mut bench = Bench::one_motor();
    bench.command(raw(DRIVE_100, every(0, 20))).unwrap();
    bench.run(ms(100));
    assert_eq!(bench.drive(rpm(50)), Err(Refusal::RawRunning));
    let switch = Command::SwitchMode {
        id: ID,
        mode: Mode::Current,
    };
    assert_eq!(bench.command(switch), Err(Refusal::RawRunning));
}

#[test]
fn raw_frames_are_withdrawn_for_the_same_reasons_as_any_setpoint() {
    let driven = || {
        let mut bench = Bench::one_motor();
        bench.command(raw(DRIVE_100, every(0, 20))).unwrap();
        bench.run(ms(500));
        bench.forget_the_past();
        bench
    };
    let reason = |bench: &Bench| {
        bench.events.iter().find_map(|(_, event)| match event {
            Event::Withdrawn { reason, .. } => Some(*reason),
            _ => None,
        })
    };
    let mut silent = driven();
    silent.world.set_faults(WireFaults {
        lose_reply: 1.0,
        ..WireFaults::default()
    });
    silent.run(ms(500));
    assert_eq!(reason(&silent), Some(WithdrawReason::Silent));
    assert!(!status(&silent).running);

    let mut hot = driven();
    hot.world.motor_mut(ID).unwrap().set_temperature_c(90.0);
    hot.run(ms(500));
    assert!(matches!(reason(&hot), Some(WithdrawReason::Fault(_))));
}

/// A raw current of 100 would be 100 rpm to a motor that lost power and came back.
#[test]
fn raw_frames_of_one_loop_do_not_reach_a_motor_that_came_back_in_another() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Current);
    bench
        .command(raw("01 64 07 D0 00 00 00 00 00 27", every(0, 20)))
        .unwrap();
    bench.run(ms(300));
    bench.world.motor_mut(ID).unwrap().power(false);
    bench.run(ms(100));
    bench.world.motor_mut(ID).unwrap().power(true);
    bench.run(ms(1_000));
    assert!(!status(&bench).running);
    assert!(bench.true_rpm().abs() < 1.0);
}

#[test]
fn a_high_current_asks_each_time() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Current);
    let high = Request::drive(ID, amps(7.0)).frame();
    assert_eq!(
        bench.command(raw_frame(high, Repeat::Once)),
        Err(Refusal::NeedsConsent(CurrentTarget::from_amps(7.0)))
    );
    bench
        .command(Command::SendRaw {
            frame: high,
            repeat: Repeat::Once,
            consent: Consent::HighCurrent,
        })
        .unwrap();
}

#[test]
fn a_raw_switch_to_the_position_loop_needs_a_slow_wheel() {
    let mut bench = Bench::one_motor();
    let switch = Request::SwitchMode {
        id: ID,
        mode: Mode::Position,
    }
    .frame();
    bench.command(raw(DRIVE_100, every(40, 20))).unwrap();
    bench.run(ms(850));
    assert!(matches!(
        bench.command(raw_frame(switch, Repeat::Once)),
        Err(Refusal::TooFast(_))
    ));
}
