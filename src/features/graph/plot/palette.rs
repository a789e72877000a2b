//! The colours of the style sheet as numbers: a canvas does not resolve custom properties.

use crate::features::graph::plot::{comparison::MOTORS_MAX, trace::Trace};

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

impl Palette {
    /// The colours of the light theme, whatever theme the page has. A test compares them with the style sheets.
    pub(crate) const LIGHT: Self = Self {
        surface: (0xff, 0xff, 0xff),
        line: (0xe2, 0xe6, 0xeb),
        text: (0x5a, 0x64, 0x74),
        speed: (0x0b, 0x64, 0xbd),
        current: (0x0a, 0x7a, 0x46),
        temperature: (0xa8, 0x4c, 0x06),
        position: (0x67, 0x41, 0xc9),
        motors: [
            (0x0b, 0x64, 0xbd),
            (0xa8, 0x4c, 0x06),
            (0x0a, 0x7a, 0x46),
            (0xa3, 0x20, 0x6e),
            (0x67, 0x41, 0xc9),
            (0x7a, 0x63, 0x00),
            (0x08, 0x72, 0x7f),
            (0x5a, 0x64, 0x74),
        ],
    };

    /// The colour of a trace of one motor. The goal has its own, whatever its quantity.
    pub(crate) const fn of(self, trace: Trace) -> Colour {
        match trace {
            Trace::Speed => self.speed,
            Trace::Current => self.current,
            Trace::Goal => self.text,
            Trace::Temperature => self.temperature,
            Trace::Position => self.position,
        }
    }
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

    const TOKENS: &str = include_str!("../../../../style/10-tokens.css");
    const GRAPH: &str = include_str!("../../../../style/later/61-graph.css");

    /// The light colour behind this text of a style sheet.
    fn light(sheet: &str, declaration: &str) -> Colour {
        let (_, rest) = sheet.split_once(declaration).unwrap();
        let value = rest.split(';').next().unwrap().trim();
        if let Some(token) = value.strip_prefix("var(") {
            let token = token.split(')').next().unwrap();
            return light(TOKENS, &format!("  {token}: "));
        }
        let digits = value.strip_prefix("light-dark(#").unwrap();
        let byte = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).unwrap();
        (byte(0), byte(2), byte(4))
    }

    #[test]
    fn the_light_palette_is_that_of_the_style_sheets() {
        let token = |name: &str| light(TOKENS, &format!("  --{name}: "));
        let motor = |place| light(GRAPH, &format!(".motor-{place} {{ color: "));
        let palette = Palette {
            surface: token("surface"),
            line: token("line"),
            text: token("text-quiet"),
            speed: token("speed"),
            current: token("current"),
            temperature: token("heat"),
            position: token("position"),
            motors: [0, 1, 2, 3, 4, 5, 6, 7].map(motor),
        };
        assert_eq!(palette, Palette::LIGHT);
    }

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
