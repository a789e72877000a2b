//! Speed against torque at the voltage limit.

use super::{
    TORQUE_NM_PER_A,
    batch_means::{Reply, estimates, solve},
    statistics::Estimate,
};

/// Slower than this part of the speed without load, a motor may limit its current.
const SLOWEST: f64 = 0.25;
/// A droop that is less certain than this is not measurable: the interval of its square ends below half of it.
const CERTAIN: f64 = 0.5;

/// No reported current is taken for less, in A: a fit may fall below zero.
const AMPS_MIN: f64 = 0.03;

/// Speed at the voltage limit, by load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueSpeed {
    /// The speed of the free wheel, in rpm.
    pub no_load_rpm: Estimate,
    /// How it falls with torque; `None` if the replies cannot tell.
    pub droop: Option<Droop>,
}

/// The decrease of speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Droop {
    /// The decrease in rpm per N.m.
    pub rpm_per_nm: Estimate,
    /// The reported current.
    pub current: CurrentBySpeed,
}

/// The mean square of the reported current, as a quadratic in the decrease of speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentBySpeed {
    /// The speed without load, in rpm.
    from_rpm: f64,
    /// The coefficients, from the constant one on.
    amps_squared: [f64; 3],
}

impl CurrentBySpeed {
    /// The root mean square of the current at this speed, in A.
    #[must_use]
    pub fn amps_at(&self, rpm: f64) -> f64 {
        let [even, linear, square] = self.amps_squared;
        let lost = self.from_rpm - rpm;
        (even + lost * (linear + lost * square)).max(0.0).sqrt()
    }
}

/// Fits replies `(rpm, amps)` at the voltage limit, in one direction: those of a `free` wheel, and `all` of them.
///
/// At the limit the torque current is `(no_load - speed) / (droop * torque constant)`. A motor reports more: a current
/// that turns no wheel, at an unknown angle to it, and noise. So the mean square of the report is a quadratic in the
/// speed, and its highest coefficient is `1 / (droop * torque constant)^2`, whatever the angle and the noise are. The
/// speed has no noise but that of its rounding: the current is fitted by the speed, not the speed by the current. `None`
/// without enough replies.
#[must_use]
pub fn torque_speed(free: &[(f64, f64)], all: &[(f64, f64)]) -> Option<TorqueSpeed> {
    let free: Vec<Reply<1>> = free
        .iter()
        .map(|(rpm, _)| Reply {
            row: [1.0],
            y: rpm.abs(),
            report: rpm.abs(),
        })
        .collect();
    let [no_load_rpm] = estimates(&free, &solve(&free)?, |_| 1.0)?;
    Some(TorqueSpeed {
        no_load_rpm,
        droop: droop(no_load_rpm.value, all),
    })
}

fn droop(from_rpm: f64, replies: &[(f64, f64)]) -> Option<Droop> {
    let turning = || {
        let fast = |(rpm, _): &&(f64, f64)| rpm.abs() >= SLOWEST * from_rpm;
        replies.iter().filter(fast)
    };
    let rows = |weight: &dyn Fn(f64) -> f64| {
        let row = |(rpm, amps): &(f64, f64)| {
            let lost = from_rpm - rpm.abs();
            let weight = weight(rpm.abs());
            Reply {
                row: [weight, weight * lost, weight * lost * lost],
                y: weight * amps * amps,
                report: rpm.abs(),
            }
        };
        turning().map(row).collect::<Vec<Reply<3>>>()
    };
    let current = |amps_squared| CurrentBySpeed {
        from_rpm,
        amps_squared,
    };
    // The noise of a square grows with the current. A first fit gives the current.
    let first = current(solve(&rows(&|_| 1.0))?.unknowns);
    let rows = rows(&|rpm| 1.0 / first.amps_at(rpm).max(AMPS_MIN));
    let fit = solve(&rows)?;
    let [_, linear, square] = fit.unknowns;
    let slope = |reply: &Reply<3>| linear * reply.row[0] + 2.0 * square * reply.row[1];
    let [.., curve] = estimates(&rows, &fit, slope)?;
    let least = curve.value - curve.plus_minus;
    if least <= CERTAIN * curve.value {
        return None;
    }
    let of = |curve: f64| 1.0 / (TORQUE_NM_PER_A * curve.sqrt());
    Some(Droop {
        rpm_per_nm: Estimate {
            value: of(curve.value),
            // The longer side of an interval that is not symmetric.
            plus_minus: of(least) - of(curve.value),
        },
        current: current(fit.unknowns),
    })
}
