//! Several adapters that are alike: which one is opened, and what happens to a motor that was left driven.
#![cfg(test)]

mod computer;

use std::time::Duration;

use computer::{Adapter, Computer, id};
use motorlink_bus::LeftDriven;
use motorlink_messages::{LeftBehind, ModelChoice};
use motorlink_port::IfNoReply::{KeepWaiting, TakeFirst};
use motorlink_protocol::{Mode, family::Model};

const SEEDS: u64 = 1_000;
/// A motor that was left driven stands so long after the port is open.
const STANDS_WITHIN: Duration = Duration::from_secs(2);

fn left(address: u8) -> LeftDriven {
    LeftDriven {
        id: id(address),
        mode: Some(Mode::Velocity),
    }
}

const fn of_model(model: Model) -> ModelChoice {
    ModelChoice {
        model,
        detect: false,
    }
}

/// For any adapters, motors and expected model: the motors that were left driven stand, the
/// others get nothing but queries and never move, and the opening ends.
#[test]
fn the_adapter_with_the_motors_that_were_left_driven_is_found_by_queries_alone() {
    let mut found_beside_others = 0;
    for seed in 0..SEEDS {
        let mut rng = fastrand::Rng::with_seed(seed);
        let model = Model::ALL[rng.usize(..Model::ALL.len())];
        let count = rng.usize(1..=3);
        let place = rng.usize(..count);
        let motors = [&[1][..], &[2], &[1, 2]][rng.usize(..3)];
        let adapters = (0..count).map(|at| {
            let other = [&[][..], &[1], &[2], &[1, 3]][rng.usize(..4)];
            let mut adapter = Adapter::new(model, if at == place { motors } else { other });
            adapter.is_taken = at != place && rng.u8(..4) == 0;
            adapter
        });
        let mut computer = Computer::new(adapters.collect());
        let rpm = if rng.bool() { 60 } else { -100 };
        computer.leave_driven(place, model, motors, rpm);
        let choice = ModelChoice {
            model: Model::ALL[rng.usize(..Model::ALL.len())],
            detect: rng.bool(),
        };
        let wanted = rng.u8(1..=3);
        let what = format!("seed {seed}: {model:?} at {place} of {count}, {choice:?}");

        let open = computer.open(wanted, choice, TakeFirst);
        let (open, opened_for) = open.unwrap();
        assert_eq!(open, place, "{what}");
        assert!(model.is_like(opened_for), "{what}: {opened_for:?}");
        computer.run(STANDS_WITHIN);
        for address in motors {
            assert!(computer.adapters[place].rpm(*address) < 1.0, "{what}");
        }
        let all = motors.iter().map(|address| (id(*address), true));
        for stop in &mut computer.stops {
            stop.sort_unstable();
        }
        assert_eq!(computer.stops, [all.collect::<Vec<_>>()], "{what}");
        for (at, other) in computer.adapters.iter().enumerate() {
            if at != place {
                assert!(other.acts().is_empty(), "{what}: {:?}", other.acts());
                found_beside_others += usize::from(!other.sent.is_empty());
            }
        }
    }
    assert!(found_beside_others > 100, "{found_beside_others}");
}

/// A motor whose line is dead at first is stopped when it answers, if its port is the open one. Else it stays remembered.
/// Another motor with its ID never moves.
#[test]
fn a_motor_that_answers_late_is_stopped_on_the_open_port() {
    let (mut found_late, mut forgotten_by_none) = (0, 0);
    for seed in 0..SEEDS {
        let mut rng = fastrand::Rng::with_seed(seed);
        let model = Model::ALL[rng.usize(..Model::ALL.len())];
        let count = rng.usize(1..=2);
        let adapters = (0..count).map(|_| Adapter::new(model, &[1])).collect();
        let mut computer = Computer::new(adapters);
        computer.leave_driven(0, model, &[1], 100);
        let dead_for = Duration::from_millis(rng.u64(1..4_000));
        computer.cut(0, dead_for);
        let good_at = computer.now + dead_for;
        let what = format!("seed {seed}: {model:?}, {count} adapters, dead for {dead_for:?}");

        let (open, opened_for) = computer.open(1, of_model(model), TakeFirst).unwrap();
        assert_eq!(opened_for, model, "{what}");
        computer.run(good_at.since(computer.now) + STANDS_WITHIN);
        assert!(computer.adapters[open].rpm(1) < 1.0, "{what}");
        if computer.adapters[0].rpm(1) > 1.0 {
            assert_eq!(computer.left.motors, [left(1)], "{what}");
            forgotten_by_none += 1;
        }
        if open == 0 && count == 2 {
            assert!(computer.adapters[1].acts().is_empty(), "{what}");
            found_late += 1;
        }
    }
    assert!(found_late > 50, "{found_late}");
    assert!(forgotten_by_none > 50, "{forgotten_by_none}");
}

