//! The model of a motor, and what one with separate frames receives and reports.

use motorlink_protocol::{
    Celsius, Frame, Instant,
    family::{self, DriveReading, Faults, Layout, ModeReading, Model, Odometry, Reading, Speed},
};

use crate::{
    convert::{narrow, nearest_i32, nearest_u8},
    firmware::{Firmware, fault_byte, parse_separate},
    physics::{Encoder, rpm},
};

use super::{Power, VirtualMotor};

impl VirtualMotor {
    /// Its model.
    #[must_use]
    pub const fn model(&self) -> Model {
        self.config.model
    }

    /// The loop whose drive frames it obeys; `None` without power, and before a model that needs it has
    /// been enabled and switched to a loop.
    #[must_use]
    pub fn active_mode(&self) -> Option<family::Mode> {
        self.firmware().and_then(Firmware::active_mode)
    }

    /// The fault byte that it reports; nothing is reported without power.
    #[must_use]
    pub fn fault_byte(&self) -> u8 {
        let model = self.model();
        let constant = self
            .config
            .fault
            .filter(|fault| self.is_powered() && model.spec().faults.contains(fault));
        fault_byte(model, self.faults()) | constant.map_or(0, family::Fault::mask)
    }

    pub(super) fn handle_separate(
        &mut self,
        model: Model,
        frame: &Frame,
        now: Instant,
    ) -> Option<Layout> {
        let (speed_rpm, turns) = (rpm(self.wheel.speed_rad_s()), self.wheel.turns());
        let received = parse_separate(model, frame);
        match &mut self.power {
            Power::On(firmware) => firmware.handle_separate(model, received, now, speed_rpm, turns),
            Power::Off { .. } => None,
        }
    }

    /// The reply in this layout.
    pub(super) fn report_separate(&mut self, model: Model, layout: Layout) -> Option<Frame> {
        let id = self.id();
        if layout == Layout::Drive && self.firmware()?.confirms_id() {
            let byte_1 = if model == Model::Ddsm400 { 0x65 } else { 0x64 };
            return Some(Frame::with_crc([id.get(), byte_1, 0, 0, 0, 0, 0, 0, 0]));
        }
        let faults = Faults::of(model, self.fault_byte());
        let reading = match layout {
            Layout::Drive => {
                let last_drive = self.last_drive();
                Reading::Drive(DriveReading {
                    id,
                    value: self.value(model),
                    current: model.current_of_amps(narrow(self.measured_a())),
                    acceleration: last_drive.map_or(0, |(_, drive)| drive.acceleration.byte()),
                    temperature: Celsius::new(nearest_u8(self.heat.winding_c())),
                    faults,
                })
            }
            Layout::Query => {
                let from = self.firmware()?.separate().power_up_turns();
                Reading::Odometry(Odometry {
                    id,
                    turns: nearest_i32((self.wheel.turns() - from).floor()),
                    position: Encoder::read_rising(self.wheel.turns()).fine(),
                    faults,
                })
            }
            Layout::Mode | Layout::Switch => Reading::Mode(ModeReading {
                id,
                byte: self.firmware()?.mode_byte(),
                switched: layout == Layout::Switch,
            }),
        };
        Some(reading.frame(model))
    }

    /// Bytes 2 and 3 of a drive reply: the speed; in the position loop the angle from where the loop
    /// was entered, by one source of a DDSM210. Assumed the same of a DDSM400.
    fn value(&self, model: Model) -> i16 {
        if self.active_mode() == Some(family::Mode::Position) {
            let zero_turns = self.firmware().map(|it| it.separate().zero_turns());
            let turns = self.wheel.turns() - zero_turns.unwrap_or_default();
            return Encoder::read_rising(turns).fine().raw().cast_signed();
        }
        let tenths = nearest_i32(self.reported_rpm() * 10.0);
        model.raw_of_speed(Speed::from_tenths(tenths))
    }
}
