//! A world that fails, from one seed: the bus, virtual motors, a bad wire, and a person who clicks at
//! random; after every step rules that must hold whatever happens.
//!
//! | file | idea |
//! |---|---|
//! | `act` | what can happen in this world |
//! | `story` | from a seed to a list of acts |
//! | `player` | plays a story over virtual time, and gives every step to the rules |
//! | `rules` | what must hold, each rule with its name |
//! | `shrink` | the shortest story that still breaks the rule |
//!
//! It is for tests and for `cargo xtask soak`: the same seed is the same world on every machine.

mod act;
mod player;
mod rules;
mod shrink;
mod story;

pub use act::{Absence, Act, Fault, LineFault, Turn};
pub use player::{Coverage, Failure, play, what_passed};
pub use rules::{Rule, Violation};
pub use shrink::shrink;
pub use story::Story;
