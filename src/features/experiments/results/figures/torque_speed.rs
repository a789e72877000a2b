//! The figures of torque and speed.

use motorlink_i18n::tr;
use motorlink_messages::experiments::study::TorqueSpeedFindings;

use super::Figures;
use crate::ui::format::rpm;

pub(super) fn add(figures: &mut Figures, found: &TorqueSpeedFindings) {
    let line = found.line;
    let no_load = line.map(|it| it.no_load_rpm);
    figures.estimate(tr!("No-load speed"), no_load, 1.0, rpm());
    let unit = format!("{}/N·m", rpm());
    let droop = line.and_then(|it| it.droop).map(|it| it.rpm_per_nm);
    figures.estimate(tr!("Speed drop per torque"), droop, 1.0, &unit);
    figures.says(tr!(
        "How much slower the wheel turns under load at the voltage limit: the set speed must be above the one that it reaches. The reported current includes a part without torque, so the figures follow from how its square grows as the speed falls."
    ));
    figures.intervals();
    figures.maker_says(tr!(
        "Maker: 200 ± 10 rpm without load at 18 V, 0.96 N·m at 115 rpm, 2.0 N·m at a stall."
    ));
}
