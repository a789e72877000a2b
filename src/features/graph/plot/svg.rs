//! A drawing as SVG: paths and texts, without a bitmap, a script or a reference to another file.

use crate::{
    features::graph::plot::{
        layout::Rectangle,
        palette::{Colour, css},
        strokes::{Bar, Pixel},
        surface::{Align, AxesSurface, DASH, FINE, LineSurface, Opacity, Pen},
    },
    ui::escape::escaped,
};

/// From the middle of a line of text to its baseline, as a part of the font size. Not every program knows
/// `dominant-baseline`.
const TO_BASELINE: f64 = 0.35;

/// A drawing in device pixels.
pub(crate) struct Svg {
    /// Device pixels per CSS pixel.
    ratio: f64,
    /// In device pixels.
    font_size: f64,
    content: String,
}

impl Svg {
    /// An empty drawing; the font size is in device pixels.
    pub(crate) fn new(ratio: f64, font_size: f64) -> Self {
        Self {
            ratio,
            font_size,
            content: String::new(),
        }
    }

    /// Adds another drawing on top.
    pub(crate) fn append(&mut self, other: &Self) {
        self.content.push_str(&other.content);
    }

    /// Moves what `draw` adds down by so many device pixels.
    pub(crate) fn moved_down(&mut self, by: f64, draw: impl FnOnce(&mut Self)) {
        self.put(&["<g transform=\"translate(0 ", &number(by), ")\">\n"]);
        draw(self);
        self.put(&["</g>\n"]);
    }

    /// The file of a drawing of this size in device pixels.
    pub(crate) fn file(&self, (width, height): (f64, f64), title: &str, font: &str) -> String {
        let size = |pixels: f64| number(pixels / self.ratio);
        [
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <svg xmlns=\"http://www.w3.org/2000/svg\" width=\"",
            &size(width),
            "\" height=\"",
            &size(height),
            "\" viewBox=\"0 0 ",
            &number(width),
            " ",
            &number(height),
            "\" font-family=\"",
            &xml(font),
            "\" font-size=\"",
            &number(self.font_size),
            "\" stroke-linejoin=\"bevel\">\n<title>",
            &xml(title),
            "</title>\n",
            &self.content,
            "</svg>\n",
        ]
        .concat()
    }

    fn put(&mut self, parts: &[&str]) {
        for part in parts {
            self.content.push_str(part);
        }
    }
}

impl AxesSurface for Svg {
    fn fill(&mut self, rectangle: [f64; 4], colour: Colour, opacity: Opacity) {
        let [left, top, width, height] = rectangle.map(number);
        let opacity = match opacity {
            Opacity::Full => "",
            Opacity::Weak => "\" fill-opacity=\"0.45",
        };
        self.put(&[
            "<rect x=\"",
            &left,
            "\" y=\"",
            &top,
            "\" width=\"",
            &width,
            "\" height=\"",
            &height,
            "\" fill=\"",
            &css(colour),
            opacity,
            "\"/>\n",
        ]);
    }

    fn write(&mut self, text: &str, (x, y): (f64, f64), align: Align, colour: Colour) {
        let anchor = match align {
            Align::Left => "",
            Align::Center => "\" text-anchor=\"middle",
            Align::Right => "\" text-anchor=\"end",
        };
        let baseline = y + TO_BASELINE * self.font_size;
        self.put(&[
            "<text x=\"",
            &number(x),
            "\" y=\"",
            &number(baseline),
            "\" fill=\"",
            &css(colour),
            anchor,
            "\">",
            &xml(text),
            "</text>\n",
        ]);
    }
}

impl LineSurface for Svg {
    fn begin_pane(&mut self, pane: Rectangle) {
        let Rectangle {
            left,
            top,
            width,
            height,
        } = pane;
        let [left, top, width, height] = [left, top, width, height].map(|it| it.to_string());
        // An element of its own clips, without an id for a path.
        for (name, value) in [
            ("<svg x=\"", &left),
            ("\" y=\"", &top),
            ("\" width=\"", &width),
            ("\" height=\"", &height),
            ("\" viewBox=\"", &[&*left, &top, &width, &height].join(" ")),
        ] {
            self.put(&[name, value]);
        }
        self.put(&["\">\n"]);
    }

    fn end_pane(&mut self) {
        self.put(&["</svg>\n"]);
    }

