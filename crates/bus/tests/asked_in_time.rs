//! Every motor is asked within a bound, on lines that lose half of the replies, in every state.

use std::{iter, time::Duration};

use crate::fixture::{Fixture, ID, Sent, amps, driven_models, id, longest_gap, ms, rpm};
use motorlink_bus::{Activity, BusSettings, Command, CommandRate, Consent, Event, StopReason};
use motorlink_protocol::{Instant, Mode, family::Model};
use motorlink_simulator::{WireFaults, WorldConfig};

fn losing(share: f64) -> WireFaults {
    WireFaults {
        lose_reply: share,
        ..WireFaults::default()
    }
}

fn at_rate(fixture: &mut Fixture, hertz: u16) {
    fixture
        .command(Command::Configure(BusSettings {
            rate: CommandRate::new(hertz).unwrap(),
            ..BusSettings::default()
        }))
        .unwrap();
}

/// What was seen of a motor that was driven for a minute.
struct Minute {
    /// Worst age of its temperature.
    age: Duration,
    drives: usize,
    requests: usize,
    /// How often it lost its setpoint.
    withdrawn: usize,
}

/// Drives a motor for a minute, and starts it again whenever chance has silenced it for 200 ms.
fn drive_for_a_minute(model: Model, hertz: u16, lost: f64, seed: u64) -> Minute {
    let mut fixture = driven_models::on(model);
    at_rate(&mut fixture, hertz);
    fixture.world.set_faults(losing(lost));
    // Another phase of the line's chance.
    fixture.run(ms(137 * seed));
    fixture.forget_the_past();
    let end = fixture.now + ms(60_000);
    let (mut age, mut driven_since) = (Duration::ZERO, None);
    while fixture.now < end {
        let status = fixture.status(ID);
        if let Activity::Driven { .. } = status.activity {
            let since = *driven_since.get_or_insert(fixture.now);
            let known = status.temperature.map_or(since, |(at, _)| at.max(since));
            age = age.max(fixture.now.since(known));
        } else {
            driven_since = None;
            let _ = fixture.command(Command::Drive {
                id: ID,
                setpoint: rpm(50),
                consent: Consent::None,
            });
        }
        fixture.run(ms(10));
    }
    let withdrawn = |(_, event): &&(Instant, Event)| matches!(event, Event::Withdrawn { .. });
    Minute {
        age,
        drives: fixture
            .sent
            .iter()
            .filter(|sent| sent.frame.bytes()[1] == 0x64)
            .count(),
        requests: fixture.sent.len(),
        withdrawn: fixture.events.iter().filter(withdrawn).count(),
    }
}

/// `cargo test --release -p motorlink-bus --test asked_in_time -- --nocapture temperature` prints the
/// table.
#[test]
fn the_temperature_of_a_driven_motor_is_never_old_on_a_line_that_loses_half() {
    println!(
        "| model | lost | rate | oldest temperature in 60 s | drive frames | other frames | withdrawn |"
    );
    println!("|---|---|---|---|---|---|---|");
    let mut too_old = Vec::new();
    for model in Model::ALL {
        for (lost, bound) in [
            (0.0, 250),
            (0.05, 500),
            (0.1, 500),
            (0.3, 1_000),
            (0.5, 2_000),
        ] {
            for hertz in [50, 200] {
                let minute = drive_for_a_minute(model, hertz, lost, 0);
                let others = minute.requests - minute.drives;
                let row = format!(
                    "| {model} | {:.0} % | {hertz} Hz | {} ms | {} /s | {} /s | {} |",
                    lost * 100.0,
                    minute.age.as_millis(),
                    minute.drives / 60,
                    others / 60,
                    minute.withdrawn
                );
                println!("{row}");
                if minute.age > ms(bound) {
                    too_old.push(row);
                }
            }
        }
    }
    assert!(too_old.is_empty(), "{too_old:#?}");
}

