//! When the setpoints of a run are on the wire.
#![cfg(test)]

mod bench;

use std::time::Duration;

use bench::{Bench, ONE, ms};
use motorlink_bus::{BusSettings, Command, CommandRate, Ramp};
use motorlink_experiments::runner::{End, Options, Phase};
use motorlink_messages::runs::{FromRun, ToRun};
use motorlink_protocol::{Instant, Mode, Request, Setpoint, family::Model};

/// The drive frames of the first motor since this time: when, and the speed.
fn speeds(bench: &Bench, since: Instant) -> Vec<(Instant, i16)> {
    let sent = bench.wire.iter().filter(|(at, _)| *at >= since);
    sent.filter_map(|(at, frame)| match Request::parse(frame) {
        Ok(Request::Drive { id, drive }) if id == ONE => Some((*at, drive.signed())),
        _ => None,
    })
    .collect()
}

fn began(bench: &Bench) -> Instant {
    let mut states = bench.messages.iter().filter_map(|message| match message {
        FromRun::State(state) => state.began,
        _ => None,
    });
    states.next().unwrap()
}

/// Timers that are up to 0.9 ms late, and 3 ms once in a thousand times.
fn jitter() -> Vec<Duration> {
    (0..997)
        .map(|n| Duration::from_micros(if n == 50 { 3_000 } else { (n * 37) % 900 }))
        .collect()
}

#[test]
fn at_200_hz_each_setpoint_is_on_the_wire_at_its_time_for_60_s() {
    let steps = r#"{ "rpm": 60, "shape": "sine", "amplitude": 30, "hz": 0.5, "for_s": 60 }"#;
    let mut bench = Bench::new(Model::Ddsm115, 1);
    bench.late = jitter();
    bench.command(Command::Configure(BusSettings {
        rate: CommandRate::new(20).unwrap(),
        ramp: Some(Ramp::new(5).unwrap()),
        ..BusSettings::default()
    }));
    bench.arm(steps, Options::default());
    bench.start();
    bench.run(ms(60_500));
    assert!(matches!(
        bench.phase(),
        Some(Phase::Ended(End::Finished { .. }))
    ));
    let began = began(&bench);
    let end = began + ms(59_999);
    let sent = speeds(&bench, began);
    let mut late_us: Vec<u64> = Vec::new();
    for n in 0..12_000_u64 {
        let planned = began + ms(5 * n);
        let frame = sent
            .iter()
            .find(|(at, _)| *at + Duration::from_micros(100) >= planned);
        late_us.push(
            frame
                .unwrap()
                .0
                .since(planned)
                .as_micros()
                .try_into()
                .unwrap(),
        );
    }
    late_us.sort_unstable();
    let (p50, p99, worst) = (late_us[6_000], late_us[11_880], late_us[11_999]);
    println!(
        "virtual time, 200 Hz, 60 s: late by {p50} us (p50), {p99} us (p99), {worst} us (max)"
    );
    assert!(p99 <= 2_000, "{p99} us");
    assert!(worst <= 5_000, "{worst} us");
    let frames = sent.iter().filter(|(at, _)| *at <= end).count();
    assert!(
        (11_990..=12_010).contains(&frames),
        "{frames} frames: no drift"
    );
    // The plan, not the ramp of 5 rpm a second.
    let fastest = sent.iter().map(|(_, rpm)| *rpm).max();
    assert_eq!(fastest, Some(90));
    assert!(
        sent.iter()
            .any(|(at, rpm)| *rpm >= 89 && at.since(began) < ms(600))
    );
}

#[test]
fn the_record_has_every_step_from_the_first_one_on() {
    let steps = r#"{ "rpm": 30, "for_s": 0.3 }, { "rpm": 50, "for_s": 0.3 }"#;
    let mut bench = Bench::armed(Model::Ddsm115, 1, steps, Options::default());
    bench.start();
    bench.run(ms(1_500));
    let marks = bench.record().marks;
    let began = began(&bench);
    let starts: Vec<_> = marks
        .iter()
        .map(|it| (it.at.since(began), it.step))
        .collect();
    assert_eq!(starts, [(ms(0), 0), (ms(300), 1)]);
}

