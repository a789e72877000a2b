//! The wheel, drawn once. From back to front: shadow, tyre, hub, cover, axle.
//!
//! Only the group `twin-turning` turns, or only the marks for a person who wants less motion. The parts below and above
//! it are round and carry the light, which does not move. The axle does not turn either: in a hub motor the chassis holds it.

use crate::features::telemetry::twin::{
    geometry::{TreadBlock, annulus, arc, bearings, circle, d_shaft, hexagon, holes, sector},
    look::Look,
    markup::Markup,
    measures,
};

/// Highlights of turned metal: the bearing of each pair of fans, and its class, light or shade.
const FANS: [(f64, &str); 2] = [(-38.0, "twin-fan-light"), (52.0, "twin-fan-shade")];
/// Each fan consists of this number of overlapping sectors, which makes its edges soft.
const FAN_LAYERS: u8 = 9;
const FAN_LAYER_DEG: f64 = 7.5;

/// The whole wheel.
pub fn wheel(art: &mut Markup, look: Look) {
    art.scaled(look.size, |art| {
        art.group("twin-wheel", |art| parts(art, look));
    });
}

fn parts(art: &mut Markup, look: Look) {
    art.shaded(
        "twin-shadow",
        circle(180.0, measures::SHADOW_DROP, measures::SHADOW),
    );
    art.path("twin-rim-light", circle(0.0, 0.0, measures::CARCASS));
    art.shaded("twin-carcass", circle(0.0, 0.0, measures::CARCASS));
    art.group("twin-tread-band", |art| {
        art.shaded(
            "twin-tread-band",
            annulus(measures::SHOULDER, measures::TYRE),
        );
        // Small differences between the blocks look like rings at speed.
        for radius in [45.3, 46.1, 47.7, 48.6] {
            art.path("twin-streak", circle(0.0, 0.0, radius));
        }
    });
    sidewall(art, look);
    art.scaled(look.hub, |art| {
        hub(art);
        cover(art);
    });
    art.group("twin-turning", |art| turning(art, look));
    art.shaded(
        "twin-tyre-light",
        annulus(measures::HUB * look.hub, measures::TYRE),
    );
    art.scaled(look.hub, |art| {
        axle(art);
        art.shaded("twin-gloss", circle(0.0, 0.0, measures::FACE));
    });
}

fn sidewall(art: &mut Markup, look: Look) {
    let inner = measures::HUB * look.hub;
    art.shaded("twin-sidewall", annulus(inner, measures::SIDEWALL));
    art.path("twin-rib", circle(0.0, 0.0, 39.3));
    art.path("twin-rib", circle(0.0, 0.0, 43.9));
}

fn hub(art: &mut Markup) {
    art.shaded("twin-chamfer", annulus(measures::LIP, measures::HUB));
    art.shaded("twin-chamfer-inner", annulus(measures::FACE, measures::LIP));
    art.shaded("twin-hub-face", annulus(measures::COVER, measures::FACE));
    turned_metal(art, measures::COVER, measures::FACE, "twin-fans-bright");
    art.path("twin-groove", circle(0.0, 0.0, measures::FACE));
    art.group("twin-hole-band", |art| {
        art.shaded(
            "twin-hole-band",
            annulus(
                measures::HOLES - measures::HOLE,
                measures::HOLES + measures::HOLE,
            ),
        );
    });
}

fn cover(art: &mut Markup) {
    art.path("twin-gap", circle(0.0, 0.0, measures::COVER + 0.7));
    art.shaded("twin-cover-edge", circle(0.0, 0.0, measures::COVER));
    art.shaded("twin-cover", circle(0.0, 0.0, measures::COVER_FACE));
    turned_metal(art, measures::STEP, measures::COVER_FACE, "twin-fans-dim");
    art.shaded(
        "twin-cover-step",
        annulus(measures::STEP - 0.7, measures::STEP),
    );
}