    fn bars(&mut self, bars: &[Bar], colour: Colour) {
        self.put(&["<path d=\""]);
        for bar in bars {
            let [x, top, bottom] = [bar.x, bar.top, bar.bottom].map(of_fine);
            self.put(&["M", &x, " ", &top, "V", &bottom]);
        }
        self.put(&["\" stroke=\"", &css(colour), "\" stroke-width=\"1\"/>\n"]);
    }

    fn line(&mut self, points: Vec<Pixel>, pen: &Pen) {
        let mut command = "<path d=\"M";
        for (x, y) in points {
            self.put(&[command, &of_fine(x), " ", &of_fine(y)]);
            command = "L";
        }
        let [dash, gap] = DASH.map(|length| number(length * self.ratio));
        let width = number(pen.width * self.ratio);
        self.put(&[
            "\" fill=\"none\" stroke=\"",
            &css(pen.colour),
            "\" stroke-width=\"",
            &width,
        ]);
        if pen.dashed {
            self.put(&["\" stroke-dasharray=\"", &dash, " ", &gap]);
        }
        self.put(&["\"/>\n"]);
    }

    fn label(&mut self, text: &str, at: (f64, f64), colour: Colour) {
        self.write(text, at, Align::Left, colour);
    }
}

fn of_fine(fine: i32) -> String {
    number(f64::from(fine) / f64::from(FINE))
}

/// A text as XML has it, without the characters that XML does not allow.
fn xml(text: &str) -> String {
    let is_allowed =
        |character: &char| !character.is_control() && !matches!(character, '\u{FFFE}' | '\u{FFFF}');
    escaped(&text.chars().filter(is_allowed).collect::<String>())
}

/// A length to a tenth: a tenth of a device pixel is less than anything shows. The code that formats floats would be
/// larger than all of this.
fn number(length: f64) -> String {
    #[allow(
        clippy::cast_possible_truncation,
        reason = "lengths of a picture, and a cast saturates"
    )]
    let tenths = (length * 10.0).round() as i32;
    let sign = if tenths < 0 { "-" } else { "" };
    let (whole, part) = (tenths.unsigned_abs() / 10, tenths.unsigned_abs() % 10);
    match part {
        0 => format!("{sign}{whole}"),
        _ => format!("{sign}{whole}.{part}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLUE: Colour = (11, 100, 189);

    #[test]
    fn a_length_has_at_most_one_decimal() {
        let lengths = [0.0, 1_600.0, 12.25, 0.04, -0.04, -0.5, -12.96];
        let written = lengths.map(number);
        assert_eq!(written, ["0", "1600", "12.3", "0", "0", "-0.5", "-13"]);
    }

    #[test]
    fn names_cannot_end_a_text_or_an_attribute() {
        let mut svg = Svg::new(2.0, 22.0);
        let name = "<b>\"A\" & 'B'</text>\u{7}\u{FFFE}";
        svg.write(name, (10.0, 20.0), Align::Right, BLUE);
        let file = svg.file((1_600.0, 960.0), name, "\"Noto Sans\", sans-serif");
        let harmless = "&lt;b&gt;&quot;A&quot; &amp; 'B'&lt;/text&gt;";
        assert!(
            file.contains(&format!("<title>{harmless}</title>")),
            "{file}"
        );
        assert!(file.contains(&format!(
            "<text x=\"10\" y=\"27.7\" fill=\"rgb(11,100,189)\" text-anchor=\"end\">{harmless}</text>"
        )));
        assert!(file.contains("font-family=\"&quot;Noto Sans&quot;, sans-serif\""));
        assert!(file.contains("width=\"800\" height=\"480\" viewBox=\"0 0 1600 960\""));
    }

    #[test]
    fn a_line_is_one_path_in_device_pixels() {
        let mut svg = Svg::new(2.0, 22.0);
        let mut pen = Pen {
            colour: BLUE,
            width: 1.25,
            dashed: false,
        };
        svg.line(vec![(8, 80), (16, 84), (24, 1)], &pen);
        pen.dashed = true;
        svg.moved_down(60.0, |svg| svg.line(vec![(0, 0), (8, 0)], &pen));
        assert_eq!(
            svg.content,
            "<path d=\"M1 10L2 10.5L3 0.1\" fill=\"none\" stroke=\"rgb(11,100,189)\" stroke-width=\"2.5\"/>\n\
             <g transform=\"translate(0 60)\">\n\
             <path d=\"M0 0L1 0\" fill=\"none\" stroke=\"rgb(11,100,189)\" stroke-width=\"2.5\" \
             stroke-dasharray=\"10 8\"/>\n</g>\n"
        );
    }
}
