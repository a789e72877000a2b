//! The figures of a frequency response.

use motorlink_i18n::tr;
use motorlink_messages::experiments::study::FrequencyFindings;

use super::{Figures, model, number, texts};

pub(super) fn add(figures: &mut Figures, found: &FrequencyFindings) {
    let valid = || found.points.iter().filter(|point| point.invalid.is_none());
    let bandwidth = found.bandwidth_hz.map_or_else(
        || tr!("not measurable").to_owned(),
        |hz| format!("{} Hz", number(hz, 2)),
    );
    figures.row(tr!("Bandwidth (\u{2212}3 dB)"), vec![Some(bandwidth)]);
    let count = format!("{} / {}", valid().count(), found.points.len());
    figures.row(tr!("Valid points"), vec![Some(count)]);
    model::add(figures, &[found.model], None);
    for point in &found.points {
        if let Some(why) = point.invalid {
            figures.says(tr!(
                "{hz} Hz is not valid: {why}",
                hz = number(point.hz, 2),
                why = texts::invalid(why)
            ));
        }
    }
    if let Some(first) = valid().find(|point| !point.turn_is_known) {
        figures.says(tr!(
            "From {hz} Hz on the turn of the phase is unknown: it may lag by 360° more, or a multiple of that. Choose more points, or a lower first frequency.",
            hz = number(first.hz, 2)
        ));
    }
    figures.left_out(found.left_out);
    figures.says(tr!(
        "How well the velocity loop follows a sine: 0 dB is the full amplitude, and a phase below 0° is a delay. Crosses mark points that are not valid."
    ));
}

#[cfg(test)]
mod tests {
    use motorlink_messages::experiments::{
        analysis::{BodePoint, Invalid},
        study::Findings,
    };

    use super::*;

    #[test]
    fn an_invalid_point_is_named_with_its_reason() {
        let found = Findings::Frequency(FrequencyFindings {
            points: vec![BodePoint {
                hz: 12.6,
                gain_db: 0.0,
                phase_deg: 0.0,
                turn_is_known: true,
                r_squared: 0.1,
                from_s: 0.0,
                to_s: 6.0,
                invalid: Some(Invalid::TooSmall),
            }],
            bandwidth_hz: None,
            model: None,
            left_out: 0,
        });
        let figures = Figures::of(&found, "DDSM115");
        assert!(figures.meaning[0].starts_with("12.60 Hz is not valid"));
        assert_eq!(figures.rows[1].values, ["0 / 1"]);
    }
}
