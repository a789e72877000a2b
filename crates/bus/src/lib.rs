#![doc = include_str!("../README.md")]
//!
//! # Where to begin
//!
//! | to | see |
//! |---|---|
//! | run the line | [`Bus::poll`], [`Bus::receive`], [`Output`] |
//! | ask for something | [`Bus::command`], [`Command`]; why not: [`Refusal`] |
//! | see what happened | [`Event`], [`Sample`], [`StopReport`], [`WithdrawReason`] |
//! | show every motor | [`Bus::motors`], [`MotorStatus`], [`Activity`], [`LinkQuality`] |
//! | bound what is asked | [`BusSettings`]: [`CommandRate`], [`Ramp`], [`Limits`]; [`Consent`] |
//! | drive several as one | [`GroupSetpoints`] |
//! | find motors, set an ID | [`Command::FullScan`], [`ScanReport`], [`Command::SetId`], [`IdChangeOutcome`] |
//! | know what a line carries | [`Bus::line_status`], [`LineStatus`] |
//! | bound what waits in a port | [`InFlight`] |
//! | learn the model of the motors on a port | [`Bus::detected_model`], [`DetectedModel`] |
//! | know a recorded line | [`LineSamples`], [`TurnCounter`], [`CommandedValue`] |
//!
//! Safety decisions are pure functions of the known state, tested as tables: [`stop_plan`],
//! [`check_position_switch`], [`needs_consent`] and others.

mod angle_estimate;
mod angle_filter;
mod angle_fit;
mod broadcast;
mod bus;
mod bus_status;
mod carried_rate;
mod command;
mod command_kind;
mod commanded;
mod counters;
mod detected_model;
mod dispatch;
mod driving;
mod event;
mod exchange;
mod group;
mod id_change;
mod in_flight;
mod job;
mod junk_logged;
mod last_second;
mod late_replies;
mod late_window;
mod left_driven;
mod limits;
mod line_event;
mod line_load;
mod line_samples;
mod line_use;
mod mirror;
mod mode_switch;
mod model;
mod motor;
mod motor_status;
mod next_request;
mod opening;
mod other_bytes;
mod packet_log;
mod pending_transmit;
mod probe;
mod ramp;
mod rate;
mod raw;
mod receiver;
mod refusal;
mod replies;
mod reply_effect;
mod reply_window;
mod round_trip;
mod safety;
mod sample;
mod scan;
mod schedule;
mod sending;
mod settings;
mod silence;
mod standstill;
mod start;
mod starting;
mod stop;
mod stopping;
mod supervision;
mod temperature_filter;
mod timing;
mod torque;
mod turning_unasked;
mod turns;
mod watchdog;
mod window_end;
mod withheld;

pub use bus::{Bus, Output};
pub use carried_rate::CarriedRate;
pub use command::{COMMAND_AGE_MAX, Command, Consent};
pub use command_kind::CommandKind;
pub use commanded::{CommandedValue, commanded, commanded_setpoint};
pub use counters::{Counters, LinkQuality};
pub use detected_model::DetectedModel;
pub use driving::is_rest;
pub use event::{Event, IdQueryOutcome, StopOutcome, StopReason, StopReport, WithdrawReason};
pub use group::setpoints::{GroupError, GroupSetpoints};
pub use id_change::outcome::{IdChangeOutcome, SetIdFrames};
pub use in_flight::InFlight;
pub use job::status::JobStatus;
pub use left_driven::LeftDriven;
pub use limits::{ExceededLimit, LimitOutOfRange, Limits, OVERCURRENT_FOR};
pub use line_event::{JunkBytes, LineEvent, LineEventKind};
pub use line_samples::{LineSamples, reported_current};
pub use line_use::LineStatus;
pub use mirror::Mirror;
pub use motor_status::{Activity, Answer, MotorStatus};
pub use ramp::{Ramp, RampOutOfRange};
pub use rate::{CommandRate, RateOutOfRange};
pub use raw::hazard::{is_hazardous, unassignable_id};
pub use raw::status::{IntervalOutOfRange, RawAnswer, RawInterval, RawStatus, Repeat};
pub use refusal::Refusal;
pub use round_trip::{ROUND_TRIP_BINS_US, RoundTripStatus};
pub use safety::{HIGH_CURRENT_RAW, StopPlan, check_position_switch, needs_consent, stop_plan};
pub use sample::Sample;
pub use scan::report::{ScanFault, ScanReport};
pub use settings::BusSettings;
pub use silence::{WITHHELD_MAX, Withheld};
pub use timing::{
    FIRST_BRAKE_MAX, FIRST_BRAKE_MOTORS_MAX, FRESH_FOR, PAGE_SILENCE_MAX, POSITION_SWITCH_RPM,
    SILENT_AFTER, SLEEP_MIN, STOP_WINDOW,
};
pub use turns::{TurnCounter, Turns};
