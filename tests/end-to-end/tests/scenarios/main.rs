//! Scenarios: a user's actions in a real browser over real Web Serial.
//!
//! One program for all: each further program would link the whole bench again.
//! `cargo xtask test` runs the scenarios of `side_by_side` several at once, and then those of
//! `alone` one after the other.
#![cfg(test)]

mod alone;
mod fixture;
mod side_by_side;
