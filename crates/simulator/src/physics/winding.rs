//! Current in the windings, and what the supply and the speed allow of it.

use crate::figures::Figures;

/// From this speed on the whole of it (10 rpm).
const FIELD_FROM_RAD_S: f64 = 1.05;

/// What the firmware does with the power stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Bridge {
    /// All switches off: the wheel coasts.
    Open,
    /// Windings shorted for part of the time: the electric brake.
    Short,
    /// This torque current, if voltage allows.
    Drive {
        /// Wanted torque current.
        amps: f64,
    },
}

/// A defect that draws current without giving torque, so that protections can be tried.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Leak {
    pub(crate) phase_a: f64,
    pub(crate) bus_a: f64,
}

/// What flows during one step.
#[allow(
    clippy::struct_field_names,
    reason = "the postfix is the unit, which every name ends with"
)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Flow {
    /// Torque current, signed.
    pub(crate) torque_a: f64,
    /// Torque current as the motor reports it, without noise.
    pub(crate) reported_a: f64,
    /// In a phase, without sign.
    pub(crate) phase_a: f64,
    /// From the supply, never negative: what the motor gives back stays in its capacitors.
    pub(crate) bus_a: f64,
}

impl Flow {
    pub(crate) const fn torque_nm(self, figures: &Figures) -> f64 {
        self.torque_a * figures.torque_nm_per_a
    }

    /// Heat in the windings.
    pub(crate) const fn loss_w(self, figures: &Figures) -> f64 {
        self.phase_a * self.phase_a * figures.resistance_ohm
    }
}

/// The windings on their supply.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Winding {
    figures: &'static Figures,
    supply_v: f64,
}

impl Winding {
    pub(crate) const fn on(supply_v: f64, figures: &'static Figures) -> Self {
        Self { figures, supply_v }
    }

    /// What flows with this share of the supply on the windings, -1 to 1.
    pub(crate) fn amps_at(self, share: f64, speed_rad_s: f64) -> f64 {
        let back_emf_v = speed_rad_s * self.figures.back_emf_v_s;
        (share * self.supply_v - back_emf_v) / self.figures.resistance_ohm
    }

    /// Least and greatest torque current at this speed: by voltage less back-EMF, and by the
    /// firmware's limit.
    pub(crate) fn range_a(self, speed_rad_s: f64) -> (f64, f64) {
        let Figures {
            back_emf_v_s,
            resistance_ohm,
            current_limit_a,
            ..
        } = *self.figures;
        let back_emf_v = speed_rad_s * back_emf_v_s;
        let least = ((-self.supply_v - back_emf_v) / resistance_ohm).max(-current_limit_a);
        let greatest = ((self.supply_v - back_emf_v) / resistance_ohm).min(current_limit_a);
        (least.min(current_limit_a), greatest.max(-current_limit_a))
    }

    /// What flows at this speed.
    pub(crate) fn flow(self, bridge: Bridge, speed_rad_s: f64, leak: Leak) -> Flow {
        let Figures {
            back_emf_v_s,
            resistance_ohm,
            brake_duty,
            field_a,
            ..
        } = *self.figures;
        let torque_a = match bridge {
            Bridge::Open => return Flow::default(),
            Bridge::Short => -brake_duty * speed_rad_s * back_emf_v_s / resistance_ohm,
            Bridge::Drive { amps } => {
                let (least, greatest) = self.range_a(speed_rad_s);
                amps.max(least).min(greatest)
            }
        };
        let power_w = match bridge {
            Bridge::Drive { .. } => {
                torque_a * (torque_a * resistance_ohm + speed_rad_s * back_emf_v_s)
            }
            Bridge::Open | Bridge::Short => 0.0,
        };
        Flow {
            torque_a,
            reported_a: torque_a + field_share(bridge, torque_a, speed_rad_s, field_a),
            phase_a: torque_a.abs() + leak.phase_a,
            bus_a: (power_w / self.supply_v).max(0.0) + leak.bus_a,
        }
    }
}

/// What field current adds to the report: all of it at no load, next to nothing at rated current.
fn field_share(bridge: Bridge, torque_a: f64, speed_rad_s: f64, field_a: f64) -> f64 {
    if !matches!(bridge, Bridge::Drive { .. }) || speed_rad_s == 0.0 {
        return 0.0;
    }
    let field_a = field_a * (speed_rad_s.abs() / FIELD_FROM_RAD_S).min(1.0);
    let total_a = (torque_a * torque_a + field_a * field_a).sqrt();
    (total_a - torque_a.abs()) * speed_rad_s.signum()
}
