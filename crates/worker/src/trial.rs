//! What the worker finds out about a port on trial: the model of its motors, and whether the wanted motor replies.

use std::time::Duration;

use gloo_timers::future::sleep;
use motorlink_bus::{Awaited, DetectedModel, MotorStatus};
use motorlink_protocol::{Instant, MotorId};

use crate::{
    port_owner::Shared,
    port_state::{OpenPort, PortState},
};

/// How long the wanted motor may take to reply before the next adapter is tried: an ID query of 60 ms
/// and three queries at 10 Hz.
const TRIAL: Duration = Duration::from_millis(400);
/// How often to check for a reply.
const TRIAL_STEP: Duration = Duration::from_millis(20);

/// Another port state has begun meanwhile, so this task ends.
pub(crate) struct Superseded;

/// Waits for what the trial of the port awaits. Returns the model that replies show; `None` if they show none in time.
pub(crate) async fn awaited(
    shared: &Shared,
    generation: u32,
    awaited: Awaited,
) -> Result<Option<DetectedModel>, Superseded> {
    if awaited == Awaited::Nothing {
        return Ok(None);
    }
    let found = |open: &OpenPort, now: Instant| awaited.found(&open.bus, now);
    wait_on_trial(shared, generation, awaited.limit(), found).await
}

/// Waits until the wanted motor replies on the port on trial. Returns whether it does.
pub(crate) async fn wanted_motor_replies(
    shared: &Shared,
    generation: u32,
    wanted: MotorId,
) -> Result<bool, Superseded> {
    let replied = |open: &OpenPort, now: Instant| open.has_replied(now, wanted).then_some(());
    let reply = wait_on_trial(shared, generation, TRIAL, replied).await?;
    Ok(reply.is_some())
}

/// Waits until a motor that was left driven reports that it turns: then this is its adapter. Nothing but queries goes out
/// meanwhile. Returns false after the time in which all of them have been asked.
pub(crate) async fn left_motor_turns(shared: &Shared, generation: u32) -> Result<bool, Superseded> {
    let left: Vec<MotorId> = {
        let owner = shared.borrow();
        let PortState::Open(open) = &owner.port else {
            return Err(Superseded);
        };
        owner.left.of(open.usb()).map(|motor| motor.id).collect()
    };
    let turns = |open: &OpenPort, now: Instant| {
        let turns = |motor: MotorStatus| {
            let speed = motor.speed.map(|(_, speed)| speed.magnitude());
            left.contains(&motor.id) && speed.is_some_and(|rpm| rpm > 0)
        };
        open.bus.motors(now).any(turns).then_some(())
    };
    let found = wait_on_trial(shared, generation, TRIAL, turns).await?;
    Ok(found.is_some())
}

/// Waits until `found` returns a result for the port on trial. Returns `None` after `limit`, or later if the bus is
/// still active then: closing the port would cut off a stop that was commanded meanwhile.
async fn wait_on_trial<T>(
    shared: &Shared,
    generation: u32,
    limit: Duration,
    found: impl Fn(&OpenPort, Instant) -> Option<T>,
) -> Result<Option<T>, Superseded> {
    let mut left = limit.as_millis() / TRIAL_STEP.as_millis();
    loop {
        sleep(TRIAL_STEP).await;
        let owner = shared.borrow();
        let open = match &owner.port {
            PortState::Open(open) if owner.generation == generation => open,
            _ => return Err(Superseded),
        };
        let now = owner.now();
        let result = found(open, now);
        if result.is_some() {
            return Ok(result);
        }
        left = left.saturating_sub(1);
        if left == 0 && !open.bus.is_active(now) {
            return Ok(None);
        }
    }
}
