//! Several motors on one line, some of them silent: none takes the line from the others.
#![cfg(test)]

mod fixture;

use std::time::Duration;

use fixture::{Fixture, ID, id, longest_gap, ms, rpm};
use motorlink_bus::{BusSettings, Command, CommandRate, Consent, Event, StopReason};
use motorlink_protocol::{Detail, Drive, Instant, MotorId, Request, Setpoint};
use motorlink_simulator::WorldConfig;

fn watching(addresses: &[u8]) -> Fixture {
    let ids: Vec<MotorId> = addresses.iter().map(|address| id(*address)).collect();
    Fixture::watching(WorldConfig::with_ids(ids.clone()), &ids)
}

fn drive(fixture: &mut Fixture, motor: MotorId) {
    fixture
        .command(Command::Drive {
            id: motor,
            setpoint: rpm(100),
            consent: Consent::None,
        })
        .unwrap();
}

fn brakes(fixture: &Fixture, motor: MotorId) -> Vec<Instant> {
    let brake: Drive = Setpoint::Brake.into();
    let brakes = fixture
        .sent
        .iter()
        .filter(|sent| sent.drive_of(motor) == Some(brake));
    brakes.map(|sent| sent.at).collect()
}

#[test]
fn a_stop_that_joins_another_does_not_take_the_brake_from_it() {
    let mut fixture = watching(&[1, 2]);
    drive(&mut fixture, id(1));
    drive(&mut fixture, id(2));
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture.command(Command::Stop(id(1))).unwrap();
    fixture.run(ms(120));
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(300));
    let gap = longest_gap(&brakes(&fixture, id(1)));
    assert!(gap <= ms(20), "{gap:?} without brake");
}

#[test]
fn a_motor_that_loses_power_does_not_take_the_other_down() {
    let mut fixture = watching(&[1, 2]);
    drive(&mut fixture, id(1));
    drive(&mut fixture, id(2));
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture.world.motor_mut(id(1)).unwrap().power(false);
    fixture.run(ms(4_000));
    let withdrawn =
        |motor| fixture.happened(|e| matches!(e, Event::Withdrawn { id, .. } if *id == motor));
    assert!(withdrawn(id(1)));
    assert!(!withdrawn(id(2)));
    let gap = longest_gap(&fixture.drive_times(id(2)));
    assert!(gap <= ms(30), "{gap:?}");
}

#[test]
fn silent_motors_cost_a_driven_one_next_to_nothing() {
    for silent in [1, 3] {
        let addresses: Vec<u8> = (1..=1 + silent).collect();
        let mut fixture = watching(&addresses);
        drive(&mut fixture, ID);
        for address in 2..=1 + silent {
            fixture.world.motor_mut(id(address)).unwrap().power(false);
        }
        fixture.run(ms(4_000));
        fixture.forget_the_past();
        fixture.run(ms(2_000));
        let frames = fixture.drive_times(ID);
        assert!(
            frames.len() >= 98,
            "{} of 100 beside {silent} silent",
            frames.len()
        );
        assert!(longest_gap(&frames) <= ms(30), "{:?}", longest_gap(&frames));
        fixture.forget_the_past();
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        fixture.run(ms(250));
        // All of them are braked, round by round, since any may hear.
        let gap = longest_gap(&brakes(&fixture, ID));
        assert!(
            gap <= ms(10 + 10 * u64::from(silent)),
            "{gap:?} beside {silent} silent"
        );
        fixture.run(ms(150));
        assert!(fixture.true_rpm().abs() < 1.0);
    }
}

#[test]
fn temperature_is_known_at_any_rate_and_no_motor_is_called_silent_for_want_of_asking() {
    for hertz in [50, 100, 200, 300, 400, 500] {
        let mut fixture = watching(&[1, 2]);
        fixture
            .command(Command::Configure(BusSettings {
                rate: CommandRate::new(hertz).unwrap(),
                ..BusSettings::default()
            }))
            .unwrap();
        drive(&mut fixture, ID);
        fixture.run(ms(5_000));
        let readings = fixture.events.iter().filter(|(_, event)| {
            matches!(event, Event::Telemetry(sample)
                if sample.reply.id == ID && matches!(sample.reply.detail, Detail::Query { .. }))
        });
        let readings = readings.count();
        assert!(readings >= 24, "{readings} in 5 s at {hertz} Hz");
        assert!(
            !fixture.happened(|event| matches!(event, Event::MotorSilent { .. })),
            "{hertz} Hz"
        );
    }
}

