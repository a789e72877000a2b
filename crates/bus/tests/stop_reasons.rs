//! What a stop says of itself, and what it never sends: changes of the code that other tests let pass.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod bench;

use bench::{Bench, ID, degrees, id, ms, rpm, two};
use motorlink_bus::{Command, Consent, Event, StopReason, StopReport};
use motorlink_protocol::{Mode, Rpm, Setpoint};
use motorlink_simulator::{MotorConfig, WorldConfig};

/// Mode switches that no stop sends: 20 ms apart they would take 5 s.
const NEVER: u8 = 255;

fn report(bench: &Bench) -> StopReport {
    let report = bench.events.iter().find_map(|(_, event)| match event {
        Event::StopEnded(report) => Some(report.clone()),
        _ => None,
    });
    report.expect("the stop has ended")
}

fn is_over(bench: &Bench) -> bool {
    bench.happened(|event| matches!(event, Event::StopEnded(_)))
}

fn brakes(bench: &Bench) -> usize {
    let drives = bench.sent.iter().filter_map(|sent| sent.drive_of(ID));
    drives
        .filter(|drive| *drive == Setpoint::Brake.into())
        .count()
}

/// A stop of all motors says so, whichever stop it joins; one before a scan takes over that of one motor.
#[test]
fn a_stop_that_joins_another_is_reported_by_the_stronger_reason() {
    use StopReason::{OneMotor, Operator, PageGone, Survey};
    let one = Command::Stop(ID);
    let all = Command::StopAll(Operator);
    let scan = Command::FullScan;
    for (first, second, reason) in [
        (one, all, Operator),
        (all, one, Operator),
        (one, scan, Survey),
        (scan, one, Survey),
        (scan, all, Operator),
        (all, scan, Operator),
        (all, Command::StopAll(PageGone), PageGone),
        (one, Command::Stop(id(2)), OneMotor),
    ] {
        let mut bench = two();
        for motor in [ID, id(2)] {
            let drive = Command::Drive {
                id: motor,
                setpoint: rpm(100),
                consent: Consent::None,
            };
            bench.command(drive).unwrap();
        }
        bench.run(ms(800));
        bench.forget_the_past();
        bench.command(first).unwrap();
        bench.run(ms(10));
        bench.command(second).unwrap();
        bench.run_until(ms(4_000), is_over);
        assert_eq!(report(&bench).reason, reason, "{first:?}, {second:?}");
        // The first stop is still under way.
        let motors = report(&bench).motors.len();
        assert_eq!(motors, 2, "{first:?}, {second:?}");
    }
}

/// The second motor was driven behind the release, while the first was still on its way to a standstill.
#[test]
fn a_stop_before_a_scan_takes_over_none_of_all_motors() {
    let mut bench = two();
    let drive = |id| Command::Drive {
        id,
        setpoint: rpm(100),
        consent: Consent::None,
    };
    bench.command(drive(ID)).unwrap();
    bench.run(ms(800));
    bench.forget_the_past();
    let all = Command::StopAll(StopReason::Operator);
    for command in [all, Command::Release, drive(id(2)), Command::FullScan] {
        bench.command(command).unwrap();
    }
    bench.run_until(ms(4_000), is_over);
    assert_eq!(report(&bench).reason, StopReason::Operator);
    assert_eq!(report(&bench).motors.len(), 2);
}

/// A motor whose replies report the position loop, whatever is sent.
fn in_the_position_loop_for_good() -> Bench {
    let motor = MotorConfig {
        // It is put there as its row of switches begins.
        mode_switch_frames: NEVER,
        ..MotorConfig::default()
    };
    let config = WorldConfig {
        motors: vec![motor],
        ..WorldConfig::default()
    };
    let mut bench = Bench::watching(config, &[ID]);
    let switch = Command::SwitchMode {
        id: ID,
        mode: Mode::Position,
    };
    for _ in 0..NEVER / 5 {
        bench.command(switch).unwrap();
        bench.run(ms(450));
    }
    assert_eq!(bench.world.motor(ID).unwrap().mode(), Mode::Position);
    bench.drive(degrees(120.0)).unwrap();
    bench.run(ms(2_000));
    bench.forget_the_past();
    bench
}

/// There the brake means "turn to 0 degrees", and a wheel at rest is not stopped by it.
#[test]
fn a_motor_that_stays_in_the_position_loop_gets_no_brake_and_is_not_confirmed() {
    let mut bench = in_the_position_loop_for_good();
    let before = bench.world.motor(ID).unwrap().turns();
    bench.command(Command::Stop(ID)).unwrap();
    bench.run_until(ms(4_000), is_over);
    assert_eq!(brakes(&bench), 0);
    let turned_deg = (bench.world.motor(ID).unwrap().turns() - before) * 360.0;
    assert!(turned_deg.abs() < 2.0, "{turned_deg}");
    let [outcome] = <[_; 1]>::try_from(report(&bench).motors).unwrap();
    assert!(!outcome.confirmed);
    // It stands all the same, and says so.
    assert_eq!(outcome.speed.map(Rpm::magnitude), Some(0));
}

/// It hears the switches though nobody hears it, or it hears nothing: then the brake harms nobody.
#[test]
fn a_motor_that_falls_silent_in_the_position_loop_gets_the_brake_behind_its_switches() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Position);
    bench.drive(degrees(120.0)).unwrap();
    bench.run(ms(2_000));
    bench.forget_the_past();
    bench.world.motor_mut(ID).unwrap().mute(true);
    bench.command(Command::Stop(ID)).unwrap();
    bench.run_until(ms(4_000), is_over);
    let is_brake = |sent: &&bench::Sent| sent.drive_of(ID) == Some(Setpoint::Brake.into());
    let first = bench.sent.iter().find(is_brake).expect("a brake").at;
    let before = bench.sent.iter().filter(|sent| sent.at < first);
    assert!(before.filter(|sent| sent.is_switch()).count() >= 5);
    assert!(!report(&bench).motors.iter().any(|motor| motor.confirmed));
}
