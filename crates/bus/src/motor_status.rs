//! A motor as the page shows it.

use motorlink_protocol::{Celsius, Current, Instant, Mode, MotorId, Position, Rpm, Setpoint};

use crate::{
    counters::{Counters, LinkQuality},
    sample::Sample,
    turns::Turns,
};

/// What the bus does with a motor, as the page shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Activity {
    /// Not driven; the wheel is free.
    Idle,
    /// The motor switches its loop.
    Switching {
        /// The new loop.
        to: Mode,
    },
    /// The motor is driven.
    Driven {
        /// The setpoint.
        setpoint: Setpoint,
    },
    /// A raw frame drives the motor.
    DrivenRaw,
    /// The motor is being braked to a standstill.
    Stopping {
        /// Whether replies have reported standstill.
        confirmed: bool,
    },
}

/// Whether a motor answers; of a silent one, what comes instead.
///
/// Encoded by its number, so 0 and 1 read as the `false` and `true` of earlier versions, which asked whether it is silent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Answer {
    /// It has answered within two seconds, or was not asked.
    #[default]
    Comes,
    /// No valid reply for two seconds, and the last reply windows were empty.
    Missing,
    /// No valid reply for two seconds, and invalid bytes in the last reply windows.
    Corrupted,
}

/// Status of one motor, for the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotorStatus {
    /// Which motor.
    pub id: MotorId,
    /// What the bus does with it.
    pub activity: Activity,
    /// The setpoint that waits until the motor stands and reports its loop.
    pub waiting: Option<Setpoint>,
    /// Its last reply.
    pub last: Option<Sample>,
    /// Its last speed. A newer reply may have none.
    pub speed: Option<(Instant, Rpm)>,
    /// Its last current. A newer reply may have none.
    pub current: Option<(Instant, Current)>,
    /// Its last fine position, from a drive reply.
    pub position: Option<(Instant, Position)>,
    /// Its last temperature, from a feedback query.
    pub temperature: Option<(Instant, Celsius)>,
    /// Its turns since its first reply, or since power-up if it counts them itself.
    pub turns: Option<Turns>,
    /// Whether it answers.
    pub answer: Answer,
    /// Whether it was driven, and no reply has confirmed standstill since.
    pub may_turn: bool,
    /// Whether it turns at 10 rpm or more, or draws the current of a driven motor, although nothing here drives it.
    /// Not while it is stopped, nor after a raw frame until it is stopped.
    pub turns_unasked: bool,
    /// Quality of the link to it.
    pub link: LinkQuality,
    /// Counters of the exchanges with it.
    pub counters: Counters,
}

impl MotorStatus {
    /// An idle motor of which nothing is known.
    #[must_use]
    pub fn unknown(id: MotorId) -> Self {
        Self {
            id,
            activity: Activity::Idle,
            waiting: None,
            last: None,
            speed: None,
            current: None,
            position: None,
            temperature: None,
            turns: None,
            answer: Answer::Comes,
            may_turn: false,
            turns_unasked: false,
            link: LinkQuality::default(),
            counters: Counters::default(),
        }
    }

    /// Whether no valid reply has come for two seconds.
    #[must_use]
    pub const fn is_silent(&self) -> bool {
        self.answer.is_silent()
    }
}

impl Answer {
    /// Whether no valid reply has come for two seconds.
    #[must_use]
    pub const fn is_silent(self) -> bool {
        !matches!(self, Self::Comes)
    }
}