/// A rover with a motor that answers after 0.2 ms.
fn driven(addresses: &[u8]) -> Fixture {
    let ids: Vec<MotorId> = addresses.iter().map(|address| id(*address)).collect();
    let config = WorldConfig {
        turnaround: Duration::from_micros(200),
        ..WorldConfig::with_ids(ids.clone())
    };
    let mut fixture = Fixture::watching(config, &ids);
    for motor in ids {
        drive(&mut fixture, motor);
    }
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture
}

fn queries(fixture: &Fixture, motor: MotorId) -> usize {
    let asked = fixture.sent.iter().map(fixture::Sent::request);
    asked
        .filter(|request| *request == Request::Query { id: motor })
        .count()
}

#[test]
fn six_motors_are_held_at_50_hz_and_asked_five_times_a_second() {
    let mut fixture = driven(&[1, 2, 3, 4, 5, 6]);
    fixture.run(ms(10_000));
    for address in 1..=6 {
        let frames = fixture.drive_times(id(address));
        assert!(frames.len() >= 495, "{} frames to {address}", frames.len());
        assert!(longest_gap(&frames) <= ms(30), "{:?}", longest_gap(&frames));
        let asked = queries(&fixture, id(address));
        assert!(asked >= 48, "{asked} queries of {address}");
    }
    assert_eq!(fixture.bus.line_status(fixture.now).carries_hz, None);
}

#[test]
fn an_overload_of_the_line_is_reported_and_shared() {
    let addresses: Vec<u8> = (1..=12).collect();
    let mut fixture = driven(&addresses);
    fixture.run(ms(10_000));
    let shares: Vec<usize> = addresses
        .iter()
        .map(|address| fixture.drive_times(id(*address)).len())
        .collect();
    let (least, most) = (shares.iter().min().unwrap(), shares.iter().max().unwrap());
    assert!(most - least <= most / 20, "{shares:?}");
    let line = fixture.bus.line_status(fixture.now);
    let carries = usize::from(line.carries_hz.expect("50 Hz is too much for twelve"));
    let got = least / 10;
    assert!(
        carries.abs_diff(got) <= got / 10,
        "{carries} Hz said, {got} Hz got"
    );
    let used = line.drive_per_mille + line.query_per_mille + line.waiting_per_mille;
    assert!(used > 950, "{line:?}");
    assert!(!fixture.happened(|event| matches!(event, Event::Withdrawn { .. })));
}

#[test]
fn one_of_four_that_falls_silent_costs_the_others_no_frame() {
    let mut fixture = driven(&[1, 2, 3, 4]);
    fixture.world.motor_mut(id(4)).unwrap().power(false);
    fixture.run(ms(30_000));
    for address in 1..=3 {
        let frames = fixture.drive_times(id(address));
        assert!(frames.len() >= 1_485, "{} to {address}", frames.len());
        assert!(longest_gap(&frames) <= ms(30), "{:?}", longest_gap(&frames));
    }
    // The bus queries it more and more rarely, and notices when it is back.
    fixture.forget_the_past();
    fixture.run(ms(16_000));
    assert!((1..=3).contains(&queries(&fixture, id(4))));
    fixture.world.motor_mut(id(4)).unwrap().power(true);
    fixture.run_until(ms(9_000), |fixture| {
        fixture.happened(|event| *event == Event::MotorBack(id(4)))
    });
}

/// Motors that have lost their bus have lower IDs than those that turn.
#[test]
fn silent_motors_do_not_delay_the_first_brake_of_the_others() {
    let mut fixture = driven(&[1, 2, 3, 4, 5, 6, 7, 8]);
    for address in 1..=5 {
        fixture.world.motor_mut(id(address)).unwrap().power(false);
    }
    fixture.run(ms(250));
    fixture.forget_the_past();
    let stopped = fixture.now;
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(400));
    for address in 6..=8 {
        let brakes = brakes(&fixture, id(address));
        let first = brakes[0].since(stopped);
        assert!(first <= ms(20), "{first:?} to the first brake of {address}");
        assert!(longest_gap(&brakes) <= ms(60), "{:?}", longest_gap(&brakes));
    }
}

#[test]
fn queries_make_no_drive_frame_late_at_200_hz() {
    let mut fixture = watching(&[1]);
    fixture
        .command(Command::Configure(BusSettings {
            rate: CommandRate::new(200).unwrap(),
            ..BusSettings::default()
        }))
        .unwrap();
    drive(&mut fixture, ID);
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    fixture.run(ms(5_000));
    let frames = fixture.drive_times(ID);
    assert!((999..=1_001).contains(&frames.len()), "{}", frames.len());
    let first = frames[0];
    let due = |place: usize| first + Duration::from_micros(5_000 * place as u64);
    let late = frames.iter().enumerate();
    let latest = late.map(|(place, at)| at.since(due(place).min(*at))).max();
    assert!(latest.unwrap() <= ms(1), "{latest:?}");
    assert!(queries(&fixture, ID) >= 25);
}

