//! The arc of the temperature card, 0 to 100 degrees Celsius.

use motorlink_i18n::tr;
use motorlink_messages::protocol::Celsius;

use crate::model::heat::Band;

impl Band {
    /// The advice, in lines, with the limit of Settings.
    pub(crate) fn words(self, limit_c: u16) -> String {
        let limit = tr!("limit {limit_c} °C", limit_c);
        match self {
            Self::Normal => limit,
            Self::Warm => [tr!("warm"), &limit].join("\n"),
            Self::Hot => [tr!("too hot"), &limit].join("\n"),
        }
    }
}

/// The filled part as a dash of an arc with length 100. Hotter values end at the end of the arc; unknown ones are
/// empty.
pub(crate) fn fill(temperature: Option<Celsius>) -> String {
    let degrees = temperature.map_or(0, Celsius::degrees);
    format!("{} 999", degrees.min(100))
}

/// Three quarters of a circle about the origin, open at the bottom, with the bands in the outer ring.
pub(crate) const MARKUP: &str = concat!(
    r#"<svg class="gauge" viewBox="-50 -46 100 84">"#,
    r#"<path class="gauge-track" d="M-28.3 28.3A40 40 0 1 1 28.3 28.3"/>"#,
    r#"<path class="gauge-fill" pathLength="100" stroke-dasharray="0 999" d="M-28.3 28.3A40 40 0 1 1 28.3 28.3"/>"#,
    r#"<path class="gauge-zone warm" pathLength="100" stroke-dasharray="10 999" stroke-dashoffset="-70" d="M-23 23A32.5 32.5 0 1 1 23 23"/>"#,
    r#"<path class="gauge-zone hot" pathLength="100" stroke-dasharray="20 999" stroke-dashoffset="-80" d="M-23 23A32.5 32.5 0 1 1 23 23"/>"#,
    r#"<text x="-28" y="38">0</text><text x="28" y="38">100</text>"#,
    "</svg>",
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::heat::{HOT_FROM, WARM_FROM};

    #[test]
    fn amber_begins_at_70_and_red_at_80() {
        for (degrees, band) in [
            (0, Band::Normal),
            (69, Band::Normal),
            (70, Band::Warm),
            (79, Band::Warm),
            (80, Band::Hot),
            (255, Band::Hot),
        ] {
            assert_eq!(Band::of(Celsius::new(degrees)), band, "{degrees}");
        }
    }

    #[test]
    fn each_band_says_what_it_is_in_words() {
        assert_eq!(Band::Normal.words(75), "limit 75 °C");
        assert_eq!(Band::Warm.words(60), "warm\nlimit 60 °C");
        assert!(Band::Hot.words(75).contains("too hot"));
    }

    #[test]
    fn the_arc_ends_at_100() {
        assert_eq!(fill(Some(Celsius::new(33))), "33 999");
        assert_eq!(fill(Some(Celsius::new(180))), "100 999");
    }

    #[test]
    fn an_unknown_temperature_fills_nothing() {
        assert_eq!(fill(None), "0 999");
    }

    /// Their lengths are those of the arc, in degrees Celsius.
    #[test]
    fn the_bands_of_the_picture_are_those_of_the_words() {
        let warm = format!(
            r#""{} 999" stroke-dashoffset="-{WARM_FROM}""#,
            HOT_FROM - WARM_FROM
        );
        let hot = format!(
            r#""{} 999" stroke-dashoffset="-{HOT_FROM}""#,
            100 - HOT_FROM
        );
        assert!(MARKUP.contains(&warm) && MARKUP.contains(&hot));
    }
}
