//! Draws the instruments of the cards in the browser: two sparklines, the dial and the gauge.

use leptos::{html, prelude::*};
use motorlink_i18n::terms::in_language;
use motorlink_messages::protocol::Celsius;
use web_sys::Element;

use crate::{
    features::telemetry::{
        angle_dial::Sweep,
        gauge,
        readings::Readings,
        recent::{Recent, Report},
        scale::Scale,
        sparkline::{self, COLUMN_WIDTH, HALF_HEIGHT},
        twin::{Drawn, TwinFeed},
    },
    model::{heat::Band, mirror::Mirror},
    ui::{attribute::Attribute, clock::page_now_ms, reactive::effect},
};

/// Columns of a sparkline, about one per pixel on a desktop.
const COLUMNS: u16 = 160;
/// Minimal time between drawings: each one takes time from drawing the wheel.
const DRAWN_EVERY_MS: f64 = 50.0;
/// The scales begin at 25 rpm and end at 800, more than any wheel is driven to.
const SPEED_SCALE: Scale = Scale::new(25, 5);
/// The scales begin at a quarter of an amp and end at 8 A, full scale of a reply.
const CURRENT_SCALE: Scale = Scale::new(1024, 5);

/// The drawing of a sparkline before anything is known.
pub(crate) fn sparkline_markup() -> String {
    let (width, height) = (COLUMNS * COLUMN_WIDTH, 2 * HALF_HEIGHT);
    format!(
        "<span class=\"spark-scale\"></span><span class=\"spark-span\">10 s</span>\
         <svg class=\"spark\" viewBox=\"0 0 {width} {height}\" preserveAspectRatio=\"none\">\
         <path class=\"spark-zero\" d=\"M0 {HALF_HEIGHT}H{width}\"/><path class=\"spark-line\"/></svg>"
    )
}

/// Draws the instruments with every newly shown state, ten times a second while the page is visible.
pub(crate) fn draw_on_change(readings: Readings, section: NodeRef<html::Section>) {
    effect(move || {
        let Some(section) = section.get() else { return };
        let Some(mut instruments) = Instruments::of(&section) else {
            return;
        };
        effect(move || {
            readings.page.shown.track();
            instruments.draw(readings);
        });
    });
}

struct Instruments {
    speed: Spark,
    current: Spark,
    dial: Dial,
    gauge: Gauge,
    drawn_ms: f64,
}

impl Instruments {
    /// `None` if a drawing is missing in the cards.
    fn of(cards: &Element) -> Option<Self> {
        Some(Self {
            speed: Spark::of(cards, ".speed", SPEED_SCALE, Quantity::Speed)?,
            current: Spark::of(cards, ".current", CURRENT_SCALE, Quantity::CURRENT)?,
            dial: Dial::of(cards)?,
            gauge: Gauge::of(cards)?,
            drawn_ms: f64::NEG_INFINITY,
        })
    }

    fn draw(&mut self, readings: Readings) {
        let page = readings.page;
        let now_ms = page_now_ms();
        let id = page.selected.get_untracked();
        let (alone, temperature, mirror, is_certain) = page.shown.with_untracked(|session| {
            let temperature = session.temperature(id).map(|reading| reading.value);
            (
                session.motors.is_empty(),
                temperature,
                session.mirror(id),
                session.is_current_certain(),
            )
        });
        // A state that comes sooner is followed by another one, unless there are no motors: then old values are
        // removed at once.
        let soon = now_ms - self.drawn_ms < DRAWN_EVERY_MS;
        if !alone && (soon || document().hidden()) {
            return;
        }
        self.drawn_ms = now_ms;
        let shown_ms = page.worker.clock.get_value().shown_ms(now_ms);
        readings.recent.with_value(|recent| {
            self.speed.draw(recent, mirror, shown_ms);
            self.current.quantity = Quantity::Current { is_certain };
            self.current.draw(recent, mirror, shown_ms);
        });
        let drawn = readings.twin.with_value(TwinFeed::drawn);
        self.dial.draw(drawn, now_ms);
        self.gauge.draw(temperature);
    }
}

/// The quantity of a sparkline.
#[derive(Clone, Copy)]
enum Quantity {
    Speed,
    Current {
        /// Whether its unit is. If not, the raw number is shown.
        is_certain: bool,
    },
}

impl Quantity {
    const CURRENT: Self = Self::Current { is_certain: true };

