//! Models with separate frames on lines that lose, hold and echo bytes.

use crate::fixture;
use motorlink_bus::{Activity, Command, Consent, Event, GroupSetpoints, StopReason};
use motorlink_protocol::{Detail, Mode, MotorId, family::Model};
use motorlink_simulator::{Echo, WireFaults, WorldConfig};

use crate::fixture::{Fixture, ID, id, longest_gap, ms, rpm};

fn on(model: Model, ids: &[MotorId]) -> Fixture {
    let mut config = WorldConfig::of(model, ids.iter().copied());
    for motor in &mut config.motors {
        motor.angle_deg = 30.0;
    }
    let mut fixture = Fixture::watching(config, ids);
    // A DDSM400 is enabled meanwhile.
    fixture.run(ms(700));
    fixture.forget_the_past();
    fixture
}

#[test]
fn each_model_is_driven_on_while_one_reply_in_seven_is_lost() {
    for model in Model::ALL {
        let mut fixture = on(model, &[ID]);
        fixture.drive(rpm(60)).unwrap();
        fixture.run(ms(500));
        fixture.forget_the_past();
        fixture.world.set_faults(WireFaults {
            lose_reply: 0.15,
            ..WireFaults::default()
        });
        fixture.run(ms(20_000));
        assert!(
            matches!(fixture.activity(), Activity::Driven { .. }),
            "{model}: {:?}",
            fixture.events
        );
        let drives = fixture.sent.iter().map(|sent| sent.frame.bytes());
        let drives = drives.filter(|bytes| bytes.starts_with(&[ID.get(), 0x64]));
        let drives = drives.count();
        assert!(drives >= 900, "{model}: {drives} of 1000 drive frames");
    }
}

/// The reply windows of silent motors get longer than the 20 ms between the frames of a mode switch.
#[test]
fn the_mode_switch_of_a_silent_motor_delays_no_stop() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        let mut fixture = on(model, &[ID, id(2)]);
        fixture.drive(rpm(60)).unwrap();
        fixture.run(ms(500));
        for motor in [ID, id(2)] {
            fixture.world.motor_mut(motor).unwrap().power(false);
        }
        fixture.run(ms(140));
        let switch = Command::SwitchMode {
            id: id(2),
            mode: Mode::OpenLoop,
        };
        fixture.command(switch).unwrap();
        fixture.forget_the_past();
        fixture.command(Command::Stop(ID)).unwrap();
        fixture.run(ms(400));
        let brakes = fixture.sent.iter().filter(|sent| {
            let bytes = sent.frame.bytes();
            bytes.starts_with(&[ID.get(), 0x64]) && bytes[7] == 0xFF
        });
        let brakes: Vec<_> = brakes.map(|sent| sent.at).collect();
        assert!(brakes.len() >= 4, "{model}: {}", brakes.len());
        let gap = longest_gap(&brakes);
        assert!(gap <= ms(90), "{model}: {gap:?}");
    }
}

/// The echo of a DDSM210's query is a good reply: no turns, at 0 degrees.
#[test]
fn an_echo_that_begins_later_is_no_reply() {
    let mut fixture = on(Model::Ddsm210, &[ID]);
    fixture.drive(rpm(60)).unwrap();
    fixture.run(ms(3_000));
    fixture.world.set_faults(WireFaults {
        echo: Echo::Whole,
        // Later than the soonest reply.
        hold: ms(3),
        ..WireFaults::default()
    });
    fixture.forget_the_past();
    fixture.run(ms(1_000));
    for (at, event) in &fixture.events {
        if let Event::Telemetry(sample) = event {
            match sample.reply.detail {
                Detail::Odometry { turns, .. } => assert!(turns.abs() >= 2, "{at:?} {sample:?}"),
                Detail::Temperature(celsius) => assert!(celsius.degrees() > 10, "{sample:?}"),
                _ => {}
            }
        }
    }
    assert!(matches!(fixture.activity(), Activity::Driven { .. }));
}

/// The adapter cuts its echoes at first. Without power the motor answers nothing, so what comes back is an echo.
#[test]
fn a_whole_echo_behind_cut_ones_confirms_no_stop() {
    for cut in [1, 4, 9] {
        let mut fixture = on(Model::Ddsm210, &[ID]);
        fixture.world.set_faults(WireFaults {
            echo: Echo::Cut(cut),
            ..WireFaults::default()
        });
        fixture.run(ms(1_000));
        fixture.world.motor_mut(ID).unwrap().power(false);
        fixture.run(ms(600));
        fixture.world.set_faults(WireFaults {
            echo: Echo::Whole,
            // Later than the soonest reply.
            hold: ms(3),
            ..WireFaults::default()
        });
        fixture.forget_the_past();
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        fixture.run(ms(8_000));
        let ended = fixture.events.iter().find_map(|(_, event)| match event {
            Event::StopEnded(report) => Some(report.clone()),
            _ => None,
        });
        let motors = ended.unwrap().motors;
        assert!(
            motors.iter().all(|motor| !motor.confirmed),
            "{cut}: {motors:?}"
        );
        assert_eq!(motors.len(), 1, "{cut}");
    }
}

/// Slow replies make the reply windows long.
#[test]
fn the_first_stop_frames_of_silent_motors_wait_for_no_reply() {
    let ids = [ID, id(2), id(3), id(4)];
    let mut fixture = on(Model::Ddsm210, &ids);
    fixture.world.set_faults(WireFaults {
        hold: ms(30),
        ..WireFaults::default()
    });
    fixture.run(ms(1_500));
    for motor in ids {
        fixture.world.motor_mut(motor).unwrap().power(false);
    }
    fixture.run(ms(500));
    fixture.forget_the_past();
    let began = fixture.now;
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(400));
    for motor in ids {
        let first = fixture.sent.iter().find(|sent| {
            let bytes = sent.frame.bytes();
            bytes[0] == motor.get() && matches!(bytes[1], 0x64 | 0xA0)
        });
        let waited = first.unwrap().at.since(began);
        assert!(waited <= ms(40), "{motor}: {waited:?}");
    }
}

/// The bus asks for the loop a few times a second. A lost answer refuses no other speed to a motor that is driven.
#[test]
fn the_speeds_of_a_group_change_on_a_line_that_loses_replies() {
    let ids: Vec<MotorId> = (1..=6).map(id).collect();
    let mut fixture = on(Model::Ddsm210, &ids);
    fixture.run(ms(1_000));
    let group = |rpm: i32| {
        let speeds = ids.iter().map(|id| (*id, fixture::rpm(rpm)));
        GroupSetpoints::new(&speeds.collect::<Vec<_>>()).unwrap()
    };
    let drive = Command::DriveGroup {
        setpoints: group(40),
        consent: Consent::None,
    };
    fixture.command(drive).unwrap();
    fixture.world.set_faults(WireFaults {
        lose_reply: 0.05,
        ..WireFaults::default()
    });
    for step in 0..200 {
        fixture.run(ms(50));
        let adjust = Command::AdjustGroup {
            setpoints: group(if step % 2 == 0 { 0 } else { 40 }),
            consent: Consent::None,
        };
        assert_eq!(fixture.command(adjust), Ok(()), "step {step}");
    }
}
