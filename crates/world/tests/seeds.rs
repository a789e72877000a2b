//! Two thousand worlds that fail, and rules that hold in each.
#![allow(clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write;

use motorlink_world::{Coverage, Rule, Story, play, shrink};

const SEEDS: u64 = 2_000;
/// So many kinds of fault there are.
const KINDS: usize = 19;
/// Each fault happens, and each rule has something to judge, at least so often.
const EACH: u64 = 100;

#[test]
fn the_rules_hold_in_every_world() {
    let mut coverage = Coverage::default();
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
    let Coverage { faults, judged } = coverage;
    assert_eq!(faults.len(), KINDS, "{faults:?}");
    for (fault, times) in &faults {
        println!("{fault:?}: {times}");
        assert!(*times >= EACH, "{fault:?} only {times} times");
    }
    // A rule that has nothing to judge holds whatever happens.
    for rule in Rule::ALL {
        let times = judged.get(&rule).copied().unwrap_or(0);
        println!("{rule:?}: {times}");
        assert!(times >= EACH, "{rule:?} judged only {times} times");
    }
}
