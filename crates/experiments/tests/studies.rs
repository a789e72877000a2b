//! Studies on the virtual motor against what it was built with.

use std::{f64::consts::TAU, time::Duration};

use crate::analytic_systems::{VelocityLoop, exact_figures};
use crate::bench::{Bench, ONE};
use crate::measured::{DRY, HEATING_S, INERTIA, VISCOUS};
use motorlink_experiments::{
    analysis::{Invalid, Spread},
    plan::Fleet,
    runner::{End, Mark, Record, RecordPart, Sample, SentSetpoint},
    sequence::{self, Action, Move, Quantity, Selection, Sequence, Shape, Step},
    study::{
        CoastDownFindings, Findings, FrequencyStudy, HeatingStudy, Measured, StepStudy, Study,
        StudyKind, TorqueSpeedFindings,
    },
};
use motorlink_protocol::{Acceleration, Instant, MotorId, Setpoint, SpeedTarget, family::Model};
use motorlink_simulator::MotorConfig;

fn run(study: &Study, bench: &mut Bench) -> Findings {
    study.check(&Fleet::of([ONE])).unwrap();
    bench.run_sequence(&study.sequence());
    study.evaluate(&bench.record, &Measured::default())
}

#[test]
fn a_step_study_measures_each_acceleration_within_its_bounds() {
    let study = Study::Step(StepStudy {
        accelerations: vec![Acceleration::new(1), Acceleration::new(3)],
        ..StepStudy::of(ONE)
    });
    let Findings::Step(found) = run(&study, &mut Bench::new(1, MotorConfig::default())) else {
        panic!("not a step response");
    };
    assert_eq!((found.groups.len(), found.left_out), (2, 0));
    for (group, acceleration) in found.groups.iter().zip([1, 3]) {
        assert_eq!(group.acceleration.byte(), acceleration);
        assert_eq!(group.repeats.len(), 5);
        assert!(group.repeats.iter().all(|it| it.rpm.len() > 500));
        let exact = VelocityLoop::of_100_rpm(acceleration);
        let exact = exact_figures(|t_s| exact.step(t_s), 3.0);
        let median = |spread: Option<Spread>| spread.unwrap().median;
        let summary = group.summary;
        for (figure, exact) in [
            (summary.rise_s, exact.rise_s),
            (summary.settling_s, exact.settling_s),
        ] {
            let (figure, exact) = (median(figure), exact.unwrap());
            assert!((figure / exact - 1.0).abs() < 0.03, "{figure} {exact}");
        }
        assert!(median(summary.overshoot) < 0.01);
        assert!(median(summary.steady_error).abs() < 1.0);
    }
}

#[test]
fn a_frequency_study_marks_what_it_cannot_measure() {
    let study = Study::Frequency(FrequencyStudy {
        points: 11,
        ..FrequencyStudy::of(ONE)
    });
    let Findings::Frequency(found) = run(&study, &mut Bench::new(4, MotorConfig::default())) else {
        panic!("not a frequency response");
    };
    assert_eq!((found.points.len(), found.left_out), (11, 0));
    // The loop lags by 58 ms: see `frequency_responses.rs`.
    let lag = |hz: f64| -20.0 * (TAU * hz * 0.058).hypot(1.0).log10();
    for point in found.points {
        assert_eq!(point.invalid.is_none(), point.hz < 10.1, "{point:?}");
        let is_slow = point.hz < 2.6;
        assert!(
            !is_slow || (point.gain_db - lag(point.hz)).abs() < 0.8,
            "{point:?}"
        );
    }
}

#[test]
fn a_line_that_carries_fewer_requests_than_wished_loses_no_reply() {
    let study = Study::Frequency(FrequencyStudy::of(ONE));
    let mut bench = Bench::new(4, MotorConfig::default());
    bench.run_sequence(&study.sequence());
    let wished = Measured {
        request_hz: 500.0,
        ..Measured::default()
    };
    let Findings::Frequency(found) = study.evaluate(&bench.record, &wished) else {
        panic!("not a frequency response");
    };
    let lost = found
        .points
        .iter()
        .filter(|point| point.invalid == Some(Invalid::RepliesLost));
    assert_eq!(lost.count(), 0);
}

