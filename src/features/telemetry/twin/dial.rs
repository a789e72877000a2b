//! The ring around the wheel: speed as an arc, the scale beside it, and the pointers of the goal.

use motorlink_i18n::tr;

use crate::features::telemetry::twin::{
    geometry::{arc, circle, polar, spokes},
    markup::Markup,
    measures,
    scale::{END_DEG, SpeedScale},
};

/// Distance of the short ticks, in rpm.
const TICK_RPM: u16 = 10;
/// Distance of the long ticks, which have labels.
const FIGURE_RPM: u16 = 100;

/// The ring with its scale, drawn under the wheel.
pub fn ring(art: &mut Markup, scale: SpeedScale) {
    art.path("twin-track", arc(measures::RING, -END_DEG, END_DEG));
    let ticks = |step: u16, end: f64| {
        spokes(
            marks(step, scale)
                .into_iter()
                .map(|rpm| scale.bearing_deg(rpm)),
            measures::TICKS,
            end,
        )
    };
    art.path("twin-tick", ticks(TICK_RPM, measures::TICKS_SHORT));
    art.path("twin-tick-long", ticks(FIGURE_RPM, measures::TICKS_LONG));
    art.path(
        "twin-tick-long",
        spokes(
            [-END_DEG, END_DEG].into_iter(),
            measures::TICKS,
            measures::TICKS_LONG,
        ),
    );
    art.group("twin-scale", |art| {
        for rpm in marks(FIGURE_RPM, scale) {
            art.text(
                "twin-figure",
                polar(scale.bearing_deg(rpm), measures::FIGURES),
                &signed(rpm),
            );
        }
        // Below the ends, outside of the range of the pointers.
        art.text(
            "twin-way",
            polar(-END_DEG - 8.0, measures::FIGURES),
            tr!("CCW"),
        );
        art.text(
            "twin-way",
            polar(END_DEG + 8.0, measures::FIGURES),
            tr!("CW"),
        );
    });
}

/// The moving parts of the ring, drawn over the wheel.
pub fn needles(art: &mut Markup, scale: SpeedScale) {
    // From the negative to the positive end, measured in rpm, so that a speed is a dash on it.
    art.measured_path(
        "twin-speed",
        2.0 * scale.limit_rpm,
        arc(measures::RING, END_DEG, -END_DEG),
    );
    art.path("twin-knob", circle(0.0, measures::RING, 2.1));
    art.path(
        "twin-goal-speed",
        "M-2.4 -63.6H2.4V-61.8L0 -58.7L-2.4 -61.8Z",
    );
    art.path("twin-goal-angle", "M-2.4 -55.1H2.4L0 -51.4Z");
}

/// The speeds of the scale's marks: both directions and zero.
fn marks(step_rpm: u16, scale: SpeedScale) -> Vec<f64> {
    let reach = (1..)
        .map(|place: u16| f64::from(place * step_rpm))
        .take_while(|rpm| *rpm <= scale.limit_rpm);
    let mut speeds = vec![0.0];
    for rpm in reach {
        speeds.extend([rpm, -rpm]);
    }
    speeds
}

/// A speed as a label of the scale.
fn signed(rpm: f64) -> String {
    match rpm {
        0.0 => "0".to_owned(),
        rpm if rpm < 0.0 => format!("\u{2212}{}", -rpm),
        rpm => format!("+{rpm}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_has_zero_and_both_sides() {
        for (limit_rpm, long, short) in [(330.0, 7, 67), (210.0, 5, 43), (380.0, 7, 77)] {
            let scale = SpeedScale { limit_rpm };
            assert_eq!(marks(100, scale).len(), long);
            assert_eq!(marks(10, scale).len(), short);
            let all = marks(100, scale);
            assert!(all.iter().all(|rpm| rpm.abs() <= limit_rpm));
        }
    }

    #[test]
    fn figures_carry_a_sign_and_a_real_minus() {
        let said: Vec<_> = [0.0, 100.0, -330.0].into_iter().map(signed).collect();
        assert_eq!(said, ["0", "+100", "\u{2212}330"]);
    }
}
