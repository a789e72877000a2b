//! The shortest story that still breaks the rule.

use crate::{
    player::{Coverage, Failure, play},
    story::Story,
};

/// Leaves acts out, first many at once, then one by one, as long as the same rule is still broken.
#[must_use]
pub fn shrink(story: &Story, failure: &Failure) -> (Story, Failure) {
    let mut best = story.clone();
    best.acts.truncate(failure.step + 1);
    let mut found = failure.clone();
    let mut length = best.acts.len() / 2;
    while length > 0 {
        let mut at = 0;
        while at < best.acts.len() {
            let mut shorter = best.clone();
            let end = (at + length).min(shorter.acts.len());
            shorter.acts.drain(at..end);
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
