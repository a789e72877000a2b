//! The part of the command line that is about `control`.

use clap::{Args, ValueEnum};

use crate::parsers::amps;

/// How `control` drives.
#[derive(Debug, Args)]
pub struct Control {
    /// The loop to begin with; the keys V, C and P choose another one
    #[arg(long, value_enum, default_value_t = Loop::Velocity, value_name = "LOOP")]
    pub mode: Loop,
    /// Speed of the keys F and B in rpm
    #[arg(long, default_value_t = 100, allow_hyphen_values = true, value_parser = clap::value_parser!(i32).range(-380..=380))]
    pub rpm: i32,
    /// Current of the keys F and B in A
    #[arg(long, default_value_t = 0.5, allow_hyphen_values = true, value_parser = amps)]
    pub amps: f32,
    /// Allow more than 6.1 A
    #[arg(long)]
    pub high_current: bool,
    /// How gently the motor itself speeds up, 0-255; more is gentler
    #[arg(long, default_value_t = 3)]
    pub accel: u8,
    /// A key drives until another one, not only while it is held
    #[arg(long)]
    pub latch: bool,
}

/// A loop that the keys drive in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Loop {
    /// Hold a speed
    Velocity,
    /// Hold a torque current
    Current,
    /// Go to an angle and hold it
    Position,
}
