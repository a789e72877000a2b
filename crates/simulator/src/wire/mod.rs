//! The shared pair of wires, and the faults of adapters and cables.
//!
//! ```text
//! host --> wire --> motor receiver --> frames      (requests may be lost or flipped)
//! host <-- adapter <-- host receiver <-- wire <-- motors
//!          (losses, flips, strays, splits, holds; echoes come with the receiver)
//! ```

mod adapter;
mod faults;
mod floating_pair;
mod host_receiver;
mod motor_receiver;
mod shared_wire;
mod timing;

pub use adapter::Chunk;
pub use faults::{Beside, Echo, Split, WireFaults};

pub(crate) use adapter::Adapter;
pub(crate) use floating_pair::FloatingPair;
pub(crate) use host_receiver::HostReceiver;
pub(crate) use motor_receiver::MotorReceiver;
pub(crate) use shared_wire::{PassedByte, SharedWire, Source};
