//! Several motors on one line, some of them silent: none takes the line from the others.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod bench;

use bench::{Bench, ID, id, longest_gap, ms, rpm};
use motorlink_bus::{Command, CommandRate, Consent, Event, StopReason};
use motorlink_protocol::{Detail, Drive, Instant, MotorId, Request, Setpoint};
use motorlink_simulator::WorldConfig;

fn watching(addresses: &[u8]) -> Bench {
    let ids: Vec<MotorId> = addresses.iter().map(|address| id(*address)).collect();
    Bench::watching(WorldConfig::with_ids(ids.clone()), &ids)
}

fn drive(bench: &mut Bench, motor: MotorId) {
    bench
        .command(Command::Drive {
            id: motor,
            setpoint: rpm(100),
            consent: Consent::None,
        })
        .unwrap();
}

fn brakes(bench: &Bench, motor: MotorId) -> Vec<Instant> {
    let brake: Drive = Setpoint::Brake.into();
    let brakes = bench
        .sent
        .iter()
        .filter(|sent| sent.drive_of(motor) == Some(brake));
    brakes.map(|sent| sent.at).collect()
}

#[test]
fn a_stop_that_joins_another_does_not_take_the_brake_from_it() {
    let mut bench = watching(&[1, 2]);
    drive(&mut bench, id(1));
    drive(&mut bench, id(2));
    bench.run(ms(2_000));
    bench.forget_the_past();
    bench.command(Command::Stop(id(1))).unwrap();
    bench.run(ms(120));
    bench
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    bench.run(ms(300));
    let gap = longest_gap(&brakes(&bench, id(1)));
    assert!(gap <= ms(20), "{gap:?} without brake");
}

#[test]
fn a_motor_that_loses_power_does_not_take_the_other_down() {
    let mut bench = watching(&[1, 2]);
    drive(&mut bench, id(1));
    drive(&mut bench, id(2));
    bench.run(ms(2_000));
    bench.forget_the_past();
    bench.world.motor_mut(id(1)).unwrap().power(false);
    bench.run(ms(4_000));
    let withdrawn =
        |motor| bench.happened(|e| matches!(e, Event::Withdrawn { id, .. } if *id == motor));
    assert!(withdrawn(id(1)));
    assert!(!withdrawn(id(2)));
    let gap = longest_gap(&bench.drive_times(id(2)));
    assert!(gap <= ms(30), "{gap:?}");
}

#[test]
fn silent_motors_cost_a_driven_one_next_to_nothing() {
    for silent in [1, 3] {
        let addresses: Vec<u8> = (1..=1 + silent).collect();
        let mut bench = watching(&addresses);
        drive(&mut bench, ID);
        for address in 2..=1 + silent {
            bench.world.motor_mut(id(address)).unwrap().power(false);
        }
        bench.run(ms(4_000));
        bench.forget_the_past();
        bench.run(ms(2_000));
        let frames = bench.drive_times(ID);
        assert!(
            frames.len() >= 98,
            "{} of 100 beside {silent} silent",
            frames.len()
        );
        assert!(longest_gap(&frames) <= ms(30), "{:?}", longest_gap(&frames));
        bench.forget_the_past();
        bench
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        bench.run(ms(250));
        // All of them are braked, round by round, since any may hear.
        let gap = longest_gap(&brakes(&bench, ID));
        assert!(
            gap <= ms(10 + 10 * u64::from(silent)),
            "{gap:?} beside {silent} silent"
        );
        bench.run(ms(150));
        assert!(bench.true_rpm().abs() < 1.0);
    }
}

#[test]
fn temperature_is_known_at_any_rate_and_no_motor_is_called_silent_for_want_of_asking() {
    for hertz in [50, 100, 200, 300, 400, 500] {
        let mut bench = watching(&[1, 2]);
        bench
            .command(Command::SetRate(CommandRate::new(hertz).unwrap()))
            .unwrap();
        drive(&mut bench, ID);
        bench.run(ms(5_000));
        let readings = bench.events.iter().filter(|(_, event)| {
            matches!(event, Event::Telemetry(sample)
                if sample.reply.id == ID && matches!(sample.reply.detail, Detail::Query { .. }))
        });
        let readings = readings.count();
        assert!(readings >= 24, "{readings} in 5 s at {hertz} Hz");
        assert!(
            !bench.happened(|event| *event == Event::MotorSilent(id(2))),
            "{hertz} Hz"
        );
    }
}

#[test]
fn a_motor_forgotten_while_it_is_asked_stays_forgotten() {
    let mut bench = Bench::one_motor();
    bench.command(Command::Watch(id(9))).unwrap();
    bench.run_until(ms(500), |bench| {
        bench
            .sent
            .last()
            .is_some_and(|sent| sent.request() == Request::Query { id: id(9) })
    });
    bench.command(Command::Forget(id(9))).unwrap();
    bench.run(ms(500));
    assert!(bench.bus.motors(bench.now).all(|motor| motor.id != id(9)));
}
