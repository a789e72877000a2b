//! A thousand worlds of DDSM115 that fail, a hundred of each other model, and rules that hold in each.
#![cfg(test)]

use std::fmt::Write;
use std::panic::resume_unwind;
use std::thread;

use motorlink_fault_simulation::{Coverage, Fault, LineFault, Rule, Scenario, play, shrink};
use motorlink_protocol::family::Model;
use strum::VariantArray;

/// `cargo xtask reliability seeds` plays a hundred times as many.
const SEEDS: u64 = 1_000;
/// For each of the other models.
const SEEDS_OF_OTHERS: u64 = 100;
/// For each model, on hostile lines.
const SEEDS_ON_HOSTILE_LINES: u64 = 30;
/// So many kinds of fault there are.
const KINDS: usize = 36;
/// Each fault happens, and each rule has something to judge, at least so often.
const EACH: u64 = 25;

/// Worlds know nothing of each other: one thread has the odd seeds, the other the even.
const FIRST: [u64; 2] = [1, 2];

#[test]
fn the_rules_hold_in_every_world() {
    let Coverage { faults, judged, .. } = play_all(Model::Ddsm115, SEEDS, Scenario::of);
    assert_eq!(faults.len(), KINDS, "{faults:?}");
    for (fault, times) in &faults {
        println!("{fault:?}: {times}");
        assert!(*times >= EACH, "{fault:?} only {times} times");
    }
    // A rule that has nothing to judge holds whatever happens.
    for rule in Rule::VARIANTS {
        let times = judged.get(rule).copied().unwrap_or(0);
        println!("{rule:?}: {times}");
        assert!(times >= EACH, "{rule:?} judged only {times} times");
    }
}

#[test]
fn the_rules_hold_for_each_other_model() {
    let others = Model::ALL.into_iter();
    for model in others.filter(|model| *model != Model::Ddsm115) {
        let judged = play_all(model, SEEDS_OF_OTHERS, Scenario::of).judged;
        for rule in Rule::VARIANTS {
            let times = judged.get(rule).copied().unwrap_or(0);
            println!("{model}, {rule:?}: {times}");
            assert!(times > 0, "{model}, {rule:?} judged nothing");
        }
    }
}

/// The scenario of a seed for motors of this model.
type Generate = fn(Model, u64) -> Scenario;

/// Random parts of echoes, a byte beside each reply, blocks of 32 bytes and floating pairs.
#[test]
fn the_rules_hold_on_hostile_lines() {
    const KINDS_OF_LINE: usize = 5;
    for model in Model::ALL {
        let faults = play_all(model, SEEDS_ON_HOSTILE_LINES, Scenario::on_hostile_lines).faults;
        let is_hostile = |fault: &&Fault| {
            matches!(
                fault,
                Fault::Line(
                    LineFault::EchoesParts
                        | LineFault::ByteBefore(_)
                        | LineFault::ByteAfter(_)
                        | LineFault::Blocks
                        | LineFault::Floats
                )
            )
        };
        let kinds = faults.keys().filter(is_hostile).count();
        assert_eq!(kinds, KINDS_OF_LINE, "{model}: {faults:?}");
    }
}

fn play_all(model: Model, seeds: u64, scenario: Generate) -> Coverage {
    let mut coverage = Coverage::default();
    thread::scope(|scope| {
        let start =
            |first| scope.spawn(move || play_every(FIRST.len(), first, model, seeds, scenario));
        // All are started before the first is waited for.
        let threads = FIRST.map(start);
        for thread in threads {
            coverage += thread.join().unwrap_or_else(|panic| resume_unwind(panic));
        }
    });
    coverage
}

/// Plays the first world, and every `step`th behind it.
fn play_every(step: usize, first: u64, model: Model, seeds: u64, generate: Generate) -> Coverage {
    let mut coverage = Coverage::default();
    for seed in (first..=seeds).step_by(step) {
        let scenario = generate(model, seed);
        if let Err(failure) = play(&scenario, &mut coverage) {
            let (short, last) = shrink(&scenario, &failure);
            let mut actions = String::new();
            for action in &short.actions {
                let _ = writeln!(actions, "  {action:?}");
            }
            panic!(
                "{model}, seed {seed}, step {}: {}\nshrunk, with {:?}: {}\n{actions}",
                failure.step, failure.violation, short.motors, last.violation
            );
        }
    }
    coverage
}