/// At 0.2 Hz the setpoint changes more seldom than it is sent.
#[test]
fn a_point_with_lost_replies_is_not_valid_at_any_frequency() {
    let study = Study::Frequency(FrequencyStudy {
        highest_hz: 0.4,
        points: 2,
        ..FrequencyStudy::of(ONE)
    });
    for (lost, expected) in [(0.7, Some(Invalid::RepliesLost)), (0.1, None)] {
        let mut bench = Bench::losing(4, MotorConfig::default(), lost);
        let Findings::Frequency(found) = run(&study, &mut bench) else {
            panic!("not a frequency response");
        };
        let invalid: Vec<_> = found.points.iter().map(|point| point.invalid).collect();
        assert_eq!(invalid, [expected; 2], "{lost}");
    }
}

#[test]
fn a_small_step_settles_at_the_same_time_for_any_hold() {
    let settling = |hold_s: f64| {
        let study = Study::Step(StepStudy {
            to_rpm: 10.0,
            hold_s,
            ..StepStudy::of(ONE)
        });
        let Findings::Step(found) = run(&study, &mut Bench::new(7, MotorConfig::default())) else {
            panic!("not a step response");
        };
        assert_eq!(found.groups[0].summary.settled, 5, "{hold_s} s");
        found.groups[0].summary.settling_s.unwrap().median
    };
    let all = [1.0, 3.0, 10.0, 30.0].map(settling);
    assert!(
        all.iter()
            .all(|it| (it / all[3] - 1.0).abs() < 0.05 && *it < 0.4),
        "{all:?}"
    );
}

#[test]
fn a_step_that_is_cut_short_has_only_latency_and_peaks() {
    for (acceleration, hold_s) in [(10, 1.5), (20, 2.0), (100, 1.5), (255, 1.5)] {
        let study = Study::Step(StepStudy {
            hold_s,
            repeats: 2,
            accelerations: vec![Acceleration::new(acceleration)],
            ..StepStudy::of(ONE)
        });
        let Findings::Step(found) = run(&study, &mut Bench::new(7, MotorConfig::default())) else {
            panic!("not a step response");
        };
        for repeat in &found.groups[0].repeats {
            let figures = repeat.figures;
            assert!(!figures.settled);
            assert!(figures.latency_s.is_some() && figures.peak.is_some());
            let others = [figures.rise_s, figures.overshoot, figures.wrong_way];
            assert_eq!(others, [None; 3]);
            assert_eq!((figures.settling_s, figures.steady_error), (None, None));
        }
    }
}

/// The hold that the study offers is long enough, and not twice as long as needed.
#[test]
fn a_step_settles_within_the_hold_that_is_offered() {
    for (from_rpm, to_rpm, acceleration) in [
        (0.0, 100.0, 1),
        (0.0, 100.0, 10),
        (-100.0, 100.0, 5),
        (120.0, 20.0, 20),
        (50.0, -60.0, 20),
    ] {
        let mut study = StepStudy {
            from_rpm,
            to_rpm,
            repeats: 2,
            rest_s: 3.0,
            accelerations: vec![Acceleration::new(acceleration)],
            ..StepStudy::of(ONE)
        };
        study.hold_s = study.hold_offered_s(Model::Ddsm115);
        let Findings::Step(found) = run(
            &Study::Step(study),
            &mut Bench::new(7, MotorConfig::default()),
        ) else {
            panic!("not a step response");
        };
        assert_eq!(
            found.groups[0].summary.settled, 2,
            "{from_rpm} {to_rpm} {acceleration}"
        );
    }
}

