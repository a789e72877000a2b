//! What a port on trial shows: which model its motors have, and whether the wanted one is among them.

use std::time::Duration;

use gloo_timers::future::sleep;
use motorlink_protocol::{MotorId, family::Model};

use crate::{port_owner::Shared, session::Session};

/// How long the wanted motor may take to reply before the next adapter is tried: an ID query of 60 ms
/// and three queries at 10 Hz.
const TRIAL: Duration = Duration::from_millis(400);
/// How long the motors may take to show their model: an ID query of 60 ms and two queries at 10 Hz.
const DETECTION: Duration = Duration::from_millis(200);
/// How often to check for a reply.
const TRIAL_STEP: Duration = Duration::from_millis(20);

/// Another session has begun meanwhile, so this task ends.
pub(crate) struct Superseded;

/// What the motors of a port on trial have shown.
pub(crate) enum Shown {
    /// They answer as the model of the line.
    Own,
    /// One answers as another model of the same baud rate.
    Other(Model),
    /// None answers.
    Nothing,
}

/// Waits until the motors of the port on trial show their model.
pub(crate) async fn shown(shared: &Shared, generation: u32) -> Result<Shown, Superseded> {
    let mut left = DETECTION.as_millis() / TRIAL_STEP.as_millis();
    loop {
        sleep(TRIAL_STEP).await;
        let owner = shared.borrow();
        let open = match &owner.session {
            Session::Open(open) if owner.generation == generation => open,
            _ => return Err(Superseded),
        };
        if open.bus.model_known() {
            return Ok(Shown::Own);
        }
        left = left.saturating_sub(1);
        let other = open.bus.likely_model();
        // One frame of another model is enough to try that one next: if it was noise, its own trial shows it.
        let is_over = left == 0 || other.is_some();
        // Closing the port would cut off a stop that was commanded meanwhile: wait until it ends.
        if is_over && !open.bus.is_active(owner.now()) {
            return Ok(other.map_or(Shown::Nothing, Shown::Other));
        }
    }
}

/// Whether the wanted motor replies on the port that is on trial.
pub(crate) async fn answers(
    shared: &Shared,
    generation: u32,
    wanted: MotorId,
) -> Result<bool, Superseded> {
    let mut left = TRIAL.as_millis() / TRIAL_STEP.as_millis();
    loop {
        sleep(TRIAL_STEP).await;
        let owner = shared.borrow();
        let open = match &owner.session {
            Session::Open(open) if owner.generation == generation => open,
            _ => return Err(Superseded),
        };
        if open.has_replied(owner.now(), wanted) {
            return Ok(true);
        }
        left = left.saturating_sub(1);
        // Closing the port would cut off a stop that was commanded meanwhile: wait until it ends.
        if left == 0 && !open.bus.is_active(owner.now()) {
            return Ok(false);
        }
    }
}