/// It answers while its model is looked for.
#[test]
fn a_left_driven_motor_that_answers_late_is_stopped_before_another_adapter_is_tried() {
    for dead_ms in (450..=3_000).step_by(50) {
        let of = |motors| Adapter::new(Model::Ddsm210, motors);
        let mut computer = Computer::new(vec![of(&[1]), of(&[2])]);
        computer.leave_driven(0, Model::Ddsm210, &[1], 100);
        computer.are_unlike = true;
        computer.cut(0, Duration::from_millis(dead_ms));
        assert!(
            computer
                .open(2, ModelChoice::default(), TakeFirst)
                .is_some()
        );
        assert!(computer.adapters[0].rpm(1) < 1.0, "dead for {dead_ms} ms");
        assert!(computer.adapters[1].acts().is_empty());
    }
}

/// No frame for one model goes to left-driven motors of another: it could mean something else to them.
#[test]
fn a_port_for_another_model_sends_no_stop_to_what_was_left_driven() {
    let mut computer = Computer::new(vec![Adapter::new(Model::Ddsm400, &[1])]);
    computer.leave_driven(0, Model::Ddsm400, &[1], 100);
    computer.cut(0, Duration::from_secs(60));
    let open = computer.open(2, of_model(Model::Ddsm115), TakeFirst);
    assert_eq!(open, Some((0, Model::Ddsm115)));
    computer.run(STANDS_WITHIN);
    assert!(!computer.stops.is_empty());
    assert!(computer.stops.iter().all(|stop| stop == &[(id(1), false)]));
    let sent = &mut computer.adapters[0].sent;
    sent.retain(|(model, _)| *model == Model::Ddsm115);
    assert!(!sent.is_empty());
    assert!(computer.adapters[0].acts().is_empty());
}

/// Its adapter is not asked, because another program has it, or because a person has picked another one: the wanted motor
/// stands there, and has the same ID.
#[test]
fn a_left_driven_motor_whose_adapter_was_not_asked_is_not_forgotten() {
    let of = |motors| Adapter::new(Model::Ddsm115, motors);
    for is_picked in [false, true] {
        let mut computer = Computer::new(vec![of(&[1]), of(&[1])]);
        computer.leave_driven(1, Model::Ddsm115, &[1], 100);
        if is_picked {
            computer.candidates = 1;
        } else {
            computer.adapters[1].is_taken = true;
        }
        let open = computer.open(1, ModelChoice::default(), TakeFirst);
        assert_eq!(open, Some((0, Model::Ddsm115)));
        computer.run(STANDS_WITHIN);
        assert_eq!(computer.stops, [[(id(1), true)]]);
        assert_eq!(computer.left.motors, [left(1)], "picked: {is_picked}");
    }
}

/// Motors of another model were left driven, but they are not there any more.
#[test]
fn a_model_that_a_person_has_chosen_stays_if_no_motor_of_another_answers() {
    let of = |motors| Adapter::new(Model::Ddsm115, motors);
    let mut computer = Computer::new(vec![of(&[1]), of(&[2])]);
    computer.left = LeftBehind {
        model: Model::Ddsm400,
        motors: vec![left(9)],
    };
    let open = computer.open(1, of_model(Model::Ddsm115), TakeFirst);
    assert_eq!(open, Some((0, Model::Ddsm115)));
}

