//! The figures of the heating.

use motorlink_i18n::tr;
use motorlink_messages::experiments::study::HeatingFindings;

use super::{Figures, number};

pub(super) fn add(figures: &mut Figures, found: &HeatingFindings) {
    let fit = found.heating;
    let constant = fit.map(|it| it.time_constant_s);
    figures.estimate(tr!("Time constant"), constant, 1.0, "s");
    figures.estimate(
        tr!("Final temperature"),
        fit.map(|it| it.final_c),
        1.0,
        "°C",
    );
    let amps = found.amps.map(|amps| format!("{} A", number(amps, 2)));
    figures.row(tr!("Mean current"), vec![amps]);
    figures.says(tr!(
        "After one time constant the winding has 63 % of its rise. The final temperature is where it ends at this current."
    ));
    figures.intervals();
    figures.maker_says(tr!(
        "Maker: the motor protects itself at 80 °C, until it has cooled to 75 °C."
    ));
}
