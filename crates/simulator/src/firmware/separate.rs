//! What the controller of a DDSM210 and a DDSM400 does otherwise: separate frames, the open loop, enabling.
//!
//! By the vendor's library and clients. What follows is **assumed**:
//!
//! - A mode switch is taken at its first frame, since it is answered.
//! - The position loop is refused at 10 rpm and above, as by a DDSM115.
//! - The reply to a mode switch and to a mode query has the mode that the motor is in, and 9 or 8 before a
//!   loop is chosen.
//! - Enabling a motor that has a loop changes nothing.
//! - Angle 0 of the position loop is where it was entered, of a DDSM400 too, and the angle grows at positive
//!   speed.
//! - A set-ID frame is answered `new 64 00 ..`, or `new 65 00 ..`, when it has taken effect: no source says after
//!   which of the five frames.
//! - Protections trip and clear as in a DDSM115; a fault without a known bit is not reported.

use motorlink_protocol::{
    Faults, Instant, Mode,
    family::{Fault, Layout, ModeReading, Model, Request, RequestError},
};

use super::{Firmware, POSITION_MODE_BELOW_RPM, loops::Loops};

/// What it does with drive frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// Ignores them until it is enabled.
    Disabled,
    /// Enabled, and ignores them until it is switched to a loop.
    Enabled,
    /// Obeys them in its loop.
    #[default]
    Ready,
}

/// State that only a motor with separate frames has.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Separate {
    stage: Stage,
    /// Where angle 0 of the position loop is, in turns of the wheel.
    zero_turns: f64,
    /// Where it counts turns from, in whole turns of the wheel.
    power_up_turns: f64,
    /// Whether its next drive reply is the answer to the set-ID frames.
    confirms_id: bool,
}

impl Separate {
    pub(super) fn power_up(model: Model, turns: f64) -> Self {
        if !model.has_separate_frames() {
            return Self::default();
        }
        let stage = if model.spec().needs_enable {
            Stage::Disabled
        } else {
            Stage::Ready
        };
        Self {
            stage,
            zero_turns: 0.0,
            power_up_turns: turns.floor(),
            confirms_id: false,
        }
    }

    pub(crate) const fn zero_turns(self) -> f64 {
        self.zero_turns
    }

    pub(crate) const fn power_up_turns(self) -> f64 {
        self.power_up_turns
    }
}

impl Firmware {
    pub(crate) const fn separate(&self) -> Separate {
        self.separate
    }

    /// The loop whose drive frames it obeys, if it does.
    pub(crate) fn active_mode(&self) -> Option<Mode> {
        match self.separate.stage {
            Stage::Disabled | Stage::Enabled => None,
            Stage::Ready => Some(self.mode),
        }
    }

    /// What it answers to a mode query.
    pub(crate) fn mode_byte(&self) -> u8 {
        match (self.active_mode(), self.separate.stage) {
            (Some(mode), _) => mode.byte(),
            (None, Stage::Disabled) => ModeReading::DISABLED,
            (None, _) => ModeReading::ENABLED,
        }
    }

    /// Whether its next drive reply is the answer to the set-ID frames.
    pub(crate) const fn confirms_id(&self) -> bool {
        self.separate.confirms_id
    }

    /// Ten bytes in separate frames passed on the wire. Gives the layout to answer in, where an answer is
    /// due.
    pub(crate) fn handle_separate(
        &mut self,
        model: Model,
        received: Result<Request, RequestError>,
        now: Instant,
        speed_rpm: f64,
        turns: f64,
    ) -> Option<Layout> {
        if let Ok(Request::SetId { id }) = received {
            self.id = self.set_id.count(id)?.into();
            self.separate.confirms_id = true;
            return Some(Layout::Drive);
        }
        self.set_id.interrupt();
        self.separate.confirms_id = false;
        let request = received.ok()?;
        let to_other = request.addressee().is_some_and(|id| id != self.id);
        if to_other || !self.frame_rate.admits(now) {
            return None;
        }
        match request {
            Request::Drive { drive, .. } => {
                self.drive(drive, now);
                if self.active_mode().is_none() {
                    self.forget_command();
                }
            }
            Request::SwitchMode { mode, .. } => self.switch(mode, speed_rpm, turns),
            Request::Enable { on, .. } => self.enable(on),
            Request::Query { .. }
            | Request::ModeQuery { .. }
            | Request::IdQuery
            | Request::SetId { .. } => {}
        }
        request.reply_layout(model)
    }

    fn switch(&mut self, mode: Mode, speed_rpm: f64, turns: f64) {
        if self.separate.stage == Stage::Disabled || self.active_mode() == Some(mode) {
            return;
        }
        if mode == Mode::Position && speed_rpm.abs() >= POSITION_MODE_BELOW_RPM {
            return;
        }
        self.mode = mode;
        self.separate.stage = Stage::Ready;
        self.separate.zero_turns = turns;
        self.forget_command();
    }

    fn enable(&mut self, on: bool) {
        self.separate.stage = match (on, self.separate.stage) {
            (true, Stage::Disabled) => Stage::Enabled,
            (true, stage) => stage,
            (false, _) => Stage::Disabled,
        };
        if !on {
            self.forget_command();
        }
    }

    /// The old value means something else in the new loop: nothing is driven until the next frame.
    pub(crate) fn forget_command(&mut self) {
        self.command = None;
        self.loops = Loops::Idle;
    }
}

/// The fault byte of this model for these protections.
pub(crate) fn fault_byte(model: Model, active: Faults) -> u8 {
    let is_active = |fault: &Fault| match fault {
        Fault::Sensor => active.contains(Fault::Sensor),
        Fault::BusOvercurrent => active.contains(Fault::BusOvercurrent),
        Fault::PhaseOvercurrent => active.contains(Fault::PhaseOvercurrent),
        Fault::Overcurrent => {
            active.contains(Fault::BusOvercurrent) || active.contains(Fault::PhaseOvercurrent)
        }
        Fault::Stall => active.contains(Fault::Stall),
        Fault::OverTemperature => active.contains(Fault::OverTemperature),
        // Nothing simulates them.
        Fault::Disconnected | Fault::Voltage => false,
    };
    let faults = model.spec().faults.iter().filter(|fault| is_active(fault));
    faults.fold(0, |byte, fault| byte | fault.mask())
}