/// A person presses STOP while a port is tried: the port is not closed before that stop has ended.
#[test]
fn a_stop_during_a_trial_is_not_cut_off() {
    for seed in 0..SEEDS {
        let mut rng = fastrand::Rng::with_seed(seed);
        let model = Model::ALL[rng.usize(..Model::ALL.len())];
        let of = |motors| Adapter::new(model, motors);
        let mut computer = Computer::new(vec![of(&[1, 2]), of(&[1])]);
        computer.leave_driven(rng.usize(..2), model, &[1], 100);
        computer.cut(0, Duration::from_millis(rng.u64(1..900)));
        computer.stop_at = Some(computer.now + Duration::from_millis(rng.u64(1..1_500)));
        let choice = ModelChoice {
            detect: rng.bool(),
            ..ModelChoice::default()
        };
        assert!(computer.open(2, choice, TakeFirst).is_some());
    }
}

/// The motors of the taken port did not answer while it was asked, so they are not those that were left driven.
#[test]
fn a_port_that_is_taken_without_an_answer_gets_no_stop() {
    let silent = || Adapter::new(Model::Ddsm115, &[]);
    let mut computer = Computer::new(vec![silent(), silent()]);
    computer.left.motors = vec![left(1)];
    let open = computer.open(1, of_model(Model::Ddsm115), TakeFirst);
    assert_eq!(open, Some((0, Model::Ddsm115)));
    computer.run(STANDS_WITHIN);
    assert!(computer.adapters.iter().all(|one| one.acts().is_empty()));
}

/// It stands where it is asked, so its adapter is not told by its speed: it gets the stop once all adapters were asked.
#[test]
fn a_left_driven_motor_that_stands_is_stopped_where_the_wanted_motor_replies() {
    let of = |motors| Adapter::new(Model::Ddsm115, motors);
    let mut computer = Computer::new(vec![of(&[2]), of(&[1])]);
    computer.left.motors = vec![left(1)];
    let open = computer.open(1, ModelChoice::default(), TakeFirst);
    assert_eq!(open, Some((1, Model::Ddsm115)));
    computer.run(STANDS_WITHIN);
    assert_eq!(computer.stops, [[(id(1), true)]]);
    assert!(computer.adapters[0].acts().is_empty());
}

#[test]
fn a_computer_that_was_asleep_has_not_watched_the_port() {
    let of = |motors| Adapter::new(Model::Ddsm115, motors);
    for slept in [100, 1_000, 60_000] {
        let mut computer = Computer::new(vec![of(&[1]), of(&[2])]);
        computer.sleeps = Some((1, Duration::from_millis(slept)));
        let open = computer.open(2, of_model(Model::Ddsm115), TakeFirst);
        assert_eq!(open, Some((1, Model::Ddsm115)), "{slept}");
    }
}

#[test]
fn of_alike_adapters_the_one_on_which_the_wanted_motor_replies_is_taken() {
    let three = || {
        let of = |motors| Adapter::new(Model::Ddsm115, motors);
        Computer::new(vec![of(&[]), of(&[3]), of(&[2])])
    };
    let any = ModelChoice::default();
    let taken = |mut of: Computer, wanted, if_no_reply| {
        let open = of.open(wanted, any, if_no_reply);
        open.map(|(place, _)| place)
    };
    assert_eq!(taken(three(), 2, TakeFirst), Some(2));
    assert_eq!(taken(three(), 2, KeepWaiting), Some(2));
    // No motor replies as the wanted one.
    assert_eq!(taken(three(), 9, TakeFirst), Some(0));
    assert_eq!(taken(three(), 9, KeepWaiting), None);
    // Another program has the port.
    let without = |others: &[usize]| {
        let mut computer = three();
        for place in others {
            computer.adapters[*place].is_taken = true;
        }
        taken(computer, 2, TakeFirst)
    };
    assert_eq!(without(&[2]), Some(0));
    assert_eq!(without(&[0, 2]), Some(1));
    assert_eq!(without(&[0, 1, 2]), None);
}

#[test]
fn the_only_adapter_is_taken_whatever_answers_but_not_for_one_that_was_lost() {
    let one = || Computer::new(vec![Adapter::new(Model::Ddsm210, &[5])]);
    let any = ModelChoice::default();
    let opened = Some((0, Model::Ddsm210));
    assert_eq!(one().open(1, any, TakeFirst), opened);
    assert_eq!(one().open(1, any, KeepWaiting), None);
    assert_eq!(one().open(5, any, KeepWaiting), opened);
}
