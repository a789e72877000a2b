//! What ends a run beside the real bus, in each phase, for one to four motors and for each model.
#![cfg(test)]

mod bench;

use bench::{Bench, ONE, id, ms};
use motorlink_bus::{Command, Consent, Limits, Repeat, StopReason};
use motorlink_experiments::{
    plan::Fleet,
    runner::{Cause, End, Options, Phase, SilentSteps},
};
use motorlink_messages::runs::{FromRun, NotArmed, ToRun};
use motorlink_protocol::{Mode, Request, Setpoint, SpeedTarget, family::Model};
use motorlink_simulator::WireFaults;

const STEPS: &str = r#"{ "rpm": 60, "for_s": 20 }"#;

/// What is done to a run, the cause that must be named, and whether it ends an armed run too.
struct Abort {
    name: &'static str,
    act: fn(&mut Bench),
    is_cause: fn(Cause) -> bool,
    ends_armed: bool,
}

const fn abort(
    name: &'static str,
    act: fn(&mut Bench),
    is_cause: fn(Cause) -> bool,
    ends_armed: bool,
) -> Abort {
    Abort {
        name,
        act,
        is_cause,
        ends_armed,
    }
}

fn drive(number: u8) -> Command {
    Command::Drive {
        id: id(number),
        setpoint: Setpoint::velocity(SpeedTarget::new(20).unwrap()),
        consent: Consent::None,
    }
}

const ABORTS: [Abort; 16] = [
    abort(
        "stop all",
        |it| it.command(Command::StopAll(StopReason::Operator)),
        |cause| cause == Cause::Stopped,
        true,
    ),
    abort(
        "stop of one motor",
        |it| it.command(Command::Stop(ONE)),
        |cause| cause == Cause::Stopped,
        true,
    ),
    abort(
        "abort",
        |it| it.message(&ToRun::Abort),
        |cause| cause == Cause::Stopped,
        true,
    ),
    abort(
        "driven by hand",
        |it| it.command(drive(1)),
        |cause| cause == Cause::Driven(ONE),
        true,
    ),
    abort(
        "raw frame",
        |it| {
            it.command(Command::SendRaw {
                frame: Request::drive(ONE, Setpoint::velocity(SpeedTarget::new(20).unwrap()))
                    .frame(),
                repeat: Repeat::Once,
                consent: Consent::None,
            });
        },
        |cause| cause == Cause::Driven(ONE),
        true,
    ),
    abort(
        "scan",
        |it| it.command(Command::FullScan),
        |cause| cause == Cause::Scan,
        true,
    ),
    abort(
        "another loop by hand",
        |it| {
            it.command(Command::SwitchMode {
                id: ONE,
                mode: Mode::Current,
            });
        },
        |cause| cause == Cause::Driven(ONE),
        false,
    ),
    abort(
        "page closed",
        |it| it.command(Command::StopAll(StopReason::PageGone)),
        |cause| cause == Cause::TabClosed,
        true,
    ),
    abort(
        "remote control ended",
        |it| it.command(Command::StopAll(StopReason::OperatorLost)),
        |cause| cause == Cause::OperatorLost,
        true,
    ),
    abort(
        "page silent",
        |it| {
            it.page_answers = false;
            it.run(ms(1_500));
        },
        |cause| cause == Cause::PageSilent,
        false,
    ),
    abort(
        "focus",
        |it| it.message(&ToRun::FocusLost),
        |cause| cause == Cause::FocusLost,
        true,
    ),
    abort(
        "unplugged",
        Bench::unplug,
        |cause| cause == Cause::Unplugged,
        true,
    ),
    abort(
        "silence",
        |it| {
            it.world.set_faults(WireFaults {
                lose_reply: 1.0,
                ..WireFaults::default()
            });
            it.run(ms(700));
        },
        |cause| matches!(cause, Cause::Silent(_)),
        false,
    ),
    abort(
        "limit of the bus",
        |it| {
            let mut settings = it.settings;
            settings.limits = Limits::new(30, 2_700, 75).unwrap();
            it.command(Command::Configure(settings));
            it.run(ms(500));
        },
        |cause| matches!(cause, Cause::Limit(..)),
        false,
    ),
    abort(
        "late worker",
        |it| it.sleep(ms(700)),
        |cause| cause == Cause::Late,
        false,
    ),
    abort(
        "sleep",
        |it| it.sleep(ms(60_500)),
        |cause| cause == Cause::Slept,
        false,
    ),
];

const OPTIONS: Options = Options {
    period: ms(10),
    stop_on_lost_focus: true,
    silent_steps: SilentSteps::NONE,
};

