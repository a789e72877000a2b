//! What ends a run, in each of its phases, and what a start needs.

use crate::run_fixture::{Fixture, ONE, ms, two};
use motorlink_experiments::runner::{Cause, End, ExceededLimit, Options, Phase, StartRefusal};
use motorlink_protocol::{Fault, Faults, Mode};

/// What is done to a run in each phase, and the cause that must be named.
type Abort = (&'static str, fn(&mut Fixture), Cause);

fn aborts() -> Vec<Abort> {
    let fault = Faults::NONE.with(Fault::Stall);
    vec![
        (
            "stop",
            |it| it.runner.abort(it.now, Cause::Stopped),
            Cause::Stopped,
        ),
        (
            "unplug",
            |it| it.runner.abort(it.now, Cause::Unplugged),
            Cause::Unplugged,
        ),
        (
            "tab",
            |it| it.runner.abort(it.now, Cause::TabClosed),
            Cause::TabClosed,
        ),
        ("focus", |it| it.runner.focus_lost(it.now), Cause::FocusLost),
        (
            "fault",
            |it| {
                it.faults = Faults::NONE.with(Fault::Stall);
                it.reply();
            },
            Cause::Fault(ONE, fault),
        ),
        (
            "fast",
            |it| {
                it.rpm = 201;
                it.reply();
            },
            Cause::Limit(
                ONE,
                ExceededLimit::Rpm {
                    reached: 201.0,
                    limit: 200.0,
                },
            ),
        ),
        (
            "hot",
            |it| {
                it.celsius = 61;
                it.reply();
            },
            Cause::Limit(
                ONE,
                ExceededLimit::Celsius {
                    reached: 61.0,
                    limit: 60.0,
                },
            ),
        ),
        (
            "loop",
            |it| {
                it.mode = Mode::Current;
                it.reply();
            },
            Cause::OtherLoop(ONE, Mode::Current),
        ),
        (
            "silence",
            |it| {
                it.silent = Some(two());
                it.run(ms(600));
            },
            Cause::Silent(two()),
        ),
        (
            "late",
            |it| {
                it.now = it.now + ms(600);
                it.reply();
            },
            Cause::Late,
        ),
    ]
}

#[test]
fn whatever_ends_a_run_stops_it_keeps_its_data_and_starts_nothing_again() {
    let steps =
        r#"{ "rpm": 50, "for_s": 1 }, { "rpm": 9, "until": { "rpm_above": 100 }, "within_s": 5 }"#;
    let options = Options {
        stop_on_lost_focus: true,
        ..Options::default()
    };
    let phases: [(&str, u64, bool); 4] = [
        ("first step", 300, false),
        ("waiting", 2_000, false),
        ("paused", 300, true),
        ("paused while waiting", 2_000, true),
    ];
    for (name, act, expected) in aborts() {
        for (phase, after, pauses) in phases {
            let mut fixture = Fixture::armed(steps, options);
            fixture.runner.start(fixture.now).unwrap();
            fixture.run(ms(after));
            if pauses {
                fixture.runner.pause(fixture.now);
                fixture.run(ms(100));
            }
            act(&mut fixture);
            fixture.tick();
            let Phase::Ended(End::Aborted { cause, .. }) = fixture.runner.phase() else {
                panic!("{name} in {phase}: {:?}", fixture.runner.phase());
            };
            assert_eq!(cause, expected, "{name} in {phase}");
            assert_eq!(fixture.stops.len(), 1, "{name} in {phase}: stopped once");
            let kept = fixture.runner.record().samples().len();
            assert!(
                kept as u64 >= after / 5,
                "{name} in {phase}: {kept} samples"
            );
            let sent = fixture.sent.len();
            // Nothing of what may come later drives a wheel again.
            fixture.faults = Faults::NONE;
            fixture.silent = None;
            fixture.mode = Mode::Velocity;
            fixture.runner.resume(fixture.now);
            fixture.runner.pause(fixture.now);
            fixture.runner.resume(fixture.now);
            assert_eq!(
                fixture.runner.start(fixture.now),
                Err(StartRefusal::NotArmed)
            );
            fixture.run(ms(1_000));
            assert_eq!(fixture.sent.len(), sent, "{name} in {phase}: restarted");
            assert_eq!(fixture.runner.record().samples().len(), kept);
        }
    }
}

#[test]
fn a_current_above_its_limit_is_tolerated_for_a_moment() {
    let mut fixture = Fixture::started(r#"{ "rpm": 50, "for_s": 9 }"#);
    fixture.amps = 2.2;
    fixture.run(ms(450));
    fixture.amps = 1.0;
    fixture.run(ms(100));
    assert_eq!(fixture.runner.phase(), Phase::Running);
    fixture.amps = -2.2;
    fixture.run(ms(550));
    assert!(matches!(
        fixture.runner.phase(),
        Phase::Ended(End::Aborted {
            cause: Cause::Limit(_, ExceededLimit::Amps { .. }),
            ..
        })
    ));
}

#[test]
fn nothing_moves_before_the_start_and_a_start_needs_motors_that_are_ready() {
    let steps = r#"{ "rpm": 50, "for_s": 1 }"#;
    let mut fixture = Fixture::armed(steps, Options::default());
    fixture.run(ms(1_000));
    assert!(fixture.sent.is_empty());
    fixture.mode = Mode::Current;
    fixture.reply();
    let refused = fixture.runner.start(fixture.now);
    assert!(
        matches!(refused, Err(StartRefusal::OtherLoop { .. })),
        "{refused:?}"
    );
    fixture.mode = Mode::Velocity;
    fixture.faults = Faults::NONE.with(Fault::Sensor);
    fixture.reply();
    assert!(matches!(
        fixture.runner.start(fixture.now),
        Err(StartRefusal::Fault(..))
    ));
    fixture.faults = Faults::NONE;
    fixture.reply();
    let later = fixture.now + ms(501);
    assert_eq!(
        fixture.runner.start(later),
        Err(StartRefusal::NotAnswering(ONE))
    );
    fixture.run(ms(60_000));
    assert_eq!(
        fixture.runner.start(fixture.now),
        Err(StartRefusal::ArmedTooLongAgo)
    );
    // A stop of an armed run ends it too.
    let mut fixture = Fixture::armed(steps, Options::default());
    fixture.runner.abort(fixture.now, Cause::Stopped);
    assert_eq!(
        fixture.runner.start(fixture.now),
        Err(StartRefusal::NotArmed)
    );
    fixture.run(ms(100));
    assert!(fixture.sent.is_empty() && fixture.stops.is_empty());
}
