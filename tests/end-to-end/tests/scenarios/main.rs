//! What a person does, done in a real browser over real Web Serial.
//!
//! One program for all of it: each further one would be linked with all of the bench again.
//! `cargo xtask test` runs the scenarios of `side_by_side` several at once, and then those of
//! `alone` one after the other.

mod alone;
mod fixture;
mod side_by_side;