/// Waits for the end of the stop, and checks that nothing drives again.
fn rests(bench: &mut Bench, what: &str) {
    bench.page_answers = true;
    bench.world.set_faults(WireFaults::default());
    assert_eq!(bench.driven(), None, "{what}");
    bench.run(ms(4_000));
    assert_eq!(bench.driven(), None, "{what}: later");
    assert!(
        bench.fastest_rpm() < 1.0 || bench.bus.is_none(),
        "{what}: {} rpm",
        bench.fastest_rpm()
    );
    bench.message(&ToRun::Resume);
    bench.message(&ToRun::Start { run: 7 });
    bench.command(Command::Release);
    bench.message(&ToRun::Pause);
    bench.message(&ToRun::Resume);
    bench.message(&ToRun::Start { run: 7 });
    bench.run(ms(1_000));
    assert_eq!(bench.driven(), None, "{what}: restarted");
    assert!(
        bench.host.wake().is_none() || matches!(bench.phase(), Some(Phase::Armed { .. })),
        "{what}"
    );
}

#[test]
fn every_cause_ends_a_running_and_a_paused_run_as_a_whole() {
    let mut ended = 0;
    for motors in 1..=4 {
        for Abort {
            name,
            act,
            is_cause,
            ..
        } in ABORTS
        {
            for pauses in [false, true] {
                let what = format!("{name}, {motors} motors, paused {pauses}");
                let mut bench = Bench::armed(Model::Ddsm115, motors, STEPS, OPTIONS);
                bench.start();
                bench.run(ms(800));
                assert!(bench.fastest_rpm() > 40.0, "{what}");
                if pauses {
                    bench.message(&ToRun::Pause);
                    bench.run(ms(300));
                    if name == "limit of the bus" {
                        // A wheel that stands exceeds no speed.
                        continue;
                    }
                }
                act(&mut bench);
                let cause = bench.cause();
                assert!(cause.is_some_and(is_cause), "{what}: {cause:?}");
                let samples = bench.record().samples.len();
                assert!(samples > 30, "{what}: {samples} samples");
                let last = bench.messages.last();
                assert!(matches!(last, Some(FromRun::State(_))), "{what}: {last:?}");
                rests(&mut bench, &what);
                ended += 1;
            }
        }
    }
    assert_eq!(ended, 4 * (2 * ABORTS.len() - 1));
}

#[test]
fn a_run_of_each_model_ends_as_a_whole() {
    for model in [
        Model::Ddsm115,
        Model::Ddsm315,
        Model::Ddsm210,
        Model::Ddsm400,
    ] {
        for Abort {
            name,
            act,
            is_cause,
            ..
        } in ABORTS
        {
            if name == "raw frame" && model.has_separate_frames() {
                // Its ten bytes are those of a DDSM115.
                continue;
            }
            let what = format!("{name}, {model}");
            let mut bench = Bench::armed(model, 2, STEPS, OPTIONS);
            bench.start();
            bench.run(ms(800));
            assert!(bench.fastest_rpm() > 30.0, "{what}");
            act(&mut bench);
            let cause = bench.cause();
            assert!(cause.is_some_and(is_cause), "{what}: {cause:?}");
            rests(&mut bench, &what);
        }
    }
}

