//! The study "When frames cease" on virtual motors of each behaviour, model and line.
#![cfg(test)]

mod bench;

use std::time::Duration;

use bench::{Bench, ONE, ms};
use motorlink_bus::{Activity, Command, StopReason};
use motorlink_experiments::{
    analysis::WhenSilent as Verdict,
    runner::{Cause, End, Options, Phase, Record},
    study::{Findings, Measured, SilenceFindings, Study, StudyKind},
};
use motorlink_messages::runs::ToRun;
use motorlink_protocol::{Instant, Mode, family::Model};
use motorlink_simulator::{MotorConfig, WhenSilent, WireFaults, WorldConfig};

const STUDY_LASTS: Duration = ms(5_400);

fn study() -> Study {
    Study::of(StudyKind::Silence, ONE)
}

fn world(model: Model, when_silent: WhenSilent, seed: u64, loss: f64) -> WorldConfig {
    let motor = MotorConfig {
        when_silent,
        // At 0 degrees an odometry reply is the same as its request, and may pass for an echo.
        angle_deg: 100.0,
        ..MotorConfig::of(model, ONE)
    };
    WorldConfig {
        seed,
        motors: vec![motor],
        faults: WireFaults {
            lose_request: loss / 2.0,
            lose_reply: loss / 2.0,
            ..WireFaults::default()
        },
        ..WorldConfig::of(model, [])
    }
}

fn started(config: WorldConfig) -> Bench {
    try_to_start(config).unwrap()
}

/// On a line that loses replies, a start may be refused: a person switches to the loop, and arms again, a few times.
fn try_to_start(config: WorldConfig) -> Option<Bench> {
    let mut bench = Bench::of(config);
    let options = Options {
        silent_steps: study().silent_steps(),
        ..Options::default()
    };
    for _ in 0..5 {
        bench.messages.clear();
        bench.arm_sequence(study().sequence().to_json(), options);
        bench.run(ms(300));
        bench.message(&ToRun::Start { run: 7 });
        if bench.phase() == Some(Phase::Running) {
            return Some(bench);
        }
        bench.switch_to(Mode::Velocity);
    }
    None
}

fn findings(bench: &Bench) -> SilenceFindings {
    match study().evaluate(&bench.whole_record(), &Measured::default()) {
        Findings::Silence(found) => found,
        _ => panic!("another study"),
    }
}

fn measured(config: WorldConfig) -> SilenceFindings {
    let mut bench = started(config);
    bench.run(STUDY_LASTS + ms(3_000));
    let ended = matches!(bench.phase(), Some(Phase::Ended(End::Finished { .. })));
    assert!(ended, "{:?}", bench.phase());
    assert_stands(&bench);
    findings(&bench)
}

fn assert_stands(bench: &Bench) {
    assert!(bench.fastest_rpm() < 1.0);
    assert_eq!(bench.driven(), None);
    let bus = bench.bus.as_ref().unwrap();
    for motor in bus.motors(bench.now) {
        // A DDSM400 may be enabled again.
        let activity = motor.activity;
        let is_at_rest = matches!(activity, Activity::Idle | Activity::Switching { .. });
        assert!(is_at_rest, "{activity:?}");
    }
}

/// When the drive frames of each silence ceased and went on.
fn silences(bench: &Bench) -> Vec<(Instant, Instant)> {
    let drives = bench.wire.iter();
    let drives: Vec<Instant> = drives
        .filter(|(_, frame)| frame.bytes()[1] == 0x64)
        .map(|(at, _)| *at)
        .collect();
    let pairs = drives.windows(2).map(|pair| (pair[0], pair[1]));
    pairs
        .filter(|(from, to)| to.since(*from) > ms(300))
        .collect()
}

const AFTER_100: Duration = ms(100);

#[test]
fn every_behaviour_of_every_model_is_told() {
    for model in [
        Model::Ddsm115,
        Model::Ddsm315,
        Model::Ddsm210,
        Model::Ddsm400,
    ] {
        for (when_silent, verdict) in [
            (WhenSilent::Keep, Verdict::Keeps),
            (WhenSilent::CoastAfter(AFTER_100), Verdict::Coasts),
            (WhenSilent::BrakeAfter(AFTER_100), Verdict::Brakes),
            (WhenSilent::CoastAfter(ms(300)), Verdict::Coasts),
            (WhenSilent::BrakeAfter(ms(300)), Verdict::Brakes),
            // Within 0.6 s it keeps its command.
            (WhenSilent::CoastAfter(ms(1_000)), Verdict::Keeps),
            (WhenSilent::BrakeAfter(ms(1_000)), Verdict::Keeps),
        ] {
            let found = measured(world(model, when_silent, 1, 0.0));
            assert_eq!(
                found.result,
                Some(verdict),
                "{model} {when_silent:?}: {:?} {:?}",
                found.asked_rpm,
                found.unasked_rpm
            );
        }
    }
}

