//! The figures of the friction.

use motorlink_i18n::tr;
use motorlink_messages::experiments::study::FrictionFindings;

use super::Figures;
use crate::ui::format::rpm;

pub(super) fn add(figures: &mut Figures, found: &FrictionFindings) {
    let fit = found.friction;
    figures.estimate(tr!("Coulomb part"), fit.map(|it| it.coulomb_a), 1.0, "A");
    let unit = format!("mA/{}", rpm());
    let viscous = fit.map(|it| it.viscous_a_per_rpm);
    figures.estimate(tr!("Viscous part"), viscous, 1e3, &unit);
    figures.left_out(found.left_out);
    figures.says(tr!(
        "The current that the motor reports at an even speed: a part that does not depend on the speed, and one that grows with it. It is more than friction; the coast-down measures that."
    ));
    figures.intervals();
    figures.maker_says(tr!("Maker: at most 0.25 A without load."));
}
