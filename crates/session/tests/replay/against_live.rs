//! A replayed run shows what the page has shown live.

use motorlink_bus::{Activity, Command, Consent, StopReason};
use motorlink_protocol::{Mode, family::Model};
use motorlink_simulator::{Echo, WireFaults};

use crate::{
    compared::{assert_same, differences},
    live::{Live, Shown, amps, id, ms, rpm},
};

fn activities(shown: &[Shown], wanted: impl Fn(&Activity) -> bool) -> usize {
    let motors = shown.iter().flat_map(|shown| &shown.motors);
    motors.filter(|motor| wanted(&motor.activity)).count()
}

#[test]
fn driving_and_stopping_is_replayed_of_every_model() {
    for model in Model::ALL {
        let mut live = Live::of(model);
        live.drive(1, rpm(60));
        live.run(ms(700));
        live.drive(2, rpm(-40));
        live.run(ms(300));
        live.command(Command::Stop(id(1))).unwrap();
        live.run(ms(900));
        live.command(Command::StopAll(StopReason::Operator))
            .unwrap();
        live.run(ms(2_000));
        let (file, shown) = live.end();
        assert!(activities(&shown, |now| matches!(now, Activity::Driven { .. })) > 8);
        assert!(activities(&shown, |now| matches!(now, Activity::Stopping { .. })) > 0);
        assert_same(&file, &shown, &model);
    }
}

#[test]
fn mode_switches_are_replayed_of_every_model() {
    for model in Model::ALL {
        let mut live = Live::of(model);
        for mode in model.modes() {
            live.switch(1, *mode);
            live.run(ms(700));
        }
        if model == Model::Ddsm115 {
            live.switch(1, Mode::Current);
            live.run(ms(400));
            live.drive(1, amps(0.5));
            live.run(ms(400));
            // With neutral frames meanwhile.
            live.switch(1, Mode::Velocity);
            live.run(ms(400));
        }
        let (file, shown) = live.end();
        assert!(activities(&shown, |now| matches!(now, Activity::Switching { .. })) > 0);
        assert_same(&file, &shown, &model);
    }
}

#[test]
fn faulty_lines_are_replayed_of_every_model() {
    let lossy = WireFaults {
        lose_reply: 0.1,
        ..WireFaults::default()
    };
    let noisy = WireFaults {
        echo: Echo::Whole,
        corrupt_reply: 0.1,
        stray: 0.05,
        ..WireFaults::default()
    };
    for (model, faults) in Model::ALL
        .into_iter()
        .flat_map(|model| [(model, lossy.clone()), (model, noisy.clone())])
    {
        let mut live = Live::of(model);
        live.world.set_faults(faults.clone());
        live.drive(1, rpm(60));
        live.run(ms(900));
        live.command(Command::StopAll(StopReason::Operator))
            .unwrap();
        live.run(ms(1_200));
        let (file, shown) = live.end();
        let lost = |shown: &Shown| shown.motors[0].link.loss_per_mille > Some(0);
        assert!(shown.iter().any(lost), "{model} {faults:?}");
        assert_same(&file, &shown, &(model, faults));
    }
}

#[test]
fn a_motor_without_power_and_refused_frames_are_replayed() {
    for model in Model::ALL {
        let mut live = Live::of(model);
        live.drive(1, rpm(30));
        live.run(ms(300));
        live.world.motor_mut(id(1)).unwrap().power(false);
        live.run(ms(6_500));
        live.world.motor_mut(id(1)).unwrap().power(true);
        live.run(ms(1_500));
        live.refusals = 4;
        live.run(ms(600));
        let (file, shown) = live.end();
        let silent = shown.iter().filter(|shown| shown.motors[0].silent).count();
        assert!(silent > 10 && !shown.last().unwrap().motors[0].silent);
        assert_same(&file, &shown, &model);
    }
}

#[test]
fn a_fault_that_ends_driving_is_replayed() {
    let mut live = Live::of(Model::Ddsm115);
    live.drive(1, rpm(30));
    live.run(ms(300));
    live.world
        .motor_mut(id(1))
        .unwrap()
        .set_temperature_c(120.0);
    live.run(ms(1_500));
    let (file, shown) = live.end();
    let faults = |shown: &Shown| shown.motors[0].last.unwrap().reply.faults;
    assert!(
        shown.iter().any(|shown| !faults(shown).is_none()),
        "no fault"
    );
    assert_same(&file, &shown, &"overheated");
}

/// An adapter that holds replies for longer than their windows. A late reply that comes at the end of the window of the
/// next request looks like its answer: what a motor does is right, its statistics need not be.
#[test]
fn what_motors_do_is_replayed_of_late_replies() {
    let mut live = Live::of(Model::Ddsm115);
    live.world.set_faults(WireFaults {
        hold: ms(16),
        ..WireFaults::default()
    });
    let setpoint = rpm(40);
    let consent = Consent::None;
    let id = id(1);
    live.command(Command::Drive {
        id,
        setpoint,
        consent,
    })
    .unwrap();
    live.run(ms(2_000));
    let (file, shown) = live.end();
    let late: u64 = shown
        .last()
        .unwrap()
        .motors
        .iter()
        .map(|motor| motor.counters.late)
        .sum();
    assert!(late > 0);
    let differ = differences(&file, &shown);
    for must in ["motors", "activity", "silent", "temperature"] {
        assert!(!differ.contains_key(must), "{differ:#?}");
    }
}
