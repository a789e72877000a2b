//! Bytes on two wires that everybody shares, and what adapters and cables do to them.
//!
//! ```text
//! host --> air --> ear of the motors --> frames      (requests may be lost or flipped)
//! host <-- adapter <-- ear of the host <-- air <-- motors
//!          (losses, flips, strays, splits, holds; echoes come with the ear)
//! ```

mod adapter;
mod air;
mod faults;
mod host_ear;
mod motor_ear;

pub use adapter::Chunk;
pub use faults::{Echo, Split, WireFaults};

pub(crate) use adapter::Adapter;
pub(crate) use air::{Air, Passed, Talker};
pub(crate) use host_ear::HostEar;
pub(crate) use motor_ear::MotorEar;

use std::time::Duration;

/// Silence after which a motor takes the next byte for the first of a frame. A frame takes 0.87 ms,
/// and hosts leave more than this between frames that are not answered.
const FRAME_GAP: Duration = Duration::from_millis(1);

/// Time of `count` bytes on the wire: ten bits each at 115200 baud, 868 us for ten.
fn airtime(count: usize) -> Duration {
    let tenths = u64::try_from(count).unwrap_or(u64::MAX).saturating_mul(868);
    Duration::from_micros(tenths / 10)
}
