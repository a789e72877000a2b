//! One motor: firmware and physics.

mod external_inputs;
mod separate;

use motorlink_protocol::{
    Celsius, Current, Detail, Drive, Faults, Frame, Instant, Layout, Mode, MotorId, Reply, Request,
    RequestError, Rpm, family,
};

use crate::{
    config::MotorConfig,
    convert::{narrow, nearest_i16, nearest_u8},
    figures::Figures,
    firmware::{Firmware, Sense},
    physics::{
        Bridge, DRY_FRICTION_NM, Encoder, Flow, Heat, Leak, Push, STEP, STEP_S, VISCOUS_NM_S,
        Wheel, Winding, rpm,
    },
    random::Random,
};

/// Noise of the reported current while the wheel turns, to either side. Captures at +100 rpm have raw
/// 0 to 1475 round a mean of 995: 0.24 A to one side and 0.12 A to the other.
const NOISE_TURNING_A: f64 = 0.21;
/// Reported current of a motor at rest: raw 6 to 10 in captures.
const REST_A: f64 = 0.002;
/// Its noise, to either side.
const NOISE_REST_A: f64 = 0.0005;

/// Whether the supply is on. Without it only the flash keeps its content.
#[derive(Clone, Debug)]
enum Power {
    On(Box<Firmware>),
    Off { stored: MotorId },
}

/// A virtual motor. Its getters return exact values, not the rounded ones of a reply.
///
/// What is done to it by hand takes effect at its present: advance the world first.
#[derive(Clone, Debug)]
pub struct VirtualMotor {
    config: MotorConfig,
    power: Power,
    wheel: Wheel,
    heat: Heat,
    flow: Flow,
    load_nm: f64,
    push_nm: f64,
    leak: Leak,
    encoder_broken: bool,
    muted: bool,
    noise: Random,
    /// The last step that was taken.
    now: Instant,
}

impl VirtualMotor {
    pub(crate) fn new(config: MotorConfig, noise: Random, now: Instant) -> Self {
        let angle = f64::from(config.angle_deg) / 360.0;
        let rises = config.model.has_separate_frames();
        let wheel = Wheel::at(if rises { angle } else { -angle });
        let firmware = Firmware::power_up(config.id, &config, wheel.turns());
        Self {
            power: Power::On(Box::new(firmware)),
            wheel,
            heat: Heat::at(f64::from(config.ambient_c)),
            flow: Flow::default(),
            load_nm: f64::from(config.load_nm),
            push_nm: 0.0,
            leak: Leak::default(),
            encoder_broken: false,
            muted: false,
            noise,
            now: on_grid(now),
            config,
        }
    }

