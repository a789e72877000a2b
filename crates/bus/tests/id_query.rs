//! The ID query.

use crate::fixture;
use crate::fixture::{Fixture, ID, id, ms, rpm};
use motorlink_bus::{Command, Event, IdQueryOutcome, StopReason};
use motorlink_protocol::{Detail, Mode, Request};
use motorlink_simulator::{WireFaults, WorldConfig};

#[test]
fn id_query_reports_no_motor_one_motor_or_a_collision() {
    for (motors, outcome) in [
        (vec![], IdQueryOutcome::NoReply),
        (vec![9], IdQueryOutcome::One(id(9))),
        (vec![1, 2, 3], IdQueryOutcome::Garbled),
    ] {
        let ids = motors.iter().map(|address| id(*address));
        let mut fixture = Fixture::new(WorldConfig::with_ids(ids));
        fixture.command(Command::IdQuery).unwrap();
        fixture.run(ms(100));
        assert!(
            fixture.happened(|event| *event == Event::IdQueryEnded(outcome)),
            "{motors:?}: {:?}",
            fixture.events
        );
    }
}

#[test]
fn id_query_before_which_a_stop_comes_is_cancelled() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(500));
    fixture.forget_the_past();
    fixture.command(Command::IdQuery).unwrap();
    fixture.run(ms(20));
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(5_000));
    let cancelled = Event::IdQueryEnded(IdQueryOutcome::Cancelled);
    assert!(fixture.happened(|event| *event == cancelled));
    assert!(
        !fixture
            .sent
            .iter()
            .any(|sent| sent.request() == Request::IdQuery)
    );
}

/// The reply to an ID query has the layout of a drive reply. On an adapter that holds bytes it may arrive
/// in the window of a later query, where its position would be read as a temperature.
#[test]
fn reply_to_an_id_query_cut_short_is_not_read_as_that_of_a_query() {
    let hold = WorldConfig {
        faults: WireFaults {
            hold: ms(16),
            ..WireFaults::default()
        },
        ..WorldConfig::default()
    };
    let mut fixture = Fixture::watching(hold, &[ID]);
    fixture.switch(Mode::Position);
    fixture.run(ms(500));
    let mut read = 0;
    for wait in 0..12 {
        fixture.run(ms(300));
        fixture.forget_the_past();
        fixture.command(Command::IdQuery).unwrap();
        fixture.run_until(ms(100), |fixture| {
            let is_id_query = |sent: &fixture::Sent| sent.request() == Request::IdQuery;
            fixture.sent.iter().any(is_id_query)
        });
        fixture.run(ms(wait));
        fixture.command(Command::Stop(ID)).unwrap();
        fixture.run(ms(200));
        let temperatures = fixture.events.iter().filter_map(|(_, event)| match event {
            Event::Telemetry(sample) => match sample.reply.detail {
                Detail::Query { temperature, .. } => Some(temperature.degrees()),
                _ => None,
            },
            _ => None,
        });
        for temperature in temperatures {
            assert!(
                (20..40).contains(&temperature),
                "wait {wait}: {temperature}"
            );
            read += 1;
        }
        fixture.run(ms(4_000));
        fixture.switch(Mode::Position);
    }
    assert!(read >= 12, "{read} temperatures");
}
