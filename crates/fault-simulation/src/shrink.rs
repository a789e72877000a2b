//! Shrinks a scenario to the shortest that still breaks the rule.

use crate::{
    player::{Coverage, Failure, play},
    scenario::Scenario,
};

/// Leaves actions out, first many at once, then one by one, as long as the same rule is broken.
#[must_use]
pub fn shrink(scenario: &Scenario, failure: &Failure) -> (Scenario, Failure) {
    let mut best = scenario.clone();
    best.actions.truncate(failure.step + 1);
    let mut found = failure.clone();
    let mut length = best.actions.len() / 2;
    while length > 0 {
        let mut at = 0;
        while at < best.actions.len() {
            let mut shorter = best.clone();
            let end = (at + length).min(shorter.actions.len());
            shorter.actions.drain(at..end);
            match play(&shorter, &mut Coverage::default()) {
                Err(other) if other.violation.rule == found.violation.rule => {
                    best = shorter;
                    found = other;
                }
                _ => at += length,
            }
        }
        length /= 2;
    }
    (best, found)
}