/// Nobody here stops it: another motor, driven before, answers again.
#[test]
fn a_run_ends_as_told_when_another_motor_is_back_and_has_to_be_stopped() {
    let mut bench = Bench::new(Model::Ddsm115, 2);
    bench.command(drive(2));
    bench.run(ms(500));
    let power = |bench: &mut Bench, on| bench.world.motor_mut(id(2)).unwrap().power(on);
    power(&mut bench, false);
    // Its stop ends unconfirmed after its window.
    bench.run(ms(5_000));
    bench.message(&ToRun::Arm {
        run: 7,
        sequence: format!(r#"{{ "motorlink_sequence": 1, "steps": [{STEPS}] }}"#),
        fleet: Fleet::of([ONE]),
        options: OPTIONS,
    });
    bench.start();
    bench.run(ms(800));
    assert_eq!(bench.phase(), Some(Phase::Running));
    power(&mut bench, true);
    bench.run(ms(1_500));
    assert_eq!(bench.cause(), Some(Cause::LeftDriven));
    rests(&mut bench, "left driven");
}

#[test]
fn an_armed_run_moves_nothing_and_is_disarmed_by_every_act_of_a_person() {
    for Abort {
        name,
        act,
        is_cause,
        ends_armed,
    } in ABORTS
    {
        let mut bench = Bench::armed(Model::Ddsm115, 2, STEPS, OPTIONS);
        bench.run(ms(1_000));
        assert!(bench.fastest_rpm() < 1.0, "{name}");
        act(&mut bench);
        if ends_armed {
            let cause = bench.cause();
            assert!(cause.is_some_and(is_cause), "{name}: {cause:?}");
            bench.message(&ToRun::Start { run: 7 });
            bench.run(ms(300));
            assert!(!matches!(bench.phase(), Some(Phase::Running)), "{name}");
        } else {
            assert!(matches!(bench.phase(), Some(Phase::Armed { .. })), "{name}");
        }
    }
}

#[test]
fn after_the_end_nothing_of_a_run_is_left() {
    for Abort { name, act, .. } in ABORTS {
        let mut bench = Bench::armed(Model::Ddsm115, 2, r#"{ "rpm": 40, "for_s": 0.5 }"#, OPTIONS);
        bench.start();
        bench.run(ms(2_500));
        let phase = bench.phase();
        assert!(matches!(phase, Some(Phase::Ended(_))), "{name}: {phase:?}");
        let told = bench.messages.len();
        let is_driven_by_hand = name == "driven by hand";
        act(&mut bench);
        bench.run(ms(300));
        assert_eq!(bench.messages.len(), told, "{name}");
        assert_eq!(bench.driven().is_some(), is_driven_by_hand, "{name}");
    }
}

#[test]
fn a_late_start_starts_nothing() {
    let mut bench = Bench::armed(Model::Ddsm115, 1, STEPS, OPTIONS);
    bench.message_of_age(&ToRun::Start { run: 7 }, true);
    assert!(matches!(
        bench.messages.last(),
        Some(FromRun::NotStarted(_))
    ));
    bench.run(ms(500));
    assert!(bench.fastest_rpm() < 1.0);
    bench.start();
    bench.message(&ToRun::Pause);
    bench.run(ms(1_000));
    bench.message_of_age(&ToRun::Resume, true);
    bench.run(ms(500));
    assert_eq!(bench.phase(), Some(Phase::Paused));
    bench.message(&ToRun::Resume);
    bench.run(ms(500));
    assert!(bench.fastest_rpm() > 30.0);
}

#[test]
fn a_run_is_armed_on_a_free_line_only() {
    let refused = |bench: &mut Bench| {
        bench.arm(STEPS, OPTIONS);
        match bench.messages.pop() {
            Some(FromRun::NotArmed { run: 7, reason }) => reason,
            other => panic!("{other:?}"),
        }
    };
    let mut bench = Bench::new(Model::Ddsm115, 2);
    bench.command(drive(1));
    assert_eq!(refused(&mut bench), NotArmed::Busy);
    bench.command(Command::StopAll(StopReason::Operator));
    assert_eq!(refused(&mut bench), NotArmed::Halted);
    bench.run(ms(2_000));
    bench.command(Command::Release);
    bench.arm(STEPS, OPTIONS);
    bench.start();
    assert_eq!(refused(&mut bench), NotArmed::Running);
    bench.unplug();
    assert_eq!(refused(&mut bench), NotArmed::NotConnected);
    bench.arm(r#"{ "rpm": 400, "for_s": 1 }"#, OPTIONS);
    let mut bench = Bench::new(Model::Ddsm115, 2);
    bench.arm(r#"{ "rpm": 400, "for_s": 1 }"#, OPTIONS);
    assert!(matches!(
        bench.messages.last(),
        Some(FromRun::NotArmed { reason: NotArmed::Sequence(place), .. }) if place.contains("steps[0]")
    ));
}

#[test]
fn a_program_that_traps_stops_its_motors_and_leaves_the_bus_alone() {
    for motors in 1..=4 {
        let mut bench = Bench::armed(Model::Ddsm115, motors, STEPS, OPTIONS);
        bench.start();
        bench.run(ms(800));
        bench.traps = true;
        bench.run(ms(20));
        assert!(bench.died);
        rests(&mut bench, "trap");
        // The bus goes on.
        bench.command(drive(1));
        bench.run(ms(500));
        assert!(bench.fastest_rpm() > 10.0);
    }
}

/// The bus withdraws the setpoint of a motor that does not answer for 0.2 s. That is sooner than the half second after which
/// telemetry is too old to start with.
#[test]
fn silence_ends_a_run_after_a_fifth_of_a_second() {
    for pauses in [false, true] {
        let steps = r#"{ "rpm": 50, "for_s": 9 }"#;
        let mut bench = Bench::armed(Model::Ddsm115, 1, steps, Options::default());
        bench.start();
        bench.run(ms(1_000));
        if pauses {
            bench.message(&ToRun::Pause);
            bench.run(ms(500));
        }
        let silent_from = bench.now;
        bench.world.set_faults(WireFaults {
            lose_reply: 1.0,
            ..WireFaults::default()
        });
        bench.run(ms(700));
        let Some(Phase::Ended(End::Aborted { cause, at })) = bench.phase() else {
            panic!("{:?}", bench.phase());
        };
        assert_eq!(cause, Cause::Silent(ONE));
        let took = at.since(silent_from);
        assert!(took >= ms(195) && took <= ms(230), "{took:?}");
    }
}