#[test]
fn a_line_that_loses_replies_gives_the_same_result_or_none() {
    let mut told = 0;
    for place in 0..60 {
        let seed = u64::try_from(place).unwrap();
        let loss = [0.02, 0.1, 0.2][place % 3];
        let model = Model::ALL[place % Model::ALL.len()];
        for (when_silent, verdict) in [
            (WhenSilent::Keep, Verdict::Keeps),
            (WhenSilent::CoastAfter(AFTER_100), Verdict::Coasts),
            (WhenSilent::BrakeAfter(AFTER_100), Verdict::Brakes),
        ] {
            let Some(mut bench) = try_to_start(world(model, when_silent, seed, loss)) else {
                continue;
            };
            bench.run(STUDY_LASTS + ms(4_000));
            assert_stands(&bench);
            let found = findings(&bench);
            told += usize::from(found.result.is_some());
            assert!(
                found.result.is_none_or(|result| result == verdict),
                "seed {seed}, {model} {when_silent:?}, {loss}: {:?}",
                found.result
            );
        }
    }
    println!("told {told} of 180");
    assert!(told > 150, "{told} of 180");
}

#[test]
fn frames_cease_for_the_planned_time_with_queries_and_without() {
    let mut bench = started(world(Model::Ddsm115, WhenSilent::Keep, 1, 0.0));
    bench.run(STUDY_LASTS + ms(3_000));
    let silences = silences(&bench);
    let [with, without] = silences.as_slice() else {
        panic!("{silences:?}");
    };
    let lasted = |(from, to): &(Instant, Instant)| to.since(*from);
    assert!((ms(595)..ms(610)).contains(&lasted(with)), "{silences:?}");
    // The reading behind it takes 0.2 s more.
    assert!(
        (ms(795)..ms(810)).contains(&lasted(without)),
        "{silences:?}"
    );
    let frames = |from: Instant, to: Instant| {
        let sent = bench.wire.iter();
        sent.filter(|(at, _)| *at > from && *at < to).count()
    };
    assert!(frames(with.0, with.1) > 100, "asked at 200 Hz");
    assert!(frames(without.0, without.0 + ms(595)) <= 1);
}

#[test]
fn a_wheel_that_does_not_turn_and_replies_that_are_missing_are_not_measurable() {
    let mut bench = started(world(Model::Ddsm115, WhenSilent::Keep, 1, 0.0));
    bench.world.motor_mut(ONE).unwrap().block(true);
    bench.run(STUDY_LASTS + ms(3_000));
    assert_eq!(findings(&bench).result, None);

    let empty = study().evaluate(&Record::default(), &Measured::default());
    let Findings::Silence(empty) = empty else {
        panic!("another study");
    };
    assert_eq!(empty.result, None);
    assert_eq!(empty.asked_rpm, (None, None));
}

#[test]
fn a_stop_in_either_silence_sends_its_first_frame_at_once_and_is_confirmed() {
    // In the silence with queries, in the one without, and in the reading behind it.
    for after in [2_300, 4_900, 5_300] {
        for command in [Command::Stop(ONE), Command::StopAll(StopReason::Operator)] {
            for when_silent in WhenSilent::ALL {
                let mut bench = started(world(Model::Ddsm115, when_silent, 1, 0.0));
                bench.run(ms(after));
                let pressed = bench.now;
                bench.command(command);
                bench.run(ms(3_000));
                let mut drives = bench.wire.iter();
                let first = drives.find(|(at, frame)| *at >= pressed && frame.bytes()[1] == 0x64);
                let took = first.unwrap().0.since(pressed);
                assert!(took <= ms(4), "{after}: {took:?}");
                assert_eq!(bench.cause(), Some(Cause::Stopped));
                assert_stands(&bench);
                // Cut short, a silence says nothing.
                let result = findings(&bench).result;
                assert!(after == 5_300 || result.is_none(), "{after}: {result:?}");
            }
        }
    }
}

#[test]
fn whatever_ends_the_run_in_a_silence_stops_the_motor() {
    let ends: [fn(&mut Bench); 4] = [
        |bench| bench.message(&ToRun::Abort),
        |bench| bench.page_answers = false,
        |bench| bench.traps = true,
        |bench| bench.sleep(ms(700)),
    ];
    for after in [2_300, 4_900] {
        for (place, end) in ends.iter().enumerate() {
            let mut bench = started(world(Model::Ddsm115, WhenSilent::Keep, 1, 0.0));
            bench.run(ms(after));
            end(&mut bench);
            bench.run(ms(4_500));
            assert!(bench.stops_began > 0, "{after} {place}");
            assert_stands(&bench);
        }
    }
}

#[test]
fn a_pause_in_a_silence_brings_the_wheel_to_rest_by_frames() {
    for after in [2_300, 4_900] {
        let mut bench = started(world(Model::Ddsm115, WhenSilent::Keep, 1, 0.0));
        bench.run(ms(after));
        bench.message(&ToRun::Pause);
        bench.run(ms(1_500));
        assert_eq!(bench.phase(), Some(Phase::Paused));
        assert!(bench.fastest_rpm() < 1.0);
        bench.message(&ToRun::Resume);
        bench.run(ms(6_000));
        assert_stands(&bench);
        assert_eq!(findings(&bench).result, None);
    }
}
