//! A robot publishes its state, in the Zenoh session of its node.

use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use motorlink_controller_messages::State;
use zenoh::{Session, Wait as _, liveliness::LivelinessToken, qos::CongestionControl};

use super::{
    names::RobotName,
    state::{RobotState, Sources},
};
use crate::{drive::Drive, rover::Rover, status::DriveStatus};

/// How often a state is published.
pub const PERIOD: Duration = Duration::from_millis(100);

/// Makes the states of a robot.
#[derive(Debug)]
pub struct Reporter {
    session: String,
    page: Option<String>,
    number: u64,
    next: Instant,
}

impl Reporter {
    /// Of a robot in this Zenoh session, whose motorlink shows this page.
    #[must_use]
    pub const fn new(session: String, page: Option<String>, now: Instant) -> Self {
        Self {
            session,
            page,
            number: 0,
            next: now,
        }
    }

    /// The state, when it is due. `state` is the newest of motorlink, with the time at which it came.
    pub fn report(
        &mut self,
        now: Instant,
        state: Option<(Instant, &State)>,
        drive: &Drive,
        rover: &Rover,
    ) -> Option<RobotState> {
        if now < self.next {
            return None;
        }
        // Without what was missed.
        self.next = (self.next + PERIOD).max(now);
        self.number += 1;
        let age = state.map_or(Duration::ZERO, |(at, _)| now.saturating_duration_since(at));
        let state = state.map(|(_, state)| state);
        let sources = Sources {
            state,
            age_us: u32::try_from(age.as_micros()).unwrap_or(u32::MAX),
            rover,
            drive: DriveStatus::of(state, drive.is_driving(), drive.must_rest()),
        };
        let page = self.page.clone();
        Some(RobotState::new(&self.session, self.number, page, sources))
    }
}

/// Publishes the states. Dropped, the robot has gone for the fleet, too.
pub struct Publisher {
    publisher: zenoh::pubsub::Publisher<'static>,
    _token: LivelinessToken,
}

impl Publisher {
    /// Of this robot.
    ///
    /// # Errors
    ///
    /// What Zenoh says.
    pub fn new(session: &Session, name: &RobotName) -> Result<Self> {
        let publisher = session
            .declare_publisher(name.state_key())
            // A network that is slow delays no later state.
            .congestion_control(CongestionControl::Drop)
            .wait()
            .map_err(|error| anyhow!("{error}"))?;
        let key = name.token_key(&session.zid().to_string());
        let token = session.liveliness().declare_token(key).wait();
        Ok(Self {
            publisher,
            _token: token.map_err(|error| anyhow!("{error}"))?,
        })
    }

    /// Sends a state.
    ///
    /// # Errors
    ///
    /// What Zenoh says.
    pub fn send(&self, state: &RobotState) -> Result<()> {
        let sent = self.publisher.put(state.write()).wait();
        sent.map_err(|error| anyhow!("{error}"))
    }
}