/// Line that loses 10 %, 200 Hz, 15 s at +50, Stop: no frame went out any more.
#[test]
fn a_motor_that_was_stopped_on_a_lossy_line_is_asked_five_times_a_second() {
    for model in Model::ALL {
        for lost in [0.1, 0.3, 0.5] {
            let mut fixture = driven_models::on(model);
            at_rate(&mut fixture, 200);
            fixture.world.set_faults(losing(lost));
            let end = fixture.now + ms(15_000);
            while fixture.now < end {
                let _ = fixture.drive(rpm(50));
                fixture.run(ms(1_000));
            }
            fixture
                .command(Command::StopAll(StopReason::Operator))
                .unwrap();
            fixture.run(ms(3_100));
            for second in 0..20 {
                fixture.forget_the_past();
                let from = fixture.now;
                fixture.run(ms(1_000));
                let asked: Vec<Instant> = fixture.sent.iter().map(|sent| sent.at).collect();
                let at = format!("{model}, {lost} lost, second {second}");
                assert!(asked.len() >= 5, "{at}: {} frames", asked.len());
                let ends = [&[from], asked.as_slice(), &[fixture.now]].concat();
                assert!(
                    longest_gap(&ends) <= ms(250),
                    "{at}: {:?}",
                    longest_gap(&ends)
                );
            }
        }
    }
}

/// The adapter holds replies until their windows are over. So the driven motor has not named its loop in time, and is
/// asked for it in the place of each drive frame; at this rate one is always due.
#[test]
fn a_motor_beside_one_that_names_its_loop_too_late_is_asked_four_times_a_second() {
    let motors = [ID, id(2)];
    // Another phase of the schedule.
    for phase in 0..20 {
        let mut fixture = Fixture::watching(WorldConfig::of(Model::Ddsm115, motors), &motors);
        at_rate(&mut fixture, 200);
        fixture
            .command(Command::SwitchMode {
                id: id(2),
                mode: Mode::Current,
            })
            .unwrap();
        fixture.run(ms(600));
        fixture
            .command(Command::Drive {
                id: id(2),
                setpoint: amps(0.4),
                consent: Consent::None,
            })
            .unwrap();
        fixture.run(ms(200 + phase));
        fixture.world.set_faults(WireFaults {
            hold: ms(16),
            ..WireFaults::default()
        });
        fixture.forget_the_past();
        let from = fixture.now;
        fixture.run(ms(3_000));
        let asked = fixture
            .sent
            .iter()
            .filter(|sent| sent.frame.bytes()[0] == ID.get())
            .map(|sent| sent.at);
        let ends: Vec<Instant> = iter::once(from).chain(asked).chain([fixture.now]).collect();
        let gap = longest_gap(&ends);
        assert!(gap <= ms(250), "phase {phase}: {gap:?}");
    }
}

/// Of two driven motors one is silent at nearly all times. While it is, the line carries no query, and behind that all
/// queries are due at once: the first motors took them all.
#[test]
fn two_driven_motors_on_a_lossy_line_leave_the_third_its_queries() {
    let ids = [1, 2, 3].map(id);
    for seed in 0..20 {
        let mut fixture = Fixture::watching(WorldConfig::with_ids(ids), &ids);
        at_rate(&mut fixture, 292);
        fixture.run(ms(500 + 37 * seed));
        fixture.world.set_faults(losing(0.45));
        let third = id(3);
        let end = fixture.now + ms(10_000);
        let mut longest = Duration::ZERO;
        while fixture.now < end {
            for (driven, speed) in [(1, -176), (2, -124)] {
                let _ = fixture.command(Command::Drive {
                    id: id(driven),
                    setpoint: rpm(speed),
                    consent: Consent::None,
                });
            }
            fixture.run(ms(50));
            if !fixture.status(third).is_silent() {
                let asked = |sent: &&Sent| sent.frame.bytes()[0] == 3;
                let last = fixture.sent.iter().rev().find(asked);
                let at = last.map_or(fixture.now, |sent| sent.at);
                longest = longest.max(fixture.now.since(at));
            }
        }
        assert!(longest <= ms(1_000), "{seed}: {longest:?}");
    }
}
