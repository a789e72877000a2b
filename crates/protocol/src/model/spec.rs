//! What there is to know of a model. Its values for each model are in `mod.rs`.

use crate::{fault::Fault, mode::Mode};

use super::current_scale::CurrentScale;

/// How the motor is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wiring {
    /// A pair of wires, half duplex, many motors.
    Rs485,
    /// Two TTL lines, full duplex.
    TtlUart,
    /// One wire for both directions, at the level of LIN, with plain UART frames.
    SingleWire,
}

/// Which frames a model speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameSet {
    /// One reply has mode, current and speed, and bytes 6-7 by what was asked
    /// ([`Reply`](crate::Reply)). A mode switch has its mode in byte 9, no CRC and no reply.
    Combined,
    /// Speed, angle and mode come in replies of their own, which byte 1 tells apart
    /// ([`Reading`](crate::family::Reading)). Every frame has a CRC, and a mode switch has its mode in byte 2 and
    /// a reply.
    Separate {
        /// Byte 1 of a reply is this much above byte 1 of its request. At 0 a reply may be identical
        /// to its request, and an echo to a reply.
        reply_offset: u8,
    },
}

/// Everything that differs between models.
#[derive(Clone, Copy, Debug)]
pub struct Spec {
    /// Waveshare's name.
    pub name: &'static str,
    /// The maker's name.
    pub maker_name: &'static str,
    /// The name in commands and addresses.
    pub key: &'static str,
    /// How it is connected.
    pub wiring: Wiring,
    /// Baud, 8N1.
    pub baud: u32,
    /// Its frames.
    pub frames: FrameSet,
    /// Its loops, in the order of their bytes.
    pub modes: &'static [Mode],
    /// Whether it ignores drive frames after power-up until it is enabled
    /// ([`Request::Enable`](crate::family::Request::Enable)) and switched to a loop. If not, it powers up in the
    /// velocity loop.
    pub needs_enable: bool,
    /// Units of speed per rpm on the wire: 1 or 10.
    pub speed_units_per_rpm: u8,
    /// Greatest commanded speed in rpm.
    pub speed_rpm_max: u16,
    /// Raw current at full scale, in setpoints and replies.
    pub current: CurrentScale,
    /// Microseconds per rpm that one unit of acceleration takes; the longest that a source gives.
    pub acceleration_us_per_rpm: u16,
    /// Faults in the order of their bits.
    pub faults: &'static [Fault],
    /// Set-ID frames in a row before an ID is taken, once per power-up.
    pub set_id_frames: u8,
    /// Whether a set-ID frame ends with its CRC. If not, with 00.
    pub set_id_has_crc: bool,
    /// Nominal figures.
    pub nominal: Nominal,
}

/// Nominal figures by the data sheets; `None` if none is published.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nominal {
    /// Speed without load in rpm.
    pub no_load_rpm: u16,
    /// Rated speed in rpm.
    pub rated_rpm: Option<u16>,
    /// Current without load in mA.
    pub no_load_ma: Option<u16>,
    /// Rated torque in mN.m.
    pub rated_mnm: Option<u16>,
    /// The supply voltage of these figures; `None` if it is not given.
    pub supply_v: Option<u8>,
    /// Least and greatest supply voltage.
    pub supply_range_v: Option<(u8, u8)>,
    /// Winding temperature that trips the protection, in degrees Celsius.
    pub trips_at_c: Option<u8>,
}
