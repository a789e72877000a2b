//! Current in the windings, and what the supply and the speed allow of it.

/// Torque per ampere (published: 0.75).
pub(crate) const TORQUE_NM_PER_A: f64 = 0.75;
/// Back-EMF per rad/s: the published 11.1 rpm/V turned round.
const BACK_EMF_V_S: f64 = 0.860;
/// Resistance that lets 1.25 A flow at 115 rpm and 18 V, the rated point: (18 - 0.86 x 12.04) / 1.25.
const RESISTANCE_OHM: f64 = 6.1;
/// The firmware's own limit: the published stall current.
pub(crate) const CURRENT_LIMIT_A: f64 = 2.7;
/// Share of the time that the brake shorts the windings. A full short would stop the wheel from
/// 120 rpm in 50 ms; measured are 250 ms.
const BRAKE_DUTY: f64 = 0.181;
/// Current that a turning motor reports beyond what its torque needs. Captures show 0.24 A on average
/// at +100 rpm without load, yet the free wheel coasts for seconds, so it cannot be friction: it is
/// taken for field current, which adds at a right angle to torque current.
const FIELD_A: f64 = 0.235;
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
    pub(crate) const fn torque_nm(self) -> f64 {
        self.torque_a * TORQUE_NM_PER_A
    }

    /// Heat in the windings.
    pub(crate) const fn loss_w(self) -> f64 {
        self.phase_a * self.phase_a * RESISTANCE_OHM
    }
}

/// The windings on their supply.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Winding {
    supply_v: f64,
}

impl Winding {
    pub(crate) const fn on(supply_v: f64) -> Self {
        Self { supply_v }
    }

    /// Least and greatest torque current at this speed: by voltage less back-EMF, and by the
    /// firmware's limit.
    pub(crate) fn range_a(self, speed_rad_s: f64) -> (f64, f64) {
        let back_emf_v = speed_rad_s * BACK_EMF_V_S;
        let least = ((-self.supply_v - back_emf_v) / RESISTANCE_OHM).max(-CURRENT_LIMIT_A);
        let greatest = ((self.supply_v - back_emf_v) / RESISTANCE_OHM).min(CURRENT_LIMIT_A);
        (least.min(CURRENT_LIMIT_A), greatest.max(-CURRENT_LIMIT_A))
    }

    /// What flows at this speed.
    pub(crate) fn flow(self, bridge: Bridge, speed_rad_s: f64, leak: Leak) -> Flow {
        let torque_a = match bridge {
            Bridge::Open => return Flow::default(),
            Bridge::Short => -BRAKE_DUTY * speed_rad_s * BACK_EMF_V_S / RESISTANCE_OHM,
            Bridge::Drive { amps } => {
                let (least, greatest) = self.range_a(speed_rad_s);
                amps.max(least).min(greatest)
            }
        };
        let power_w = match bridge {
            Bridge::Drive { .. } => {
                torque_a * (torque_a * RESISTANCE_OHM + speed_rad_s * BACK_EMF_V_S)
            }
            Bridge::Open | Bridge::Short => 0.0,
        };
        Flow {
            torque_a,
            reported_a: torque_a + field_share(bridge, torque_a, speed_rad_s),
            phase_a: torque_a.abs() + leak.phase_a,
            bus_a: (power_w / self.supply_v).max(0.0) + leak.bus_a,
        }
    }
}

/// What field current adds to the report: all of it at no load, next to nothing at rated current.
fn field_share(bridge: Bridge, torque_a: f64, speed_rad_s: f64) -> f64 {
    if !matches!(bridge, Bridge::Drive { .. }) || speed_rad_s == 0.0 {
        return 0.0;
    }
    let field_a = FIELD_A * (speed_rad_s.abs() / FIELD_FROM_RAD_S).min(1.0);
    let total_a = (torque_a * torque_a + field_a * field_a).sqrt();
    (total_a - torque_a.abs()) * speed_rad_s.signum()
}
