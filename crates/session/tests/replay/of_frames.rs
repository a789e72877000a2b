//! A session without states: what its frames tell is shown.

use motorlink_bus::{Activity, Command, LineEvent, LineEventKind, StopReason};
use motorlink_protocol::{Instant, Layout, Mode, family::Model};
use motorlink_session::{What, Writer, for_each_record, open};

use super::{
    driver::Replay,
    live::{Live, ZERO_US, id, ms, rpm},
};

/// The same file as an earlier version wrote it.
fn without_states(mut file: &[u8]) -> Vec<u8> {
    let session = open(&mut file).unwrap().unwrap();
    let mut writer = Writer::new(ZERO_US, &[]);
    for_each_record(&mut file, &session, |record| {
        if !matches!(record.what, What::State(_)) {
            writer.record(&record);
        }
    })
    .unwrap();
    writer.finish()
}

#[test]
fn replies_turns_and_setpoints_are_those_of_the_page() {
    for model in Model::ALL {
        let mut live = Live::of(model);
        live.drive(1, rpm(60));
        live.run(ms(2_500));
        let driven: Instant = live.now;
        live.command(Command::StopAll(StopReason::Operator))
            .unwrap();
        live.run(ms(2_500));
        let stopped = live.now;
        live.world.motor_mut(id(2)).unwrap().power(false);
        live.run(ms(4_000));
        let (file, updates) = live.end();
        let file = without_states(&file);
        let mut replay = Replay::of(&file);
        for at in [driven, stopped] {
            let update = updates.iter().rev().find(|update| update.now <= at);
            let update = update.unwrap();
            let shown = replay.seek(update.now);
            for (shown, live) in shown.motors.iter().zip(&update.motors) {
                assert_eq!(shown.last, live.last, "{model} {at:?}");
                assert_eq!(shown.speed, live.speed, "{model} {at:?}");
                assert_eq!(shown.temperature, live.temperature, "{model} {at:?}");
                let [shown, live] = [shown.turns, live.turns].map(Option::unwrap);
                let off = (shown.number() - live.number()).abs();
                assert!(off < 0.01, "{model} {at:?}: {shown:?} {live:?}");
            }
        }
        let setpoint = rpm(60);
        let [first, second] = replay.seek(driven).motors[..] else {
            panic!("two motors")
        };
        assert_eq!(first.activity, Activity::Driven { setpoint });
        assert_eq!(second.activity, Activity::Idle);
        assert!(!second.is_silent());
        let end = replay.seek(stopped + ms(3_900));
        assert_eq!(end.motors[0].activity, Activity::Idle);
        assert!(end.motors[1].is_silent() && !end.motors[0].is_silent());
        assert!(end.motors[1].counters.silences > 0);
    }
}

/// Where the log has no frames any more, the recording has what motors were told.
#[test]
fn a_setpoint_that_only_the_recording_has_is_shown() {
    let mut writer = Writer::new(ZERO_US, &[]);
    let at = Instant::from_millis;
    let value = Some(50_i16.to_be_bytes());
    let mode = Mode::Velocity;
    let known = LineEventKind::Known {
        id: id(1),
        mode,
        value,
    };
    let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
    let asked = Some(Layout::Drive);
    let received = LineEventKind::Received { frame, asked };
    for (at, kind) in [(at(10), known), (at(11), received), (at(900), received)] {
        writer.line(&LineEvent { at, kind });
    }
    let file = writer.finish();
    let setpoint = rpm(50);
    let shown = Replay::of(&file).seek(at(900)).motors[0];
    assert_eq!(shown.activity, Activity::Driven { setpoint });
}