/// The turning parts, which make the rotation visible.
fn turning(art: &mut Markup, look: Look) {
    // They extend over the shoulder.
    let block = TreadBlock {
        inner: measures::SHOULDER,
        outer: measures::TYRE,
        root_deg: look.tread_tip_deg / 2.0,
        tip_deg: look.tread_tip_deg,
        lean_deg: look.tread_lean_deg,
    };
    art.group("twin-tread", |art| {
        art.path("twin-block-edge", block.ring(look.tread_blocks, -0.55));
        art.path("twin-block", block.ring(look.tread_blocks, 0.0));
    });
    art.scaled(look.hub, |art| turning_hub(art, look));
    art.group("twin-pointer", |art| marks(art, look));
}

fn turning_hub(art: &mut Markup, look: Look) {
    art.group("twin-holes", |art| {
        let offset_deg = 180.0 / f64::from(look.holes);
        let ring = |radius| holes(look.holes, offset_deg, measures::HOLES, radius);
        art.path("twin-hole-edge", ring(measures::HOLE));
        art.path("twin-hole", ring(measures::HOLE - 0.28));
    });
    for bearing in bearings(look.screws, 60.0) {
        art.path(
            "twin-sink",
            circle(bearing, measures::SCREWS, measures::SCREW + 0.75),
        );
        art.path(
            "twin-screw-edge",
            circle(bearing, measures::SCREWS, measures::SCREW),
        );
        art.path(
            "twin-screw",
            circle(bearing, measures::SCREWS, measures::SCREW - 0.35),
        );
        art.path("twin-socket", hexagon(bearing, measures::SCREWS, 1.25));
    }
}

/// The marks that show the angle, and their trail at speed.
fn marks(art: &mut Markup, look: Look) {
    art.scaled(look.hub, |art| {
        art.path("twin-mark", "M0 -34.9L2.3 -30.4Q0 -31.3 -2.3 -30.4Z");
    });
    let middle = f64::midpoint(measures::HUB * look.hub, measures::SIDEWALL);
    art.measured_path(
        "twin-trail",
        360.0,
        // A full circle cannot be one arc.
        format!(
            "{}A{middle} {middle} 0 0 1 0 {:.2}",
            arc(middle, 0.0, 180.0),
            -middle
        ),
    );
    art.path("twin-mark", sector(0.0, 2.6, 39.3, 43.9));
}

fn axle(art: &mut Markup) {
    art.shaded("twin-recess", circle(0.0, 0.0, measures::RECESS));
    art.shaded(
        "twin-steel-inner",
        d_shaft(measures::AXLE, measures::AXLE_FLAT),
    );
    art.shaded(
        "twin-steel",
        d_shaft(measures::AXLE - 0.55, measures::AXLE_FLAT - 0.3),
    );
    art.path("twin-lathe", circle(0.0, 0.0, 5.2));
    art.path("twin-lathe", circle(0.0, 0.0, 3.8));
    art.shaded("twin-steel-inner", circle(0.0, 0.0, 2.3));
    art.path("twin-bore", circle(0.0, 0.0, 1.75));
}

/// The fan-shaped highlights of a face turned on a lathe.
fn turned_metal(art: &mut Markup, inner: f64, outer: f64, class: &str) {
    art.group(class, |art| {
        for (bearing, fan) in FANS {
            for layer in 1..=FAN_LAYERS {
                let width_deg = f64::from(layer) * FAN_LAYER_DEG;
                let pair = [bearing, bearing + 180.0];
                let data: String = pair
                    .iter()
                    .map(|bearing| sector(*bearing, width_deg, inner, outer))
                    .collect();
                art.path(fan, data);
            }
        }
        for ring in 1..6_u8 {
            let radius = inner + (outer - inner) * f64::from(ring) / 6.0;
            art.path("twin-lathe", circle(0.0, 0.0, radius));
        }
    });
}