/// Replies of a motor that follows at once, at 38400 baud: 2.6 ms for each frame.
#[test]
fn a_ddsm400_has_no_lag_of_its_baud() {
    let airtime = Model::Ddsm400.frame_airtime();
    let study = FrequencyStudy {
        lowest_hz: 5.0,
        highest_hz: 10.0,
        points: 2,
        ..FrequencyStudy::of(ONE)
    };
    let began = Instant::from_millis(1_000);
    let mut record = Record::default();
    record.began(began);
    let mut part = RecordPart::default();
    let mut step_at = began;
    for (step, (shape, for_s)) in moves(&Study::Frequency(study.clone()).sequence())
        .into_iter()
        .enumerate()
    {
        part.marks.push(Mark { at: step_at, step });
        let Shape::Sine(wave) = shape else {
            step_at = step_at + Duration::from_secs_f64(for_s);
            continue;
        };
        let ticks = 0_u32..;
        for t_s in ticks
            .map(|tick| f64::from(tick) * 0.01)
            .take_while(|t_s| *t_s < for_s)
        {
            let at = step_at + Duration::from_secs_f64(t_s);
            let rpm = format!(
                "{:.0}",
                wave.centre + wave.amplitude * (TAU * wave.hz * t_s).sin()
            );
            let rpm: i16 = rpm.parse().unwrap();
            let setpoint = Setpoint::velocity(SpeedTarget::clamped(rpm.into()));
            part.sent.push(SentSetpoint {
                id: ONE,
                at,
                setpoint,
            });
            // It reports what it has just been told.
            part.samples.push(Sample {
                id: ONE,
                at: at + airtime + Duration::from_millis(5) + airtime,
                rpm: Some(rpm),
                current: None,
                degrees: None,
                celsius: None,
            });
        }
        step_at = step_at + Duration::from_secs_f64(for_s);
    }
    record.add_part(part);
    record.ended(End::Finished { at: step_at });
    let measured = Measured::of(Model::Ddsm400, 100.0);
    let Findings::Frequency(found) = Study::Frequency(study).evaluate(&record, &measured) else {
        panic!("not a frequency response");
    };
    assert_eq!(found.points.len(), 2);
    for point in found.points {
        // The middle of a held setpoint is 5 ms behind its beginning, where it is measured.
        assert_eq!(point.invalid, None);
        assert!(point.phase_deg.abs() < 0.5, "{point:?}");
    }
}

fn moves(sequence: &Sequence) -> Vec<(Shape, f64)> {
    let moves = sequence.steps.iter().map(|step| match step {
        Step::Move(Move {
            action: Action::Follow { shape, .. },
            end: sequence::End::After(for_s),
            ..
        }) => (*shape, *for_s),
        other => panic!("{other:?}"),
    });
    moves.collect()
}

#[test]
fn a_friction_study_measures_both_directions() {
    let motor = MotorConfig {
        load_nm: 0.75,
        ..MotorConfig::default()
    };
    let mut study = Study::of(StudyKind::Friction, ONE);
    let mut parameters = study.parameters();
    parameters[0].set(80.0);
    parameters[1].set(4.0);
    drop(parameters);
    let Findings::Friction(found) = run(&study, &mut Bench::new(5, motor)) else {
        panic!("not friction");
    };
    assert_eq!((found.levels.len(), found.left_out), (8, 0));
    let fit = found.friction.unwrap();
    for rpm in [20.0, 80.0] {
        let torque_nm = DRY + 0.75 + VISCOUS * rpm * TAU / 60.0;
        // The motor reports its torque current and, at a right angle to it, 0.235 A of field current.
        let reported = (torque_nm / 0.75).hypot(0.235);
        let amps = fit.coulomb_a.value + fit.viscous_a_per_rpm.value * rpm;
        assert!((amps / reported - 1.0).abs() < 0.01, "{rpm} rpm: {amps} A");
    }
}

