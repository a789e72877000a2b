//! What a stop says of itself, and what it never sends: changes of the code that other tests let pass.

use crate::fixture::{Fixture, ID, degrees, id, ms, rpm, two};
use motorlink_bus::{Command, Consent, Event, Output, StopReason, StopReport};
use motorlink_protocol::{Mode, Rpm, Setpoint};
use motorlink_simulator::{MotorConfig, WireFaults, WorldConfig};

/// Mode switches that no stop sends: 20 ms apart they would take 5 s.
const NEVER: u8 = 255;

fn report(fixture: &Fixture) -> StopReport {
    let report = fixture.events.iter().find_map(|(_, event)| match event {
        Event::StopEnded(report) => Some(report.clone()),
        _ => None,
    });
    report.expect("the stop has ended")
}

fn is_over(fixture: &Fixture) -> bool {
    fixture.happened(|event| matches!(event, Event::StopEnded(_)))
}

fn brakes(fixture: &Fixture) -> usize {
    let drives = fixture.sent.iter().filter_map(|sent| sent.drive_of(ID));
    drives
        .filter(|drive| *drive == Setpoint::Brake.into())
        .count()
}

/// A stop of all motors says so, whichever stop it joins; one before a scan takes over that of one motor.
#[test]
fn a_stop_that_joins_another_is_reported_by_the_stronger_reason() {
    use StopReason::{Job, OneMotor, Operator, PageGone};
    let one = Command::Stop(ID);
    let all = Command::StopAll(Operator);
    let scan = Command::FullScan;
    for (first, second, reason) in [
        (one, all, Operator),
        (all, one, Operator),
        (one, scan, Job),
        (scan, one, Job),
        (scan, all, Operator),
        (all, scan, Operator),
        (all, Command::StopAll(PageGone), PageGone),
        (one, Command::Stop(id(2)), OneMotor),
    ] {
        let mut fixture = two();
        for motor in [ID, id(2)] {
            let drive = Command::Drive {
                id: motor,
                setpoint: rpm(100),
                consent: Consent::None,
            };
            fixture.command(drive).unwrap();
        }
        fixture.run(ms(800));
        fixture.forget_the_past();
        fixture.command(first).unwrap();
        fixture.run(ms(10));
        fixture.command(second).unwrap();
        fixture.run_until(ms(4_000), is_over);
        assert_eq!(report(&fixture).reason, reason, "{first:?}, {second:?}");
        // The first stop is still under way.
        let motors = report(&fixture).motors.len();
        assert_eq!(motors, 2, "{first:?}, {second:?}");
    }
}

/// The second motor was driven behind the release, while the first was still on its way to a standstill.
#[test]
fn a_stop_before_a_scan_takes_over_none_of_all_motors() {
    let mut fixture = two();
    let drive = |id| Command::Drive {
        id,
        setpoint: rpm(100),
        consent: Consent::None,
    };
    fixture.command(drive(ID)).unwrap();
    fixture.run(ms(800));
    fixture.forget_the_past();
    let all = Command::StopAll(StopReason::Operator);
    for command in [all, Command::Release, drive(id(2)), Command::FullScan] {
        fixture.command(command).unwrap();
    }
    fixture.run_until(ms(4_000), is_over);
    assert_eq!(report(&fixture).reason, StopReason::Operator);
    assert_eq!(report(&fixture).motors.len(), 2);
}

/// A motor whose replies report the position loop after every request.
fn in_the_position_loop_for_good() -> Fixture {
    let motor = MotorConfig {
        // It is put there as its row of switches begins.
        mode_switch_frames: NEVER,
        ..MotorConfig::default()
    };
    let config = WorldConfig {
        motors: vec![motor],
        ..WorldConfig::default()
    };
    let mut fixture = Fixture::watching(config, &[ID]);
    let switch = Command::SwitchMode {
        id: ID,
        mode: Mode::Position,
    };
    for _ in 0..NEVER / 5 {
        fixture.command(switch).unwrap();
        fixture.run(ms(450));
    }
    assert_eq!(fixture.world.motor(ID).unwrap().mode(), Mode::Position);
    fixture.drive(degrees(120.0)).unwrap();
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture
}

/// There the brake means "turn to 0 degrees", and a wheel at rest is not stopped by it.
#[test]
fn a_motor_that_stays_in_the_position_loop_gets_no_brake_and_is_not_confirmed() {
    let mut fixture = in_the_position_loop_for_good();
    let before = fixture.world.motor(ID).unwrap().turns();
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run_until(ms(4_000), is_over);
    assert_eq!(brakes(&fixture), 0);
    let turned_deg = (fixture.world.motor(ID).unwrap().turns() - before) * 360.0;
    assert!(turned_deg.abs() < 2.0, "{turned_deg}");
    let [outcome] = <[_; 1]>::try_from(report(&fixture).motors).unwrap();
    assert!(!outcome.confirmed);
    // It stands all the same, and says so.
    assert_eq!(outcome.speed.map(Rpm::magnitude), Some(0));
}

/// Its replies are lost, or it receives nothing. Then a brake could be the first frame that arrives, and turn the wheel.
#[test]
fn a_motor_that_falls_silent_in_the_position_loop_gets_switches_and_no_brake() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Position);
    fixture.drive(degrees(120.0)).unwrap();
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture.world.motor_mut(ID).unwrap().mute(true);
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run_until(ms(4_000), is_over);
    assert_eq!(brakes(&fixture), 0);
    let switches = fixture.sent.iter().filter(|sent| sent.is_switch());
    assert!(switches.count() > 50);
    assert!(!report(&fixture).motors.iter().any(|motor| motor.confirmed));
}

/// The first motor's window has ended while the second one's goes on.
#[test]
fn stop_that_waits_for_another_motor_is_no_busy_loop() {
    let mut fixture = two();
    fixture.world.set_faults(WireFaults {
        lose_reply: 1.0,
        ..WireFaults::default()
    });
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run(ms(2_000));
    fixture.command(Command::Stop(id(2))).unwrap();
    fixture.run(ms(1_050));
    let began = fixture.now;
    let mut waits = 0;
    while fixture.now.since(began) < ms(1_000) {
        match fixture.bus.poll(fixture.now) {
            Output::Wait(at) => {
                waits += 1;
                fixture.now = at;
                fixture.world.advance(at);
                fixture.deliver();
            }
            Output::Transmit(frame) => fixture.world.transmit(fixture.now, frame.bytes()),
            Output::Event(Event::PingPage) => fixture.bus.page_answered(fixture.now),
            Output::Event(_) => {}
        }
        assert!(
            waits < 2_000,
            "{waits} waits in {:?}",
            fixture.now.since(began)
        );
    }
    assert!(waits > 100, "{waits} waits");
}
