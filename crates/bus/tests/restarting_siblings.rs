//! Models with separate frames that lose power for a moment: they restart in the velocity loop, a DDSM400 is not enabled.

use crate::fixture;
use std::time::Duration;

use motorlink_bus::{Activity, BusSettings, Command, CommandRate, Consent, Event, StopReason};
use motorlink_protocol::{Frame, Mode, OpenLoopTarget, Setpoint, family::Model};
use motorlink_simulator::WorldConfig;

use crate::fixture::{Fixture, ID, degrees, every, id, longest_gap, ms, raw, rpm, status};

fn on(model: Model) -> Fixture {
    let mut fixture = Fixture::watching(WorldConfig::of(model, [ID, id(2)]), &[ID, id(2)]);
    // A DDSM400 is enabled meanwhile.
    fixture.run(ms(700));
    fixture.forget_the_past();
    fixture
}

fn switched(model: Model, mode: Mode) -> Fixture {
    let mut fixture = on(model);
    for id in [ID, id(2)] {
        fixture.command(Command::SwitchMode { id, mode }).unwrap();
    }
    fixture.run(ms(800));
    fixture.forget_the_past();
    fixture
}

fn lose_power_for(fixture: &mut Fixture, cut: Duration) {
    fixture.world.motor_mut(ID).unwrap().power(false);
    fixture.run(cut);
    fixture.world.motor_mut(ID).unwrap().power(true);
}

/// The greatest speed of the wheel in this time, in rpm.
fn fastest(fixture: &mut Fixture, duration: Duration) -> f32 {
    let end = fixture.now + duration;
    let mut fastest = 0.0_f32;
    while fixture.now < end {
        fixture.run(ms(5));
        fastest = fastest.max(fixture.true_rpm().abs());
    }
    fastest
}

fn open_loop(raw: i16) -> Setpoint {
    Setpoint::OpenLoop(OpenLoopTarget::new(raw.into()).unwrap())
}

/// A DDSM400 that is not enabled ignores brake frames too.
#[test]
fn a_stop_enables_a_turning_ddsm400_to_brake_it() {
    let mut fixture = on(Model::Ddsm400);
    fixture.drive(rpm(200)).unwrap();
    fixture.run(ms(2_000));
    lose_power_for(&mut fixture, ms(100));
    fixture.run(ms(200));
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(1_000));
    assert!(fixture.true_rpm().abs() < 1.0, "{}", fixture.true_rpm());
    let confirmed = |event: &Event| {
        matches!(event, Event::StopEnded(report)
            if report.motors.iter().any(|it| it.id == ID && it.confirmed))
    };
    assert!(fixture.happened(confirmed), "{:?}", fixture.events);
}

/// A stop changes nothing on a motor that stands and is not enabled.
#[test]
fn a_stop_enables_no_ddsm400_that_stands() {
    let mut fixture = on(Model::Ddsm400);
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(500));
    lose_power_for(&mut fixture, ms(600));
    fixture.run(ms(1_500));
    fixture.forget_the_past();
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(1_000));
    let enables = |frame: &Frame| matches!(frame.bytes(), [1, 0xA0, 8, ..]);
    assert!(!fixture.sent.iter().any(|sent| enables(&sent.frame)));
}

/// A raw value of 2,000 is 200 rpm in the velocity loop.
#[test]
fn raw_frames_wait_until_a_motor_that_may_have_restarted_names_its_loop() {
    for cut in [25, 60, 100, 150] {
        let mut fixture = switched(Model::Ddsm210, Mode::OpenLoop);
        let frame: Frame = "01 64 07 D0 00 00 00 00 00 27".parse().unwrap();
        fixture.command(raw(frame, every(0, 20))).unwrap();
        fixture.run(ms(500));
        assert!(status(&fixture).running);
        lose_power_for(&mut fixture, ms(cut));
        let before = fixture.true_rpm().abs();
        let fastest = fastest(&mut fixture, ms(1_500));
        assert!(fastest < before + 20.0, "{cut} ms: {before}, {fastest} rpm");
        assert!(!status(&fixture).running, "{cut} ms");
    }
}

/// At a low command rate no frame may fall into the time without power.
#[test]
fn an_angle_is_sent_only_to_a_motor_that_answered_just_before() {
    for hertz in [1, 5, 10] {
        for (cut, phase) in [(40, 7), (40, 31), (40, 63), (90, 3), (90, 48), (90, 95)] {
            let mut fixture = switched(Model::Ddsm210, Mode::Position);
            let settings = BusSettings {
                rate: CommandRate::new(hertz).unwrap(),
                ..BusSettings::default()
            };
            fixture.command(Command::Configure(settings)).unwrap();
            fixture.drive(degrees(180.0)).unwrap();
            fixture.run(ms(2_000 + phase));
            lose_power_for(&mut fixture, ms(cut));
            let fastest = fastest(&mut fixture, ms(2_500));
            assert!(
                fastest < 20.0,
                "{hertz} Hz, {cut} ms, {phase}: {fastest} rpm"
            );
        }
    }
}

/// The motor without power is asked for its loop before each drive frame.
#[test]
fn the_question_for_a_loop_delays_no_stop_and_no_other_motor() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        for stops in [true, false] {
            let mut fixture = switched(model, Mode::OpenLoop);
            for id in [ID, id(2)] {
                let drive = Command::Drive {
                    id,
                    setpoint: open_loop(4_000),
                    consent: Consent::None,
                };
                fixture.command(drive).unwrap();
            }
            fixture.run(ms(1_000));
            fixture.world.motor_mut(ID).unwrap().power(false);
            fixture.run(ms(60));
            fixture.forget_the_past();
            if stops {
                fixture.command(Command::Stop(id(2))).unwrap();
            }
            fixture.run(ms(250));
            let to_2 = |sent: &&fixture::Sent| {
                let bytes = sent.frame.bytes();
                bytes[0] == 2 && matches!(bytes[1], 0x64 | 0xA0)
            };
            let mut times = vec![fixture.now - ms(250)];
            times.extend(fixture.sent.iter().filter(to_2).map(|sent| sent.at));
            let gap = longest_gap(&times);
            assert!(gap <= ms(50), "{model}, stops: {stops}: {gap:?}");
        }
    }
}

/// The frame that enables it, or its answer, may be lost, and a short time without power is not noticed as a loss.
#[test]
fn a_ddsm400_is_enabled_again_after_a_short_power_cut() {
    for cut in [30, 100, 190] {
        let mut fixture = on(Model::Ddsm400);
        lose_power_for(&mut fixture, ms(cut));
        fixture.run(ms(3_000));
        let is_enabled = fixture.world.motor(ID).unwrap().active_mode().is_some();
        assert!(is_enabled, "{cut} ms");
        assert_eq!(fixture.activity(), Activity::Idle);
    }
}