    const fn figures(&self) -> &'static Figures {
        Figures::of(self.model())
    }

    /// Its address now; without power, the one in its flash.
    #[must_use]
    pub fn id(&self) -> MotorId {
        match &self.power {
            Power::On(firmware) => firmware.id(),
            Power::Off { stored } => *stored,
        }
    }

    /// The loop that it has closed, or had before the open loop; without power, the loop after power-up.
    #[must_use]
    pub fn mode(&self) -> Mode {
        self.firmware().map_or(Mode::Velocity, Firmware::mode)
    }

    /// What is wrong with it, by the names of a DDSM115; nothing is reported without power.
    #[must_use]
    pub fn faults(&self) -> Faults {
        self.firmware().map_or(Faults::NONE, Firmware::faults)
    }

    /// Whether it obeys a drive frame that is no brake.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        self.firmware().is_some_and(Firmware::is_driven)
    }

    /// The last drive frame that it received, obeyed or not, with its time.
    #[must_use]
    pub fn last_drive(&self) -> Option<(Instant, Drive)> {
        self.firmware().and_then(Firmware::last_drive)
    }

    /// The drive frame that it obeys now, with its time of receipt.
    #[must_use]
    pub fn obeyed(&self) -> Option<(Instant, Drive)> {
        self.firmware().and_then(Firmware::obeyed)
    }

    /// How far its wheel would run from here without load or torque, in degrees.
    #[must_use]
    pub fn coasting_deg(&self) -> f32 {
        narrow(self.wheel.coasting_turns() * 360.0)
    }

    /// Whether it has its supply.
    #[must_use]
    pub const fn is_powered(&self) -> bool {
        matches!(self.power, Power::On(_))
    }

    /// True speed in rpm, not rounded; exactly 0 at standstill.
    #[must_use]
    pub fn speed_rpm(&self) -> f32 {
        narrow(rpm(self.wheel.speed_rad_s()))
    }

    /// The angle as it is reported: in encoder counts of 0.088 degrees. At positive speed it falls; of a
    /// model with separate frames it is **assumed** to grow.
    #[must_use]
    pub fn angle_deg(&self) -> f32 {
        let turns = self.wheel.turns();
        let encoder = if self.model().has_separate_frames() {
            Encoder::read_rising(turns)
        } else {
            Encoder::read(turns)
        };
        narrow(encoder.degrees())
    }

    /// Turns in the direction of positive speed, from a reported angle of 0.
    #[must_use]
    pub fn turns(&self) -> f32 {
        narrow(self.wheel.turns())
    }

    /// Torque current in amps as it is reported, without noise.
    #[must_use]
    pub const fn current_a(&self) -> f32 {
        narrow(self.flow.reported_a)
    }

    /// Torque of the windings in N.m.
    #[must_use]
    pub const fn torque_nm(&self) -> f32 {
        narrow(self.flow.torque_nm(self.figures()))
    }

    /// Winding temperature in degrees Celsius.
    #[must_use]
    pub const fn temperature_c(&self) -> f32 {
        narrow(self.heat.winding_c())
    }

    /// The world's first moment, before which nothing happened.
    pub(crate) fn start_at(&mut self, now: Instant) {
        self.now = on_grid(now);
    }

    const fn firmware(&self) -> Option<&Firmware> {
        match &self.power {
            Power::On(firmware) => Some(firmware),
            Power::Off { .. } => None,
        }
    }

    /// A `frame` passed on the wire: `received` in combined frames. Gives the layout to answer in, where an
    /// answer is due.
    pub(crate) fn handle(
        &mut self,
        frame: &Frame,
        received: Result<Request, RequestError>,
        now: Instant,
    ) -> Option<family::Layout> {
        self.advance(now);
        let model = self.model();
        let layout = if model.has_separate_frames() {
            self.handle_separate(model, frame, now)
        } else {
            self.handle_combined(received, now)
        };
        if let (Some(_), Power::On(firmware)) = (self.config.fault, &mut self.power) {
            firmware.forget_command();
        }
        layout
    }

    fn handle_combined(
        &mut self,
        received: Result<Request, RequestError>,
        now: Instant,
    ) -> Option<family::Layout> {
        let speed_rpm = rpm(self.wheel.speed_rad_s());
        match &mut self.power {
            Power::On(firmware) => {
                let layout = firmware.handle(received, now, speed_rpm);
                layout.map(family::Layout::from)
            }
            Power::Off { .. } => None,
        }
    }

    /// What it says now, unless it has no power or no voice.
    pub(crate) fn report(&mut self, layout: family::Layout) -> Option<Frame> {
        if self.muted || !self.is_powered() {
            return None;
        }
        let model = self.model();
        if model.has_separate_frames() {
            return self.report_separate(model, layout);
        }
        let encoder = Encoder::read(self.wheel.turns());
        let detail = match layout.combined()? {
            Layout::Drive => Detail::Drive {
                position: self.config.drive_angle_stuck.unwrap_or(encoder.fine()),
            },
            Layout::Query => Detail::Query {
                temperature: Celsius::new(nearest_u8(self.heat.winding_c())),
                position: encoder.coarse(),
            },
        };
        let reply = Reply {
            id: self.id(),
            mode: self.mode(),
            current: Some(Current::from_amps(narrow(self.measured_a()))),
            speed: Some(Rpm::new(nearest_i16(self.reported_rpm()))),
            detail,
            faults: Faults::from_byte(self.fault_byte()),
        };
        Some(reply.frame())
    }

    /// The reported speed, before it is rounded.
    fn reported_rpm(&self) -> f64 {
        let stuck = self.config.speed_stuck_rpm.map(f64::from);
        stuck.unwrap_or(rpm(self.wheel.speed_rad_s()))
    }

    /// The reported current with its noise, which a motor at rest hardly has.
    fn measured_a(&mut self) -> f64 {
        let either_side = self.noise.unit() + self.noise.unit() - 1.0;
        let turning = !self.wheel.stands() && self.flow != Flow::default();
        let (rest_a, noise_a) = if turning {
            (0.0, NOISE_TURNING_A)
        } else {
            (REST_A, NOISE_REST_A)
        };
        self.flow.reported_a + rest_a + either_side * noise_a
    }

    /// Steps up to `to`.
    pub(crate) fn advance(&mut self, to: Instant) {
        while self.now + STEP <= to {
            if self.is_at_rest() {
                self.skip(to);
            } else {
                self.now = self.now + STEP;
                self.step();
            }
            if is_heat_step(self.now) {
                self.heat.settle();
                self.sense_protections();
            }
        }
    }

    fn step(&mut self) {
        let (sense, model, winding) = (self.sense(), self.model(), self.winding());
        let bridge = match &mut self.power {
            Power::On(firmware) => firmware.step(self.now, &sense, model, winding),
            Power::Off { .. } => Bridge::Open,
        };
        let (speed_rad_s, figures) = (self.wheel.speed_rad_s(), self.figures());
        self.flow = winding.flow(bridge, speed_rad_s, self.leak);
        self.heat.add_j(self.flow.loss_w(figures) * STEP_S);
        self.wheel.step(Push {
            torque_nm: self.flow.torque_nm(figures) + self.push_nm,
            dry_nm: DRY_FRICTION_NM + self.load_nm,
            viscous_nm_s: VISCOUS_NM_S,
        });
    }

    /// Nothing turns, flows or is timed: only heat goes on.
    fn is_at_rest(&self) -> bool {
        self.wheel.stands()
            && self.push_nm == 0.0
            && self.flow == Flow::default()
            && !self.encoder_broken
            && self.firmware().is_none_or(Firmware::is_idle)
    }

    /// To the next heat step, or as far as there are whole steps.
    fn skip(&mut self, to: Instant) {
        let heat_us = micros(Heat::STEP);
        let next_heat = Instant::from_micros((self.now.as_micros() / heat_us + 1) * heat_us);
        self.now = on_grid(to).min(next_heat);
    }

    /// At rest the firmware does not step, but it still watches the temperature.
    fn sense_protections(&mut self) {
        if self.is_at_rest() {
            let (sense, model, winding) = (self.sense(), self.model(), self.winding());
            if let Power::On(firmware) = &mut self.power {
                firmware.step(self.now, &sense, model, winding);
            }
        }
    }

    fn sense(&self) -> Sense {
        let speed_rad_s = self.wheel.speed_rad_s();
        Sense {
            speed_rad_s,
            turns: self.wheel.turns(),
            phase_a: self.flow.phase_a,
            bus_a: self.flow.bus_a,
            winding_c: self.heat.winding_c(),
            range_a: self.winding().range_a(speed_rad_s),
            encoder_broken: self.encoder_broken,
        }
    }

    fn winding(&self) -> Winding {
        Winding::on(f64::from(self.config.supply_v), self.figures())
    }
}

fn micros(duration: std::time::Duration) -> u64 {
    u64::try_from(duration.as_micros())
        .unwrap_or(u64::MAX)
        .max(1)
}

/// The last step at or before this moment.
fn on_grid(now: Instant) -> Instant {
    let step_us = micros(STEP);
    Instant::from_micros(now.as_micros() / step_us * step_us)
}

fn is_heat_step(now: Instant) -> bool {
    now.as_micros().is_multiple_of(micros(Heat::STEP))
}
