//! What turns.

use std::f64::consts::TAU;

use super::units::STEP_S;

/// Moment of inertia in kg.m2. The wheel has 485 g and 102 mm: a disc of that would have 0.63e-3, a
/// ring 1.26e-3, and an outer rotor with a tyre lies towards the ring.
pub(crate) const INERTIA_KG_M2: f64 = 1.0e-3;
/// Dry friction of the bearings. With [`VISCOUS_NM_S`] it lets the free wheel run for 8 s from
/// 120 rpm; "more than 6 s" is published.
pub(crate) const DRY_FRICTION_NM: f64 = 1.0e-3;
/// Friction that grows with speed.
pub(crate) const VISCOUS_NM_S: f64 = 1.0e-4;

/// Torques on the wheel during one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    /// Torque that does not ask for the direction of motion.
    pub(crate) torque_nm: f64,
    /// Torque that opposes motion, and holds a standing wheel against as much.
    pub(crate) dry_nm: f64,
    /// Torque that opposes motion, per rad/s.
    pub(crate) viscous_nm_s: f64,
}

/// The wheel: positive speed is positive on the wire, which makes the *reported* angle fall.
#[derive(Clone, Debug)]
pub(crate) struct Wheel {
    speed_rad_s: f64,
    turns: f64,
    blocked: bool,
}

impl Wheel {
    pub(crate) const fn at(turns: f64) -> Self {
        Self {
            speed_rad_s: 0.0,
            turns,
            blocked: false,
        }
    }

    pub(crate) const fn speed_rad_s(&self) -> f64 {
        self.speed_rad_s
    }

    /// Turns since the start, in the direction of positive speed.
    pub(crate) const fn turns(&self) -> f64 {
        self.turns
    }

    pub(crate) fn stands(&self) -> bool {
        self.speed_rad_s == 0.0
    }

    /// How far it would run without any torque but friction.
    pub(crate) fn coasting_turns(&self) -> f64 {
        let speed = self.speed_rad_s.abs();
        // From J dw/dt = -(dry + viscous w), with w dw/dt over the angle.
        let dry_rad_s = DRY_FRICTION_NM / VISCOUS_NM_S;
        let run_rad =
            (speed - dry_rad_s * (speed / dry_rad_s).ln_1p()) * INERTIA_KG_M2 / VISCOUS_NM_S;
        run_rad / TAU
    }

    /// Something solid in the spokes, or not.
    pub(crate) const fn block(&mut self, blocked: bool) {
        self.blocked = blocked;
        if blocked {
            self.speed_rad_s = 0.0;
        }
    }

    /// One step. Dry friction never pushes: at most it brings the wheel to exactly 0.
    pub(crate) fn step(&mut self, push: Push) {
        if self.blocked {
            return;
        }
        let per_nm = STEP_S / INERTIA_KG_M2;
        let free =
            (self.speed_rad_s + push.torque_nm * per_nm) / (1.0 + push.viscous_nm_s * per_nm);
        let lost = push.dry_nm * per_nm;
        self.speed_rad_s = if free.abs() <= lost {
            0.0
        } else {
            free - lost * free.signum()
        };
        self.turns += self.speed_rad_s * STEP_S / TAU;
    }
}
