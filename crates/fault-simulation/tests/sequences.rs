//! Random sequences in worlds that fail: the rules hold, and each kind of end happens.
#![cfg(test)]

use std::{panic::resume_unwind, thread};

use motorlink_fault_simulation::{Coverage, Runs, Scenario, play, shrink};

/// `SEQUENCE_SEEDS` asks for another number: `cargo xtask experiments` plays 10,000. `SEQUENCE_FROM` is the first one.
const SEEDS: u64 = 100;
/// Each kind of end happens at least so often.
const EACH: u64 = 10;

#[test]
fn the_rules_hold_while_sequences_run() {
    let number = |name: &str| {
        std::env::var(name)
            .ok()
            .map(|it| it.parse::<u64>().unwrap())
    };
    let seeds = number("SEQUENCE_SEEDS").unwrap_or(SEEDS);
    let from = number("SEQUENCE_FROM").unwrap_or(1);
    let mut coverage = Coverage::default();
    thread::scope(|scope| {
        // Worlds know nothing of each other: one thread has the odd seeds, the other the even.
        let last = from + seeds - 1;
        let threads = [from, from + 1].map(|first| scope.spawn(move || play_every(2, first, last)));
        for thread in threads {
            coverage += thread.join().unwrap_or_else(|panic| resume_unwind(panic));
        }
    });
    let runs = coverage.runs;
    let Runs {
        started,
        finished,
        by_person,
        by_motor,
        by_machine,
        by_plan,
        by_trap,
    } = runs;
    println!(
        "| random sequences in worlds that fail, {seeds} seeds, {started} runs | no broken rule; {finished} finished, {by_person} ended by a person, {by_motor} by a motor, {by_machine} by page, port or machine, {by_plan} by the plan, {by_trap} by a trap of their program |"
    );
    let ended = finished + by_person + by_motor + by_machine + by_plan + by_trap;
    assert!(ended <= started, "{runs:?}");
    if seeds < SEEDS {
        // Too few for each kind.
        return;
    }
    for times in [finished, by_person, by_motor, by_machine, by_plan, by_trap] {
        assert!(times >= EACH, "{runs:?}");
    }
}

/// Plays the world `first`, and every `step`th behind it.
fn play_every(step: usize, first: u64, last: u64) -> Coverage {
    let mut coverage = Coverage::default();
    for seed in (first..=last).step_by(step) {
        let scenario = Scenario::with_sequences(seed);
        if let Err(failure) = play(&scenario, &mut coverage) {
            let (short, last) = shrink(&scenario, &failure);
            panic!(
                "seed {seed}, step {}: {}\nshrunk, with {:?}: {}\n{:#?}",
                failure.step, failure.violation, short.motors, last.violation, short.actions
            );
        }
    }
    coverage
}
