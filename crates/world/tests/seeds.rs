//! Two thousand worlds that fail, and rules that hold in each.
#![allow(clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write;

use motorlink_world::{Coverage, Story, play, shrink};

const SEEDS: u64 = 2_000;
/// So many kinds of fault there are.
const KINDS: usize = 19;
/// Each fault happens at least so often.
const EACH_FAULT: u64 = 100;

#[test]
fn the_rules_hold_in_every_world() {
    let mut coverage = Coverage::new();
    for seed in 1..=SEEDS {
        let story = Story::of(seed);
        if let Err(failure) = play(&story, &mut coverage) {
            let (short, last) = shrink(&story, &failure);
            let mut acts = String::new();
            for act in &short.acts {
                let _ = writeln!(acts, "  {act:?}");
            }
            panic!(
                "seed {seed}, step {}: {}\nshrunk, with {:?}: {}\n{acts}",
                failure.step, failure.violation, short.motors, last.violation
            );
        }
    }
    assert_eq!(coverage.len(), KINDS, "{coverage:?}");
    for (fault, times) in &coverage {
        println!("{fault:?}: {times}");
        assert!(*times >= EACH_FAULT, "{fault:?} only {times} times");
    }
}
