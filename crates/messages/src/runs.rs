//! The messages between the page and the run of an experiment.
//!
//! The port worker loads the program of the runs when the first run is armed. It passes these messages on as bytes, so
//! that neither it nor the first program of the page contains them.

use std::time::Duration;

use motorlink_experiments::{
    plan::Fleet,
    runner::{Options, Phase, RecordPart, StartRefusal},
};
use motorlink_protocol::Instant;
use serde::{Deserialize, Serialize};

use crate::encode;

/// From the page to the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToRun {
    /// Check a sequence against these motors and arm it. Nothing moves. It replaces a run that is armed or has ended,
    /// and is refused while one is running or paused.
    Arm {
        /// The number of the run: every answer has it.
        run: u32,
        /// The sequence, as JSON.
        sequence: String,
        /// The motors and groups.
        fleet: Fleet,
        /// The settings.
        options: Options,
    },
    /// Start the armed run. Only a person's act sends it.
    Start {
        /// Which run the person has read.
        run: u32,
    },
    /// Pause the run: speeds and currents become zero, angles are held.
    Pause,
    /// Resume the paused run. Only a person's act sends it.
    Resume,
    /// Disarm an armed run; abort a running one and stop its motors.
    Abort,
    /// The page has lost the focus or is hidden.
    FocusLost,
}

/// From the run to the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromRun {
    /// The state: whenever the phase or the step changes, and ten times a second while it runs.
    State(RunState),
    /// No run was armed.
    NotArmed {
        /// The number of the request.
        run: u32,
        /// Why.
        reason: NotArmed,
    },
    /// The armed run was not started. It stays armed.
    NotStarted(StartRefusal),
    /// New entries of the record, ten times a second while it runs: after the first state with a start, and the rest of
    /// them before the state that says that it has ended.
    Part {
        /// Which run.
        run: u32,
        /// The entries.
        part: RecordPart,
    },
    /// The program of the runs has failed. The port worker has stopped its motors.
    Died,
}

/// The state of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunState {
    /// Which run.
    pub run: u32,
    /// The time of this state.
    pub now: Instant,
    /// Its phase.
    pub phase: Phase,
    /// When it was started.
    pub began: Option<Instant>,
    /// The time of the plan, without pauses.
    pub passed: Duration,
    /// The instruction of the plan that is running: see
    /// [`Plan::place`](motorlink_experiments::plan::Plan::place).
    pub step: usize,
}

/// [`FromRun::Died`], encoded. The port worker sends it without the program of the runs.
pub const DIED: [u8; 1] = [4];

/// A [`ToPage::Run`](crate::ToPage::Run) with this message, encoded. The program of the runs posts it, which has none of
/// the other messages to the page.
///
/// # Errors
/// A message of ours always encodes; the error is that of the encoder.
pub fn to_page(message: &FromRun) -> Result<Vec<u8>, postcard::Error> {
    encode(&(TO_PAGE_RUN, encode(message)?))
}

/// The number of [`ToPage::Run`](crate::ToPage::Run) among the messages to the page.
const TO_PAGE_RUN: u32 = 4;

/// Why no run was armed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotArmed {
    /// No port is open.
    NotConnected,
    /// "Stop all motors" is in effect.
    Halted,
    /// A run is running or paused.
    Running,
    /// A scan, an ID change or a raw frame is running, or a motor is driven or being stopped.
    Busy,
    /// The sequence does not fit: the place and the problem, in English. The page checks it first and names it in the
    /// language of the reader.
    Sequence(String),
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::MotorId;

    use super::*;
    use crate::{ToPage, decode};

    #[test]
    fn messages_that_are_encoded_in_parts_are_those_of_the_enums() {
        assert_eq!(encode(&FromRun::Died).unwrap(), DIED);
        let refused = FromRun::NotStarted(StartRefusal::ArmedTooLongAgo);
        let whole = ToPage::Run(encode(&refused).unwrap());
        assert_eq!(to_page(&refused).unwrap(), encode(&whole).unwrap());
    }

    #[test]
    fn messages_arrive_as_they_were_sent() {
        let arm = ToRun::Arm {
            run: 3,
            sequence: r#"{ "motorlink_sequence": 1, "steps": [] }"#.to_owned(),
            fleet: Fleet::of([MotorId::FIRST]),
            options: Options::default(),
        };
        assert_eq!(decode::<ToRun>(&encode(&arm).unwrap()).unwrap(), arm);
        let state = FromRun::State(RunState {
            run: 3,
            now: Instant::from_micros(5),
            phase: Phase::Armed {
                until: Instant::from_micros(7),
            },
            began: None,
            passed: Duration::ZERO,
            step: 0,
        });
        assert_eq!(decode::<FromRun>(&encode(&state).unwrap()).unwrap(), state);
    }
}
