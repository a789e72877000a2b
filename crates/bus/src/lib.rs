//! The one owner of the wire: decides every frame that goes to the hub motors, without any I/O.
//!
//! [`Bus`] is a state machine. Bytes, commands and the time go in; frames to send, events and the
//! next moment at which it wants to be woken come out. It reads no clock and owns no port, so a
//! test can play hours of a faulty line in a second, and the same code runs in the web worker and
//! natively.
//!
//! ```
//! use motorlink_bus::{Bus, Command, Output};
//! use motorlink_protocol::{Instant, MotorId};
//!
//! let mut now = Instant::ZERO;
//! let mut bus = Bus::new(now);
//! bus.command(now, Command::Watch(MotorId::FIRST)).expect("watching is never refused");
//! loop {
//!     match bus.poll(now) {
//!         Output::Transmit(frame) => println!("send {frame}"),
//!         Output::Event(event) => println!("{event:?}"),
//!         // Wait for bytes until then, `receive` them, and poll again.
//!         Output::Wait(until) => break assert!(until > now),
//!     }
//! }
//! ```
//!
//! # How a line is shared
//!
//! The line is half duplex: one exchange at a time, a request and its reply, or the window in which
//! the reply could have come. Who is next is decided in `schedule`: stops, then mode switches, then
//! drive frames by deadline, then queries where they do not make a drive frame late.
//!
//! # Safety
//!
//! What must be done is decided by pure functions in `safety` from what is known; they are tested as
//! tables. A setpoint stands only while its motor answers, reports the loop that the setpoint is
//! meant for, and reports no fault. Whatever ends that withdraws the setpoint and stops the motor;
//! only a new command of an operator starts it again.

mod angles;
mod bus;
mod command;
mod counters;
mod event;
mod exchange;
mod id_change;
mod last_second;
mod late_replies;
mod limits;
mod line_use;
mod mode_switch;
mod motor;
mod ramp;
mod rate;
mod raw;
mod receiver;
mod round_trip;
mod safety;
mod scan;
mod schedule;
mod stop;
mod survey;
mod temperatures;
mod timing;
mod together;
mod traffic;
mod watchdog;

pub use bus::{Bus, Output};
pub use command::{ACT_AGE_MAX, Command, Consent, Refusal, is_hazardous};
pub use counters::{Counters, LinkQuality};
pub use event::{
    Event, IdQueryOutcome, Sample, StopOutcome, StopReason, StopReport, WithdrawReason,
};
pub use limits::{Crossed, LimitOutOfRange, Limits, OVERCURRENT_FOR};
pub use line_use::LineStatus;
pub use motor::{Activity, MotorStatus};
pub use ramp::{Ramp, RampOutOfRange};
pub use rate::{CommandRate, RateOutOfRange};
pub use round_trip::{ROUND_TRIP_CLASSES_US, RoundTripStatus};
pub use safety::{HIGH_CURRENT_RAW, StopPlan, check_position_switch, needs_consent, stop_plan};
pub use survey::{
    IdChangeOutcome, IntervalOutOfRange, RawAnswer, RawInterval, RawStatus, Repeat, ScanReport,
    SurveyStatus,
};
pub use timing::{FRESH_FOR, PAGE_SILENCE_MAX, POSITION_SWITCH_RPM, SILENT_AFTER, STOP_WINDOW};
pub use together::{NotTogether, Together};
pub use traffic::{JunkBytes, Passed, Traffic};
