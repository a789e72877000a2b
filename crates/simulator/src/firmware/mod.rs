//! The motor's controller: what it does with received frames.

mod frame_rate;
mod loops;
mod mode_switch_count;
mod parse_request;
mod protection;
mod sense;
mod separate;
mod set_id;
mod speed_loop;
mod speed_profile;

use motorlink_protocol::{
    Drive, Faults, Instant, Layout, Mode, MotorId, Request, RequestError, family::Model,
};

use crate::{
    config::{MotorConfig, WhenSilent},
    physics::{Bridge, Winding},
};
use frame_rate::FrameRate;
use loops::{Loops, target_turn};
use mode_switch_count::ModeSwitchCount;
pub(crate) use parse_request::{parse_request, parse_separate};
use protection::Protections;
pub(crate) use sense::Sense;
use separate::Separate;
pub(crate) use separate::fault_byte;
use set_id::SetIdCount;

/// The position loop is refused at or above this (maker's manual).
const POSITION_MODE_BELOW_RPM: f64 = 10.0;

/// The first byte of the ID query, which all motors answer.
const ALL_ADDRESS: u8 = 0xC8;

/// A drive frame that is in force.
#[derive(Clone, Copy, Debug)]
struct Command {
    drive: Drive,
    received: Instant,
}

/// A controller with power: what is lost without it. The ID in flash is given at the start.
#[derive(Clone, Debug)]
pub(crate) struct Firmware {
    id: MotorId,
    mode: Mode,
    command: Option<Command>,
    last_drive: Option<(Instant, Drive)>,
    obeys_all: bool,
    loops: Loops,
    mode_switch_count: ModeSwitchCount,
    set_id: SetIdCount,
    frame_rate: FrameRate,
    protections: Protections,
    when_silent: WhenSilent,
    /// What only a motor with separate frames has.
    separate: Separate,
}

impl Firmware {
    /// Power-up: the velocity loop, the ID last stored, every budget full. The wheel has made this many
    /// `turns`.
    pub(crate) fn power_up(id: MotorId, config: &MotorConfig, turns: f64) -> Self {
        Self {
            id,
            mode: Mode::Velocity,
            command: None,
            last_drive: None,
            obeys_all: config.obeys_all,
            loops: Loops::Idle,
            mode_switch_count: ModeSwitchCount::new(config.mode_switch_frames),
            set_id: SetIdCount::new(config.set_id_frames),
            frame_rate: FrameRate::default(),
            protections: Protections::default(),
            when_silent: config.when_silent,
            separate: Separate::power_up(config.model, turns),
        }
    }

    pub(crate) const fn id(&self) -> MotorId {
        self.id
    }

    pub(crate) const fn mode(&self) -> Mode {
        self.mode
    }

    pub(crate) fn faults(&self) -> Faults {
        self.protections.faults()
    }

    /// Whether it obeys a drive frame that is no brake.
    pub(crate) fn is_driven(&self) -> bool {
        self.command
            .is_some_and(|command| self.mode != Mode::Velocity || !command.drive.brakes())
    }

    /// The last received drive frame, obeyed or not.
    pub(crate) const fn last_drive(&self) -> Option<(Instant, Drive)> {
        self.last_drive
    }

    /// The drive frame that is obeyed, with its time of receipt.
    pub(crate) fn obeyed(&self) -> Option<(Instant, Drive)> {
        self.command
            .as_ref()
            .map(|command| (command.received, command.drive))
    }

    /// Whether no timer runs and the power stage does nothing at a standing wheel, so that time may be skipped.
    pub(crate) fn is_idle(&self) -> bool {
        let does_nothing = match &self.command {
            None => true,
            Some(_) if self.is_driven() => false,
            // A brake in force, which no time ends.
            Some(_) => self.when_silent == WhenSilent::Keep,
        };
        does_nothing && self.loops.are_passive() && self.protections.are_idle()
    }

    /// Ten bytes in combined frames passed on the wire. Gives the layout to answer in, where an answer is
    /// due.
    pub(crate) fn handle(
        &mut self,
        received: Result<Request, RequestError>,
        now: Instant,
        speed_rpm: f64,
    ) -> Option<Layout> {
        if let Ok(Request::SetId { id }) = received {
            // For all motors; the rate limit does not apply to a frame that has no reply.
            self.id = self.set_id.count(id).map_or(self.id, MotorId::from);
            return None;
        }
        // Five set-ID frames must come in a row: any other frame on the wire restarts the count.
        self.set_id.interrupt();
        let request = received.ok()?;
        let to_all = self.obeys_all
            && matches!(request, Request::Drive { id, .. } if id.get() == ALL_ADDRESS);
        let to_other = request.addressee().is_some_and(|id| id != self.id);
        if (to_other && !to_all) || !self.frame_rate.admits(now) {
            return None;
        }
        match request {
            Request::Drive { drive, .. } => self.drive(drive, now),
            Request::SwitchMode { mode, .. } => self.switch_mode(mode, speed_rpm),
            Request::Query { .. } | Request::IdQuery | Request::SetId { .. } | Request::Raw(_) => {}
        }
        request.reply_layout()
    }

    /// While a protection is active a drive frame is answered but not obeyed (maker's manual).
    fn drive(&mut self, drive: Drive, now: Instant) {
        self.last_drive = Some((now, drive));
        if self.protections.faults().is_none() {
            self.command = Some(Command {
                drive,
                received: now,
            });
        }
    }

    fn switch_mode(&mut self, mode: Mode, speed_rpm: f64) {
        if !self.mode_switch_count.count(mode) || mode == self.mode {
            return;
        }
        if mode == Mode::Position && speed_rpm.abs() >= POSITION_MODE_BELOW_RPM {
            return;
        }
        self.mode = mode;
        self.forget_command();
    }

    /// One step: what the power stage is to do until the next.
    pub(crate) fn step(
        &mut self,
        now: Instant,
        sense: &Sense,
        model: Model,
        winding: Winding,
    ) -> Bridge {
        let wants_motion = self.command.is_some() && self.loops.want_motion();
        self.protections.update(now, sense, wants_motion);
        if !self.protections.faults().is_none() {
            self.forget_command();
        }
        let ends = |command: Command| self.when_silent.ends(now.since(command.received));
        if self.command.is_some_and(ends) {
            self.forget_command();
            if let WhenSilent::BrakeAfter(_) = self.when_silent {
                self.loops = Loops::Brake;
            }
        }
        let Some(Command { drive, .. }) = self.command else {
            return match self.loops {
                Loops::Brake => Bridge::Short,
                _ => Bridge::Open,
            };
        };
        match self.mode {
            Mode::OpenLoop => self.loops.open_loop(drive, sense, winding),
            Mode::Velocity if drive.brakes() => self.loops.brake(),
            Mode::Velocity => self.loops.velocity(model, drive, sense),
            Mode::Current => self.loops.current(model, drive),
            Mode::Position => {
                let target_turns = if model.has_separate_frames() {
                    self.separate.zero_turns() + target_turn(drive)
                } else {
                    // The reported angle falls at positive speed, so the wheel has to go to minus the angle.
                    -target_turn(drive)
                };
                self.loops.position(model, target_turns, sense)
            }
        }
    }
}