fn coast_down(seed: u64, load_nm: f32) -> CoastDownFindings {
    let motor = MotorConfig {
        load_nm,
        ..MotorConfig::default()
    };
    let study = Study::of(StudyKind::CoastDown, ONE);
    match run(&study, &mut Bench::new(seed, motor)) {
        Findings::CoastDown(found) => found,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_coast_down_is_within_five_percent_and_inside_its_confidence() {
    let mut inside = [0; 3];
    let mut worst = 0.0_f64;
    for seed in 0..100 {
        // Each seed is another wheel: up to five times the friction of a bearing.
        let load = f32::from(u8::try_from(seed % 5).unwrap()) * 1e-3;
        let found = coast_down(seed, load);
        assert_eq!(found.coasts.len(), 6);
        let found = found.inertia.unwrap();
        let pairs = [
            (found.inertia_kg_m2, INERTIA),
            (found.dry_nm, DRY + f64::from(load)),
            (found.viscous_nm_s, VISCOUS),
        ];
        for ((estimate, truth), inside) in pairs.into_iter().zip(&mut inside) {
            worst = worst.max((estimate.value / truth - 1.0).abs());
            *inside += u32::from(estimate.holds(truth));
        }
    }
    assert!(worst < 0.05, "{worst}");
    assert!(
        inside.into_iter().all(|count| count >= 95),
        "{inside:?} of 100"
    );
}

#[test]
fn a_heating_study_ends_at_its_temperature_and_finds_the_time_constant() {
    let motor = MotorConfig {
        load_nm: 1.0,
        ..MotorConfig::default()
    };
    let study = |celsius_max| {
        Study::Heating(HeatingStudy {
            amps: 1.4,
            for_s: 1500.0,
            celsius_max,
            loaded_max_rpm: 330.0,
            ..HeatingStudy::of(ONE)
        })
    };
    let mut bench = Bench::new(1, motor.clone());
    let Findings::Heating(found) = run(&study(75.0), &mut bench) else {
        panic!("not heating");
    };
    let fit = found.heating.unwrap();
    let constant_s = fit.time_constant_s;
    assert!(
        (constant_s.value / HEATING_S - 1.0).abs() < 0.05,
        "{constant_s:?}"
    );
    let mut bench = Bench::new(1, motor);
    let Findings::Heating(short) = run(&study(45.0), &mut bench) else {
        panic!("not heating");
    };
    assert!(matches!(bench.record.end(), Some(End::Finished { .. })));
    let hottest = short.celsius.iter().map(|it| it.value).fold(0.0, f64::max);
    assert!((44.0..=47.0).contains(&hottest), "{hottest}");
}

#[test]
fn a_paused_study_does_not_take_the_pause_for_what_it_measures() {
    let paused = |kind, after_s: f64, motor: MotorConfig| {
        let mut bench = Bench::new(1, motor);
        bench.pauses_after = Some(Duration::from_secs_f64(after_s));
        run(&Study::of(kind, ONE), &mut bench)
    };
    let whole = coast_down(1, 0.0);
    let inertia = |found: &CoastDownFindings| found.inertia.unwrap().inertia_kg_m2.value;
    // In the middle of the first push.
    let Findings::CoastDown(found) = paused(StudyKind::CoastDown, 0.15, MotorConfig::default())
    else {
        panic!("not a coast-down");
    };
    let off = inertia(&found) / inertia(&whole) - 1.0;
    assert!(off.abs() < 0.05, "{off}");
    let loaded = |load_nm| MotorConfig {
        load_nm,
        ..MotorConfig::default()
    };
    let Findings::Heating(found) = paused(StudyKind::Heating, 100.5, loaded(1.0)) else {
        panic!("not heating");
    };
    assert!(found.heating.is_none());
    let Findings::TorqueSpeed(found) = paused(StudyKind::TorqueSpeed, 5.0, loaded(0.3)) else {
        panic!("not torque and speed");
    };
    assert!(found.points.is_empty());
}

fn torque_and_speed(seed: u64, brake_nm: f32, course: fn(f32) -> f32) -> TorqueSpeedFindings {
    let mut bench = Bench::new(seed, MotorConfig::default());
    // A person leaves the wheel free for 5 s after the rise of 3 s, and then brakes.
    bench.load_nm = Some(Box::new(move |t_s| {
        let part = format!("{}", (t_s - 8.5) / 24.0).parse::<f32>().unwrap();
        brake_nm * course(part.clamp(0.0, 1.0))
    }));
    match run(&Study::of(StudyKind::TorqueSpeed, ONE), &mut bench) {
        Findings::TorqueSpeed(found) => found,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_torque_study_holds_the_true_droop_or_says_that_it_cannot_tell() {
    // 6.1 ohm over 0.75 N.m/A and 0.86 V s; 18 V over 0.86 V s (`crates/simulator/src/figures.rs`).
    let (droop, no_load) = (90.31, 199.87);
    let courses: [fn(f32) -> f32; 3] = [
        |part| part,
        |part| (part * 8.0).floor() / 8.0,
        |part| 1.0 - (2.0 * part - 1.0).abs(),
    ];
    for (seed, course) in (0..).zip(courses) {
        for brake_nm in [0.2, 0.4, 1.2] {
            let found = torque_and_speed(seed, brake_nm, course);
            assert!(found.points.len() > 1_000 && found.points.len() <= 2_000);
            let line = found.line.unwrap();
            assert!(line.no_load_rpm.holds(no_load), "{line:?}");
            assert!(line.no_load_rpm.plus_minus < 1.0);
            let Some(found) = line.droop else {
                assert!(brake_nm < 0.3, "{brake_nm} N.m is not measurable");
                continue;
            };
            assert!(found.rpm_per_nm.holds(droop), "{brake_nm} N.m: {found:?}");
            let part = found.rpm_per_nm.plus_minus / droop;
            assert!(brake_nm < 1.0 || part < 0.04, "{found:?}");
        }
    }
    // A wheel that nobody brakes tells no droop.
    let free = torque_and_speed(9, 0.0, |part| part).line.unwrap();
    assert!(free.droop.is_none(), "{free:?}");
}

#[test]
fn a_wheel_that_reaches_its_speed_is_not_at_the_voltage_limit() {
    let mut study = Study::of(StudyKind::TorqueSpeed, ONE);
    study.parameters()[0].set(150.0);
    let Findings::TorqueSpeed(found) = run(&study, &mut Bench::new(2, MotorConfig::default()))
    else {
        panic!("not torque and speed");
    };
    assert!(found.line.is_none() && !found.points.is_empty());
}

#[test]
fn an_aborted_study_has_the_figures_of_what_was_measured() {
    let study = Study::Step(StepStudy::of(ONE));
    let mut bench = Bench::new(6, MotorConfig::default());
    let mut sequence = study.sequence();
    // Two steps, and a third one that is cut short.
    sequence.steps.truncate(5);
    sequence
        .steps
        .push(Step::hold(Selection::All, Quantity::Rpm, 100.0, 0.8));
    bench.run_sequence(&sequence);
    let Findings::Step(found) = study.evaluate(&bench.record, &Measured::default()) else {
        panic!("not a step response");
    };
    assert_eq!((found.groups[0].repeats.len(), found.left_out), (2, 1));

    // While the third one runs, it is not left out.
    let mut running = Record::default();
    running.began(bench.record.began_at().unwrap());
    running.add_part(bench.record.take_part());
    let Findings::Step(found) = study.evaluate(&running, &Measured::default()) else {
        panic!("not a step response");
    };
    assert_eq!((found.groups[0].repeats.len(), found.left_out), (2, 0));
}

#[test]
fn every_study_survives_its_file_and_its_defaults_are_valid() {
    let fleet = Fleet::of([ONE]);
    for kind in StudyKind::ALL.iter().copied() {
        let study = Study::of(kind, ONE);
        study.check(&fleet).unwrap();
        assert_eq!(study.kind(), kind);
        if kind == StudyKind::Sequence {
            continue;
        }
        assert_eq!(Study::from_json(&study.to_json()).unwrap(), study);
        motorlink_experiments::plan::Plan::new(&study.sequence(), &fleet).unwrap();
    }
    let sequence = Sequence {
        name: "\"a\"".to_owned(),
        steps: vec![Step::hold(Selection::All, Quantity::Amps, 0.5, 1.0)],
        ..Sequence::default()
    };
    let study = Study::Sequence(sequence);
    assert_eq!(Study::from_json(&study.to_json()).unwrap(), study);
}

#[test]
fn an_error_names_the_parameter() {
    let fleet = Fleet::of([ONE]);
    let refused = |change: &dyn Fn(&mut StepStudy)| {
        let mut study = StepStudy::of(ONE);
        change(&mut study);
        let refused = Study::Step(study).check(&fleet).unwrap_err();
        refused.to_string()
    };
    assert_eq!(refused(&|it| it.to_rpm = 400.0), "to_rpm: 400 is above 330");
    assert_eq!(refused(&|it| it.repeats = 0), "repeats: 0 is below 1");
    assert!(refused(&|it| it.to_rpm = it.from_rpm).starts_with("to_rpm: "));
    assert!(refused(&|it| it.accelerations.clear()).starts_with("accelerations: "));
    assert!(refused(&|it| it.hold_s = f64::NAN).starts_with("hold_s: "));
    let other = MotorId::new(9).unwrap();
    assert!(refused(&|it| it.motor = other).starts_with("motor: "));
    for (text, place) in [
        ("{", ""),
        (r#"{ "motorlink_study": 2 }"#, "motorlink_study"),
        (r#"{ "motorlink_study": 1, "kind": "dance" }"#, "kind"),
        (
            r#"{ "motorlink_study": 1, "kind": "heating", "motor": 1 }"#,
            "amps",
        ),
        (
            r#"{ "motorlink_study": 1, "kind": "heating", "motor": 0 }"#,
            "motor",
        ),
    ] {
        assert_eq!(Study::from_json(text).unwrap_err().place, place, "{text}");
    }
}
