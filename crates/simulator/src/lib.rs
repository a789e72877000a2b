//! Virtual hub motors on a virtual half-duplex wire.
//!
//! A [`World`] holds motors of any model of the family, the wires that they share with a host, and the faults that real adapters and cables add. It has no clock, no thread and no port: time is
//! an argument, and one seed gives one course of events to the byte, however often it is looked at.
//! The same crate runs in the page as the virtual bus and natively behind a pty.
//!
//! | folder | what it is |
//! |---|---|
//! | `firmware/` | what the motor's controller does with a frame: loops, rules, protections |
//! | `physics/` | the wheel, the windings, their heat, the encoder |
//! | `wire/` | bytes on the wire with their times and collisions, and injected faults |
//!
//! It is made to hold the published figures of the motor (see `tests/`), not to predict a design. Of the DDSM315,
//! DDSM210 and DDSM400 few are published. What is assumed is marked in `figures.rs` and
//! `firmware/separate.rs`, and what their protocol leaves open in
//! [`Model::uncertain`](motorlink_protocol::family::Model::uncertain).
//!
//! # Example
//!
//! ```
//! use motorlink_protocol::{Instant, Layout, MotorId, Reply, Request, Setpoint, SpeedTarget};
//! use motorlink_simulator::{World, WorldConfig};
//!
//! let mut world = World::new(WorldConfig::default());
//! let drive = Request::drive(MotorId::FIRST, Setpoint::velocity(SpeedTarget::new(100)?));
//! world.transmit(Instant::ZERO, drive.frame().bytes());
//!
//! // 868 us for the request, 600 us turnaround, 868 us for the reply.
//! let chunk = world.receive(Instant::from_micros(2336)).ok_or("silence")?;
//! let frame = motorlink_protocol::Frame::new(chunk.bytes.as_slice().try_into()?);
//! assert_eq!(Reply::decode(&frame, Some(Layout::Drive))?.id, MotorId::FIRST);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod config;
mod convert;
mod figures;
mod firmware;
mod line_condition;
mod motor;
mod physics;
mod random;
mod wire;
mod wire_frame;
mod world;

pub use config::{MotorConfig, WhenSilent, WorldConfig};
pub use line_condition::LineCondition;
pub use motor::VirtualMotor;
pub use wire::{Beside, Chunk, Echo, Split, WireFaults};
pub use wire_frame::{Sender, WireFrame};
pub use world::World;