#[test]
fn a_step_between_two_ticks_is_sent_at_its_own_time() {
    let steps = r#"{ "rpm": 30, "for_s": 0.523 }, { "rpm": 50, "for_s": 0.3 }"#;
    let options = Options {
        period: ms(20),
        ..Options::default()
    };
    let mut bench = Bench::armed(Model::Ddsm115, 1, steps, options);
    bench.start();
    bench.run(ms(1_500));
    let began = began(&bench);
    let sent = speeds(&bench, began);
    let first = sent.iter().find(|(_, rpm)| *rpm == 50).unwrap();
    let late = first.0.since(began + ms(523));
    assert!(first.0 >= began + ms(523) && late <= ms(2), "{late:?}");
    let record = bench.record();
    let told = record.sent.iter().find(
        |sent| matches!(sent.setpoint, Setpoint::Velocity { speed, .. } if speed.rpm() == 50),
    );
    assert_eq!(
        told.unwrap().at,
        first.0,
        "the record has the time of the wire"
    );
}

#[test]
fn a_loop_ends_by_a_speed_that_its_last_step_has_reached() {
    let steps = r#"{ "repeat": 100, "until": { "rpm_above": 50 },
                     "steps": [{ "rpm": 60, "for_s": 1 }] }"#;
    let mut bench = Bench::armed(Model::Ddsm115, 1, steps, Options::default());
    bench.start();
    bench.run(ms(3_000));
    let phase = bench.phase();
    let finished = matches!(phase, Some(Phase::Ended(End::Finished { .. })));
    assert!(finished, "{phase:?}");
}

#[test]
fn the_settings_of_the_person_are_in_force_again_after_the_run() {
    let own = BusSettings {
        rate: CommandRate::new(25).unwrap(),
        ramp: Some(Ramp::new(40).unwrap()),
        ..BusSettings::default()
    };
    for aborts in [false, true] {
        let mut bench = Bench::new(Model::Ddsm115, 1);
        bench.command(Command::Configure(own));
        bench.arm(r#"{ "rpm": 60, "for_s": 1 }"#, Options::default());
        bench.start();
        bench.run(ms(500));
        // Settings that come meanwhile wait, but for the limits.
        let changed = BusSettings {
            rate: CommandRate::new(30).unwrap(),
            ..own
        };
        bench.command(Command::Configure(changed));
        let before = bench.now;
        bench.run(ms(200));
        let frames = speeds(&bench, before).len();
        assert!((38..=42).contains(&frames), "{frames} at 200 Hz");
        if aborts {
            bench.message(&ToRun::Abort);
        }
        bench.run(ms(3_000));
        assert_eq!(bench.host.settings(bench.settings), changed);
        let settings_of_bus = format!("{:?}", bench.bus);
        assert!(
            settings_of_bus.contains(&format!("{changed:?}")),
            "restored"
        );
    }
}

#[test]
fn a_run_in_each_loop_starts_and_ends() {
    for (mode, steps) in [
        (Mode::Velocity, r#"{ "rpm": 60, "for_s": 1 }"#),
        (Mode::Current, r#"{ "amps": 0.5, "for_s": 1 }"#),
        (Mode::Position, r#"{ "degrees": 90, "for_s": 1 }"#),
    ] {
        let mut bench = Bench::new(Model::Ddsm115, 2);
        bench.switch_to(mode);
        bench.arm(steps, Options::default());
        bench.start();
        bench.run(ms(5_000));
        let phase = bench.phase();
        let finished = matches!(phase, Some(Phase::Ended(End::Finished { .. })));
        assert!(finished, "{mode}: {phase:?}");
        assert_eq!(bench.driven(), None);
        assert!(bench.fastest_rpm() < 1.0, "{mode}");
        let moved = bench
            .record()
            .samples
            .iter()
            .any(|it| it.rpm.is_some_and(|rpm| rpm.abs() > 10));
        assert!(moved, "{mode}");
    }
}
