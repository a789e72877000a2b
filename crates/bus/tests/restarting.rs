//! Motors that lose power for a moment outside the velocity loop: they restart in it, where a raw current or angle
//! is a speed.

use std::time::Duration;

use crate::fixture::{Fixture, ID, driven_models, ms};
use motorlink_bus::{Activity, BusSettings, Command, CommandRate, Event};
use motorlink_protocol::{CurrentTarget, Instant, Mode, PositionTarget, Setpoint, family::Model};
use motorlink_simulator::WireFaults;

/// A driven motor in this loop. The raw value would be the highest speed in the velocity loop.
fn driven(model: Model, mode: Mode, hertz: u16) -> Fixture {
    let mut fixture = driven_models::switched(model, mode);
    fixture
        .command(Command::Configure(BusSettings {
            rate: CommandRate::new(hertz).unwrap(),
            ..BusSettings::default()
        }))
        .unwrap();
    let setpoint = match mode {
        Mode::Current => Setpoint::Current(CurrentTarget::new(0x2000).unwrap()),
        Mode::Position => Setpoint::Position(PositionTarget::from_degrees(90.0)),
        other => driven_models::setpoint(other),
    };
    if model == Model::Ddsm400 {
        // A free wheel exceeds the speed limit.
        fixture.world.motor_mut(ID).unwrap().set_load_nm(0.3);
    }
    fixture.drive(setpoint).unwrap();
    fixture.run(ms(350));
    assert!(
        matches!(fixture.activity(), Activity::Driven { .. }),
        "{model} {mode} {hertz} Hz"
    );
    fixture
}

fn power(fixture: &mut Fixture, on: bool) {
    fixture.world.motor_mut(ID).unwrap().power(on);
}

/// Runs on after a restart. Returns how many drive frames with a value the motor received in the velocity loop, and
/// the greatest speed beyond that at the restart.
fn after_restart(fixture: &mut Fixture, duration: Duration) -> (usize, f32) {
    let restarted = fixture.now;
    let end = fixture.now + duration;
    let at_first = fixture.true_rpm().abs();
    let (mut received, mut fastest) = (Vec::<Instant>::new(), 0.0_f32);
    while fixture.now < end {
        fixture.run(Duration::from_micros(200));
        let motor = fixture.world.motor(ID).unwrap();
        fastest = fastest.max(motor.speed_rpm().abs() - at_first);
        if let Some((at, drive)) = motor.last_drive()
            && at > restarted
            && motor.mode() == Mode::Velocity
            && drive.signed() != 0
            && received.last() != Some(&at)
        {
            received.push(at);
        }
    }
    (received.len(), fastest)
}

#[test]
fn no_drive_frame_of_the_old_loop_reaches_a_motor_that_has_restarted() {
    for model in Model::ALL {
        for mode in [Mode::Current, Mode::Position, Mode::OpenLoop] {
            if !model.has(mode) {
                continue;
            }
            for hertz in [50, 500] {
                for off in [60, 100, 120, 150, 200, 250, 3_000] {
                    // Other phases of the drive frames.
                    for phase in [0, 7, 13] {
                        let mut fixture = driven(model, mode, hertz);
                        fixture.run(ms(phase));
                        power(&mut fixture, false);
                        fixture.run(ms(off));
                        power(&mut fixture, true);
                        let (received, faster) = after_restart(&mut fixture, ms(600));
                        let case = format!("{model} {mode} at {hertz} Hz, off for {off} ms");
                        assert_eq!(received, 0, "{case}");
                        assert!(faster < 1.0, "{case}: {faster} rpm");
                        assert!(
                            fixture.happened(|event| matches!(event, Event::Withdrawn { .. })),
                            "{case}"
                        );
                    }
                }
            }
        }
    }
}

/// Bytes came, but no good reply: nothing says that the loop is still the one asked for.
#[test]
fn damaged_replies_do_not_name_the_loop_of_a_motor_that_has_restarted() {
    for model in Model::ALL {
        for mode in [Mode::Current, Mode::Position, Mode::OpenLoop] {
            if !model.has(mode) {
                continue;
            }
            for hertz in [50, 200, 500] {
                for phase in 0..7 {
                    let mut fixture = driven(model, mode, hertz);
                    fixture.run(ms(phase * 3));
                    fixture.world.set_faults(WireFaults {
                        corrupt_reply: 1.0,
                        ..WireFaults::default()
                    });
                    // Shorter than the time between two drive frames: none is lost.
                    power(&mut fixture, false);
                    fixture.run(ms(1));
                    power(&mut fixture, true);
                    let (received, _) = after_restart(&mut fixture, ms(190));
                    let case = format!("{model} {mode} at {hertz} Hz, phase {phase}");
                    assert!(received <= 1, "{case}: {received} frames");
                }
            }
        }
    }
}

/// The rate of drive frames outside the velocity loop, on lines with some loss.
#[test]
fn a_line_with_moderate_loss_keeps_its_rate_outside_the_velocity_loop() {
    println!("| lost | rate | drive frames in the current loop |");
    println!("|---|---|---|");
    for lost in [0.0, 0.05, 0.1] {
        for hertz in [50, 200] {
            let mut fixture = driven(Model::Ddsm115, Mode::Current, hertz);
            fixture
                .drive(driven_models::setpoint(Mode::Current))
                .unwrap();
            fixture.world.set_faults(WireFaults {
                lose_reply: lost,
                ..WireFaults::default()
            });
            fixture.run(ms(1_000));
            fixture.forget_the_past();
            fixture.run(ms(10_000));
            let rate = fixture.drive_times(ID).len() / 10;
            println!("| {:.0} % | {hertz} Hz | {rate} /s |", lost * 100.0);
            assert!(
                rate * 10 >= usize::from(hertz) * 9,
                "{lost}, {hertz} Hz: {rate}"
            );
        }
    }
}
