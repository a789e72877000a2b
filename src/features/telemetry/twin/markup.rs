//! A small builder of SVG text.
//!
//! The artwork is drawn once and never re-rendered. So it is text that the browser parses at once and that tests read
//! without a browser. Classes set the style; the page's policy forbids inline styles.

use std::fmt::{Display, Write};

/// SVG elements one after another.
#[derive(Default)]
pub struct Markup(String);

/// One colour of a gradient: its position (0 to 1), the class with the colour, its opacity.
pub type Stop = (f64, &'static str, f64);

/// The direction of a gradient, in millimetres of the drawing.
#[derive(Clone, Copy, Debug)]
pub enum Gradient {
    /// Across a disc of this radius about the axle, from the light at the upper left to the shade.
    AlongLight(f64),
    /// The same from the shade to the light, for an inward bevel.
    AgainstLight(f64),
    /// From the axle outwards to this radius.
    Outwards(f64),
    /// From the highlight of a domed disc of this radius outwards.
    Domed(f64),
}

impl Markup {
    /// The text.
    #[must_use]
    pub fn finish(self) -> String {
        self.0
    }

    fn write(&mut self, text: std::fmt::Arguments<'_>) -> &mut Self {
        // Writing to a string cannot fail.
        let _ = self.0.write_fmt(text);
        self
    }

    /// A path.
    pub fn path(&mut self, class: &str, data: impl Display) -> &mut Self {
        self.write(format_args!(r#"<path class="{class}" d="{data}"/>"#))
    }

    /// A path with `pathLength` set to `length`, so that dashes have the unit of the shown quantity.
    pub fn measured_path(&mut self, class: &str, length: f64, data: impl Display) -> &mut Self {
        self.write(format_args!(
            r#"<path class="{class}" pathLength="{length}" d="{data}"/>"#
        ))
    }

    /// A path filled by a gradient.
    pub fn shaded(&mut self, gradient: &str, data: impl Display) -> &mut Self {
        self.write(format_args!(
            r#"<path fill="url(#{gradient})" fill-rule="evenodd" d="{data}"/>"#
        ))
    }

    /// A short text, centred at a point. It is not escaped.
    pub fn text(&mut self, class: &str, at: super::geometry::Point, text: &str) -> &mut Self {
        let (x, y) = (at.x, at.y);
        self.write(format_args!(
            r#"<text class="{class}" x="{x:.2}" y="{y:.2}">{text}</text>"#
        ))
    }

    /// A group of elements.
    pub fn group(&mut self, class: &str, content: impl FnOnce(&mut Self)) -> &mut Self {
        self.write(format_args!(r#"<g class="{class}">"#));
        content(self);
        self.write(format_args!("</g>"))
    }

    /// Elements in another size. The gradients in them scale too.
    pub fn scaled(&mut self, size: f64, content: impl FnOnce(&mut Self)) -> &mut Self {
        self.write(format_args!(r#"<g transform="scale({size:.2})">"#));
        content(self);
        self.write(format_args!("</g>"))
    }

    /// An element of the given name without a class: `defs`, `desc`.
    pub fn element(&mut self, name: &str, content: impl FnOnce(&mut Self)) -> &mut Self {
        self.write(format_args!("<{name}>"));
        content(self);
        self.write(format_args!("</{name}>"))
    }

    /// A gradient, for use by [`shaded`](Self::shaded).
    pub fn gradient(&mut self, id: &str, way: Gradient, stops: &[Stop]) -> &mut Self {
        let name = match way {
            Gradient::AlongLight(r) => self.linear(id, -r, r),
            Gradient::AgainstLight(r) => self.linear(id, r, -r),
            Gradient::Outwards(r) => self.radial(id, r, 0.0),
            Gradient::Domed(r) => self.radial(id, r * 1.25, -r * 0.36),
        };
        for (offset, class, opacity) in stops {
            self.write(format_args!(
                r#"<stop offset="{offset:.3}" class="{class}" stop-opacity="{opacity}"/>"#
            ));
        }
        self.write(format_args!("</{name}>"))
    }

    /// The light is at the upper left, a little nearer to the top.
    fn linear(&mut self, id: &str, from: f64, to: f64) -> &'static str {
        let (x1, y1, x2, y2) = (from * 0.6, from * 0.8, to * 0.6, to * 0.8);
        self.write(format_args!(
            r#"<linearGradient id="{id}" gradientUnits="userSpaceOnUse" x1="{x1:.2}" y1="{y1:.2}" x2="{x2:.2}" y2="{y2:.2}">"#
        ));
        "linearGradient"
    }

    fn radial(&mut self, id: &str, r: f64, off: f64) -> &'static str {
        let (cx, cy) = (off * 0.75, off);
        self.write(format_args!(
            r#"<radialGradient id="{id}" gradientUnits="userSpaceOnUse" cx="{cx:.2}" cy="{cy:.2}" r="{r:.2}">"#
        ));
        "radialGradient"
    }
}
