//! The figures of each model that its physics and firmware run with.
//!
//! Of the DDSM115 they are published or measured. Of the others little is: the speed without load, and
//! here and there a current. All else is **assumed** to be as in a DDSM115, and marked so below.

use motorlink_protocol::family::Model;

/// Torque of a DDSM115 per ampere (published).
const DDSM115_TORQUE_NM_PER_A: f64 = 0.75;
/// Speed of a DDSM115 without load in rpm (published).
const DDSM115_NO_LOAD_RPM: f64 = 200.0;

/// What differs between the virtual motors of two models.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Figures {
    /// Torque per ampere.
    pub(crate) torque_nm_per_a: f64,
    /// Back-EMF per rad/s. Of a DDSM115 the published 11.1 rpm/V turned round.
    pub(crate) back_emf_v_s: f64,
    /// Resistance that lets 1.25 A flow in a DDSM115 at 115 rpm and 18 V, its rated point:
    /// (18 - 0.86 x 12.04) / 1.25.
    pub(crate) resistance_ohm: f64,
    /// The firmware's own limit: the published stall current of a DDSM115.
    pub(crate) current_limit_a: f64,
    /// Share of the time that the brake shorts the windings. A full short would stop a DDSM115 from
    /// 120 rpm in 50 ms; measured are 250 ms.
    pub(crate) brake_duty: f64,
    /// Current that a turning motor reports beyond what its torque needs. Captures of a DDSM115 show
    /// 0.24 A on average at +100 rpm without load, yet the free wheel coasts for seconds, so it cannot
    /// be friction: it is taken for field current, which adds at a right angle to torque current.
    pub(crate) field_a: f64,
    /// Gains of the loops in amperes are those of a DDSM115 times this, so that a wheel with less torque
    /// per ampere follows as fast.
    pub(crate) gain: f64,
}

const DDSM115: Figures = Figures {
    torque_nm_per_a: DDSM115_TORQUE_NM_PER_A,
    back_emf_v_s: 0.860,
    resistance_ohm: 6.1,
    current_limit_a: 2.7,
    brake_duty: 0.181,
    field_a: 0.235,
    gain: 1.0,
};

/// **Assumed**: all. No speed without load is published; the greatest command stands for it.
const DDSM315: Figures = DDSM115.wound_for(315.0);

/// **Assumed**: all but the speed and the current without load (0.15 A).
const DDSM210: Figures = Figures {
    field_a: 0.15,
    ..DDSM115.wound_for(210.0)
};

/// **Assumed**: all but the speed without load.
const DDSM400: Figures = DDSM115.wound_for(400.0);

impl Figures {
    pub(crate) const fn of(model: Model) -> &'static Self {
        match model {
            Model::Ddsm115 => &DDSM115,
            Model::Ddsm315 => &DDSM315,
            Model::Ddsm210 => &DDSM210,
            Model::Ddsm400 => &DDSM400,
        }
    }

    /// The same motor with windings that let it turn at this many rpm without load at 18 V: torque per
    /// ampere and back-EMF go together. The brake is assumed to be as strong.
    const fn wound_for(self, no_load_rpm: f64) -> Self {
        let ratio = DDSM115_NO_LOAD_RPM / no_load_rpm;
        let duty = self.brake_duty / (ratio * ratio);
        Self {
            torque_nm_per_a: self.torque_nm_per_a * ratio,
            back_emf_v_s: self.back_emf_v_s * ratio,
            brake_duty: if duty > 1.0 { 1.0 } else { duty },
            gain: self.gain / ratio,
            ..self
        }
    }
}