    fn of(self, report: &Report, mirror: Mirror) -> Option<i32> {
        match self {
            Self::Speed => Some(mirror.speed(report.speed?).rpm().into()),
            Self::Current { .. } => Some(mirror.current(report.current?).raw().into()),
        }
    }

    /// The value at the upper and the lower edge, in the unit of the card.
    fn scale(self, scale: Scale) -> String {
        match (self, scale.multiple()) {
            (Self::Speed | Self::Current { is_certain: false }, _) => {
                format!("±{}", scale.limit())
            }
            (Self::Current { .. }, 1) => in_language("±0.25".to_owned()),
            (Self::Current { .. }, 2) => in_language("±0.5".to_owned()),
            (Self::Current { .. }, quarters) => format!("±{}", quarters / 4),
        }
    }
}

struct Spark {
    line: Attribute,
    label: Attribute,
    scale: Scale,
    quantity: Quantity,
}

impl Spark {
    fn of(cards: &Element, card: &str, scale: Scale, quantity: Quantity) -> Option<Self> {
        let card = cards.query_selector(card).ok().flatten()?;
        Some(Self {
            line: Attribute::find(&card, ".spark-line", "d")?,
            // The style sheet writes it.
            label: Attribute::find(&card, ".spark-scale", "data-scale")?,
            scale,
            quantity,
        })
    }

    fn draw(&mut self, recent: &Recent, mirror: Mirror, now_ms: f64) {
        let reports = recent
            .iter()
            .filter_map(|report| Some((report.at_ms, self.quantity.of(report, mirror)?)));
        let columns = sparkline::columns(reports, now_ms, COLUMNS);
        self.scale.fit(sparkline::peak(&columns));
        let limit = self.scale.limit();
        self.line
            .set(sparkline::path(&columns, now_ms, COLUMNS, limit));
        self.label.set(self.quantity.scale(self.scale));
    }
}

struct Dial {
    known: Attribute,
    hand: Attribute,
    swept_from: Attribute,
    swept: Attribute,
    sweep: Sweep,
}

impl Dial {
    fn of(cards: &Element) -> Option<Self> {
        Some(Self {
            known: Attribute::find(cards, ".angle-dial", "data-known")?,
            hand: Attribute::find(cards, ".angle-hand", "transform")?,
            swept_from: Attribute::find(cards, ".angle-swept", "transform")?,
            swept: Attribute::find(cards, ".angle-swept", "stroke-dasharray")?,
            sweep: Sweep::default(),
        })
    }

    fn draw(&mut self, drawn: Option<Drawn>, now_ms: f64) {
        let Some(drawn) = drawn else {
            self.known.set("no".to_owned());
            self.sweep.forget();
            return;
        };
        let face = self.sweep.to(now_ms, drawn.angle_deg);
        self.known.set("yes".to_owned());
        self.hand.rotate(face.hand);
        self.swept_from.rotate(face.swept_from);
        self.swept.set(format!("{:.1} 999", face.swept));
    }
}

struct Gauge {
    band: Attribute,
    fill: Attribute,
}

impl Gauge {
    fn of(cards: &Element) -> Option<Self> {
        Some(Self {
            band: Attribute::find(cards, ".gauge", "data-band")?,
            fill: Attribute::find(cards, ".gauge-fill", "stroke-dasharray")?,
        })
    }

    fn draw(&mut self, temperature: Option<Celsius>) {
        let band = temperature.map_or("unknown", |temperature| Band::of(temperature).into_str());
        self.band.set(band.to_owned());
        self.fill.set(gauge::fill(temperature));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_is_labelled_in_the_units_of_its_card() {
        let label = |quantity: Quantity, mut scale: Scale, peak| {
            scale.fit(peak);
            quantity.scale(scale)
        };
        assert_eq!(label(Quantity::Speed, SPEED_SCALE, 0), "±25");
        assert_eq!(label(Quantity::Speed, SPEED_SCALE, 330), "±400");
        for (peak, text) in [(0, "±0.25"), (2_048, "±0.5"), (4_096, "±1"), (32_767, "±8")] {
            assert_eq!(label(Quantity::CURRENT, CURRENT_SCALE, peak), text);
        }
        let raw = Quantity::Current { is_certain: false };
        assert_eq!(label(raw, CURRENT_SCALE, 2_048), "±2048");
    }
}
