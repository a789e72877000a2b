//! How well each motor followed a sequence.

use motorlink_i18n::tr;
use motorlink_messages::experiments::{analysis::Tracking, study::MotorFindings};

use super::{Figures, number};
use crate::features::experiments::texts::unit;

pub(super) fn add(figures: &mut Figures, found: &[MotorFindings]) {
    let of = |value: fn(&Tracking, &str) -> String| {
        let text = |motor: &MotorFindings| {
            let tracking = motor.tracking.as_ref()?;
            Some(value(tracking, unit(tracking.quantity)))
        };
        found.iter().map(text).collect()
    };
    figures.columns = found.iter().map(|it| it.motor.get().to_string()).collect();
    let rms = of(|it, unit| format!("{} {unit}", number(it.rms, 2)));
    figures.row(tr!("Tracking error, RMS"), rms);
    let worst = of(|it, unit| {
        let (worst, at_s) = (number(it.worst, 2), number(it.worst_s, 2));
        tr!("{worst} {unit} at {at_s} s", worst, unit, at_s)
    });
    figures.row(tr!("Tracking error, worst"), worst);
    figures.says(tr!(
        "Setpoint less reported value at the same time, over all replies with a setpoint. A step counts in full until the motor has followed, and so does a pause."
    ));
}
