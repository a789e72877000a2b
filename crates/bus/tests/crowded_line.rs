//! Several motors share one line: each keeps its rate, its queries and its temperature.

use std::time::Duration;

use crate::fixture::many_motors::{drive, driven, queries, watching};
use crate::fixture::{Fixture, ID, id, longest_gap, ms};
use motorlink_bus::{BusSettings, Command, CommandRate, Event};
use motorlink_protocol::{Detail, Instant, Request};

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
