//! What a command of the operator changes.

use motorlink_bus::{Activity, Bus, Command, Consent, Refusal, is_hazardous};
use motorlink_protocol::{Frame, Instant, MotorId, Setpoint};
use motorlink_simulator::{VirtualMotor, World};

use crate::rule::{Outcome, Rule};

use super::{Rules, said::may_obey, turns};

impl Rules {
    /// The bus answered a command that was given at `given`.
    pub(crate) fn on_command(
        &mut self,
        now: Instant,
        given: Instant,
        command: Command,
        answer: Result<(), Refusal>,
        bus: &Bus,
        world: &World,
    ) -> Outcome {
        let raw = self.operator.raw();
        self.operator.on_command(now, given, command, answer)?;
        match answer {
            Ok(()) => {
                if let Command::SendRaw { frame, .. } = command
                    && is_hazardous(&frame)
                {
                    self.unasked.sent_by_hand(&frame, bus, now);
                }
                self.carried_out(now, command, raw, bus, world);
            }
            Err(Refusal::AboveSpeedLimit(_) | Refusal::NeedsConsent(_)) => {
                self.judge(Rule::NothingAboveALimit);
            }
            Err(_) => {}
        }
        self.check_active_setpoints(now, bus)
    }

    /// The bus accepted a command; `raw` is the raw frame before it.
    pub(super) fn carried_out(
        &mut self,
        now: Instant,
        command: Command,
        raw: Option<Frame>,
        bus: &Bus,
        world: &World,
    ) {
        match command {
            // A stop that joins another has its own window.
            Command::Stop(id) => {
                self.stop_begins(now, |other| *other == id);
                self.stop_began = self.stop_began.map(|_| now);
                self.moves_no_more(now, world, |other| *other == id);
            }
            Command::StopAll(_) => {
                self.stop_begins(now, |_| true);
                self.stop_began = Some(now);
                self.moves_no_more(now, world, |_| true);
            }
            Command::StopRaw => {
                let standing = self.operator.standing();
                self.moves_no_more(now, world, |id| {
                    !standing.contains(id) && raw.is_some_and(|raw| may_obey(&raw, *id))
                });
            }
            Command::SwitchMode { id, .. } => {
                self.liveness.asked(|other| *other == id);
                self.starts.asked_otherwise(|other| *other == id);
            }
            Command::Start {
                id,
                setpoint,
                consent,
            } => self.starts(now, &[(id, setpoint)], consent, bus),
            Command::Adjust {
                id,
                setpoint,
                consent,
            } if self.starts.waits(id) => self.starts(now, &[(id, setpoint)], consent, bus),
            Command::StartGroup { setpoints, consent } => {
                let parts: Vec<_> = setpoints.entries().collect();
                self.starts(now, &parts, consent, bus);
            }
            // Zeros end what waits.
            Command::AdjustGroup { setpoints, consent }
                if setpoints.entries().all(|(id, _)| self.starts.waits(id))
                    && setpoints.entries().any(|(_, setpoint)| turns(setpoint)) =>
            {
                let parts: Vec<_> = setpoints.entries().collect();
                self.starts(now, &parts, consent, bus);
            }
            Command::Drive { id, consent, .. } | Command::Adjust { id, consent, .. } => {
                self.liveness.asked(|other| *other == id);
                self.motion.asked(|other| *other == id);
                self.bounds.on_command(id, consent);
                self.starts.asked_otherwise(|other| *other == id);
            }
            Command::DriveGroup { setpoints, consent }
            | Command::AdjustGroup { setpoints, consent } => {
                for (id, _) in setpoints.entries() {
                    self.liveness.asked(|other| *other == id);
                    self.motion.asked(|other| *other == id);
                    self.bounds.on_command(id, consent);
                    self.starts.asked_otherwise(|other| *other == id);
                }
            }
            Command::SendRaw { frame, .. } if is_hazardous(&frame) => {
                self.liveness.asked(|id| may_obey(&frame, *id));
                let motors = world.motors().map(VirtualMotor::id);
                self.liveness
                    .sent_by_hand(motors.filter(|id| may_obey(&frame, *id)));
                self.motion.asked(|id| may_obey(&frame, *id));
            }
            // Where a wheel will be is not known without its speed.
            Command::Hold(id)
                if !self.speed_stuck.contains(&id) && self.motion.hold(now, id, world) =>
            {
                self.judge(Rule::HoldHolds);
            }
            _ => {}
        }
    }

    /// A person started these motors, or changed the setpoints that wait for their stop or their switch.
    pub(super) fn starts(
        &mut self,
        now: Instant,
        parts: &[(MotorId, Setpoint)],
        consent: Consent,
        bus: &Bus,
    ) {
        for (id, setpoint) in parts.iter().copied() {
            let mut motors = bus.motors(now).filter(|status| status.id == id);
            let activity = motors.next().map(|status| status.activity);
            let stops = matches!(activity, Some(Activity::Stopping { .. }));
            if stops && !self.starts.waits(id) {
                // What was driven before is stopped first.
                self.stop_begins(now, |other| *other == id);
            } else if !stops {
                self.liveness.asked(|other| *other == id);
            }
            self.operator.stands(now, id, setpoint);
            self.motion.asked(|other| *other == id);
            self.bounds.on_command(id, consent);
        }
        self.starts.asked(now, parts);
    }

    /// These motors were stopped: any motion from now on is unwanted.
    pub(super) fn moves_no_more(
        &mut self,
        now: Instant,
        world: &World,
        is_stopped: impl Fn(&MotorId) -> bool,
    ) {
        let judged = self.motion.stop(now, world, is_stopped);
        *self.judged.entry(Rule::StopMovesNothing).or_default() += judged;
    }
}