/// A busy machine looks at the clock 12 ms late, ten times a second.
#[test]
fn a_rate_is_kept_on_a_delayed_machine() {
    let mut fixture = watching(&[1]);
    fixture
        .command(Command::Configure(BusSettings {
            rate: CommandRate::new(200).unwrap(),
            ..BusSettings::default()
        }))
        .unwrap();
    drive(&mut fixture, ID);
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    for _ in 0..50 {
        fixture.run(ms(88));
        fixture.now = fixture.now + ms(12);
        fixture.world.advance(fixture.now);
    }
    let frames = fixture.drive_times(ID);
    assert!(frames.len() >= 995, "{} frames in 5 s", frames.len());
    let shortest = frames.windows(2).map(|pair| pair[1].since(pair[0])).min();
    assert!(
        shortest.unwrap() >= Duration::from_micros(2_300),
        "{shortest:?}"
    );
    // A long pause is not made up for.
    fixture.forget_the_past();
    fixture.now = fixture.now + ms(400);
    fixture.world.advance(fixture.now);
    fixture.run(ms(600));
    assert!(fixture.drive_times(ID).len() <= 132);
}

#[test]
fn a_motor_forgotten_while_it_is_asked_stays_forgotten() {
    let mut fixture = Fixture::one_motor();
    fixture.command(Command::Watch(id(9))).unwrap();
    fixture.run_until(ms(500), |fixture| {
        fixture
            .sent
            .last()
            .is_some_and(|sent| sent.request() == Request::Query { id: id(9) })
    });
    fixture.command(Command::Forget(id(9))).unwrap();
    fixture.run(ms(500));
    assert!(
        fixture
            .bus
            .motors(fixture.now)
            .all(|motor| motor.id != id(9))
    );
}

/// The queries of all motors in a row would take as long as all their drive frames.
#[test]
fn the_queries_of_many_motors_are_spread_over_their_period() {
    let mut fixture = watching(&[1, 2, 3, 4, 5, 6]);
    for address in 1..=6 {
        drive(&mut fixture, id(address));
    }
    fixture.run(ms(3_000));
    fixture.forget_the_past();
    fixture.run(ms(5_000));
    let queries = fixture.sent.iter().filter(|sent| sent.is_query());
    let times: Vec<Instant> = queries.map(|sent| sent.at).collect();
    assert!(times.len() >= 140, "{}", times.len());
    let nearest = times.windows(2).map(|pair| pair[1].since(pair[0])).min();
    assert!(nearest.unwrap() >= ms(24), "{nearest:?}");
}

/// What does not answer costs those that do nothing: 221 ms to rest, as alone.
#[test]
fn a_stop_of_16_motors_of_which_15_have_no_power_brakes_the_16th_as_if_alone() {
    let ids: Vec<MotorId> = (1..=16).map(id).collect();
    for live in [1, 9, 16] {
        let mut fixture = Fixture::watching(WorldConfig::with_ids(ids.clone()), &ids);
        let live = id(live);
        fixture
            .command(Command::Drive {
                id: live,
                setpoint: rpm(100),
                consent: Consent::None,
            })
            .unwrap();
        fixture.run(ms(1_500));
        for other in ids.iter().filter(|other| **other != live) {
            fixture.world.motor_mut(*other).unwrap().power(false);
        }
        fixture.run(ms(3_000));
        fixture.forget_the_past();
        let asked = fixture.now;
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        // Every one of them is stopped: none is known to stand.
        let stands = fixture.run_until(ms(1_000), |fixture| {
            fixture.world.motor(live).unwrap().speed_rpm().abs() < 1.0
        });
        let brakes: Vec<Instant> = fixture.drive_times(live);
        assert!(brakes[0].since(asked) <= ms(10));
        let gap = longest_gap(&brakes);
        println!("motor {live} of 16: {stands:?} to rest, brake frames {gap:?} apart at most");
        assert!(gap <= ms(25), "{gap:?}");
        assert!(stands <= ms(230), "{stands:?}");
        let others = ids.iter().filter(|other| **other != live);
        fixture.run(ms(1_500));
        for other in others {
            let frames = fixture.sent.iter();
            let to_it = frames.filter(|sent| sent.frame.bytes()[0] == other.get());
            assert!(to_it.count() > 3, "motor {other} was given up");
        }
    }
}
