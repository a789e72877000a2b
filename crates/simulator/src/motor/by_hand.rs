//! What a person, or a test, may do to a motor from outside the wire.

use crate::{firmware::Firmware, physics::Leak};

use super::{Power, VirtualMotor};

/// What one does to it by hand. It takes effect at the motor's present: advance the world first.
impl VirtualMotor {
    /// A load that opposes motion, like a hand on the tyre, in N.m.
    pub fn set_load_nm(&mut self, load_nm: f32) {
        self.load_nm = f64::from(load_nm).max(0.0);
    }

    /// A torque from outside that does not ask for the direction of motion, like a weight on a rope;
    /// positive pushes towards positive speed, in N.m.
    pub fn set_push_nm(&mut self, push_nm: f32) {
        self.push_nm = f64::from(push_nm);
    }

    /// Holds the wheel so that it cannot turn, or lets go.
    pub const fn block(&mut self, blocked: bool) {
        self.wheel.block(blocked);
    }

    /// Takes the supply away or gives it back. Off and on again is a power cycle: the velocity loop,
    /// the stored ID, no protection active, and one set-ID more.
    pub fn power(&mut self, on: bool) {
        match (&self.power, on) {
            (Power::On(firmware), false) => {
                self.power = Power::Off {
                    stored: firmware.id(),
                };
            }
            (Power::Off { stored }, true) => {
                let firmware = Firmware::power_up(*stored, &self.config);
                self.power = Power::On(Box::new(firmware));
            }
            _ => {}
        }
    }

    /// Cuts its answers off, as a broken sender would; it still hears and obeys.
    pub const fn mute(&mut self, muted: bool) {
        self.muted = muted;
    }

    /// Brings the winding to a temperature now; from there it goes its way.
    pub fn set_temperature_c(&mut self, celsius: f32) {
        self.heat.set_winding_c(f64::from(celsius));
    }

    /// The temperature of the air round it, towards which the winding goes in minutes.
    pub fn set_ambient_c(&mut self, celsius: f32) {
        self.heat.set_ambient_c(f64::from(celsius));
    }

    /// A defect that draws so much more while the power stage works: in a phase and from the supply.
    /// The healthy motor limits itself to 2.7 A and would never trip an overcurrent protection.
    pub fn set_leak_a(&mut self, phase_a: f32, bus_a: f32) {
        self.leak = Leak {
            phase_a: f64::from(phase_a),
            bus_a: f64::from(bus_a),
        };
    }

    /// Breaks or mends the encoder. It shows in the fault byte; the angle stays right.
    pub const fn break_encoder(&mut self, broken: bool) {
        self.encoder_broken = broken;
    }
}
