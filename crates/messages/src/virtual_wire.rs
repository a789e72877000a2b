//! What is wrong with the virtual motor's line.

use serde::{Deserialize, Serialize};
use strum::VariantArray;

/// What a person would like to see the virtual line do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, VariantArray)]
pub enum VirtualWire {
    /// Nothing is wrong.
    #[default]
    Good,
    /// Nothing comes.
    Dead,
    /// The adapter hears itself and nobody else.
    EchoOnly,
    /// Two motors have the ID 1. What is driven is stopped first, for the second would obey too.
    SharedId,
    /// The faster the wheel turns, the more replies have a wrong bit.
    NoiseGrowsWithSpeed,
    /// The adapter holds what it has received for 16 ms.
    HoldsBytes,
    /// A motor is heard that nobody asks.
    Stranger,
}

impl VirtualWire {
    /// All of them, in the order in which a menu shows them.
    pub const ALL: &[Self] = Self::VARIANTS;
}
