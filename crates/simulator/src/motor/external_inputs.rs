//! External inputs to a motor, by a test or a person: load, power, temperature, defects.

use crate::{firmware::Firmware, physics::Leak};

use super::{Power, VirtualMotor};

/// External inputs. They take effect at the motor's present time: advance the world first.
impl VirtualMotor {
    /// A load that opposes motion, like a hand on the tyre, in N.m.
    pub fn set_load_nm(&mut self, load_nm: f32) {
        self.load_nm = f64::from(load_nm).max(0.0);
    }

    /// An external torque that does not depend on the direction of motion, like a weight on a rope;
    /// positive pushes towards positive speed, in N.m.
    pub fn set_push_nm(&mut self, push_nm: f32) {
        self.push_nm = f64::from(push_nm);
    }

    /// Blocks the wheel, or releases it.
    pub const fn block(&mut self, blocked: bool) {
        self.wheel.block(blocked);
    }

    /// Switches the supply. Off and on is a power cycle: the velocity loop, the stored ID, no
    /// protection active, and one more set-ID possible.
    pub fn power(&mut self, on: bool) {
        match (&self.power, on) {
            (Power::On(firmware), false) => {
                self.power = Power::Off {
                    stored: firmware.id(),
                };
            }
            (Power::Off { stored }, true) => {
                let firmware = Firmware::power_up(*stored, &self.config, self.wheel.turns());
                self.power = Power::On(Box::new(firmware));
            }
            _ => {}
        }
    }

    /// Suppresses its replies, like a broken transmitter; it still receives and obeys.
    pub const fn mute(&mut self, muted: bool) {
        self.muted = muted;
    }

    /// Sets the temperature of the winding.
    pub fn set_temperature_c(&mut self, celsius: f32) {
        self.heat.set_winding_c(f64::from(celsius));
    }

    /// Sets the ambient temperature, which the winding approaches within minutes.
    pub fn set_ambient_c(&mut self, celsius: f32) {
        self.heat.set_ambient_c(f64::from(celsius));
    }

    /// A defect that draws this extra current while the power stage works: in a phase and from the
    /// supply. A healthy motor limits itself to 2.7 A and never trips an overcurrent protection.
    pub fn set_leak_a(&mut self, phase_a: f32, bus_a: f32) {
        self.leak = Leak {
            phase_a: f64::from(phase_a),
            bus_a: f64::from(bus_a),
        };
    }

    /// Breaks or repairs the encoder. Only the fault byte shows it; the angle stays right.
    pub const fn break_encoder(&mut self, broken: bool) {
        self.encoder_broken = broken;
    }
}
