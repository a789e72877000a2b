//! The figures of a coast-down.

use motorlink_i18n::tr;
use motorlink_messages::experiments::study::CoastDownFindings;

use super::Figures;

pub(super) fn add(figures: &mut Figures, found: &CoastDownFindings) {
    let (fit, coast) = (found.inertia, found.coast);
    let inertia = fit.map(|it| it.inertia_kg_m2);
    figures.estimate(tr!("Inertia"), inertia, 1e3, "g·m²");
    figures.estimate(tr!("Dry friction"), fit.map(|it| it.dry_nm), 1e3, "mN·m");
    let viscous = fit.map(|it| it.viscous_nm_s);
    figures.estimate(tr!("Viscous friction"), viscous, 1e3, "mN·m·s");
    let dry = coast.map(|it| it.dry_rad_s2);
    figures.estimate(tr!("Friction over inertia"), dry, 1.0, "rad/s²");
    figures.says(tr!(
        "Inertia from pushes by a known current, friction from how the wheel slows down at 0 A."
    ));
    figures.intervals();
    figures.maker_says(tr!(
        "Maker: 0.75 N·m/A, which gives the torque of a push; a wheel of 102 mm and 485 g."
    ));
}
