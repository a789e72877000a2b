//! The colours of the style sheet as numbers: a canvas does not resolve custom properties.

use crate::features::graph::plot::comparison::MOTORS_MAX;

/// A colour: red, green, blue.
pub(crate) type Colour = (u8, u8, u8);

/// The colours of one theme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) struct Palette {
    pub(crate) surface: Colour,
    pub(crate) line: Colour,
    pub(crate) text: Colour,
    pub(crate) speed: Colour,
    pub(crate) current: Colour,
    pub(crate) temperature: Colour,
    pub(crate) position: Colour,
    /// Colours of compared motors, by their place.
    pub(crate) motors: [Colour; MOTORS_MAX],
}

/// Parses a computed colour: `rgb(11, 100, 189)`, or `rgba(11, 100, 189, 0.5)` if it is transparent. Anything else
/// gives a grey that is visible on light and dark.
pub(crate) fn parse_colour(computed: &str) -> Colour {
    let numbers = computed
        .strip_prefix("rgb")
        .and_then(|rest| rest.trim_start_matches('a').strip_prefix('('));
    let mut parts = numbers.unwrap_or_default().split(',');
    let mut part = || parts.next().and_then(|part| byte(part.trim_ascii()));
    match (part(), part(), part()) {
        (Some(red), Some(green), Some(blue)) => (red, green, blue),
        _ => (128, 128, 128),
    }
}

fn byte(text: &str) -> Option<u8> {
    text.trim_end_matches(')').parse().ok()
}

/// The colour as a CSS value: `rgb(11,100,189)`.
pub(crate) fn css((red, green, blue): Colour) -> String {
    format!("rgb({red},{green},{blue})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_computed_colour_is_read() {
        assert_eq!(parse_colour("rgb(11, 100, 189)"), (11, 100, 189));
        assert_eq!(parse_colour("rgba(11, 100, 189, 0.5)"), (11, 100, 189));
        assert_eq!(parse_colour(&css((1, 2, 255))), (1, 2, 255));
        for odd in [
            "",
            "red",
            "color(srgb 1 0 0)",
            "rgb(1, 2)",
            "rgb(1, 2, 999)",
        ] {
            assert_eq!(parse_colour(odd), (128, 128, 128), "{odd}");
        }
    }
}
