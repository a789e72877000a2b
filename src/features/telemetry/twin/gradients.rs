//! The materials: rubber, aluminium, a black cover, steel, and the light on them.
//!
//! The light is fixed while the wheel turns, so nothing here turns. Colours are classes to which the style sheet
//! gives a `stop-color`.

use crate::features::telemetry::twin::{
    markup::{
        Gradient::{AgainstLight, AlongLight, Domed, Outwards},
        Markup,
    },
    measures,
};

/// The gradients that [`artwork`](super::artwork) names.
pub fn gradients(defs: &mut Markup) {
    shadow(defs);
    tyre(defs);
    hub(defs);
    cover(defs);
    axle(defs);
}

fn shadow(defs: &mut Markup) {
    defs.gradient(
        "twin-shadow",
        Outwards(measures::SHADOW),
        &[
            (0.80, "twin-shade", 0.38),
            (0.88, "twin-shade", 0.17),
            (0.95, "twin-shade", 0.04),
            (1.0, "twin-shade", 0.0),
        ],
    );
}

fn tyre(defs: &mut Markup) {
    let at = |radius: f64| radius / measures::TYRE;
    defs.gradient(
        "twin-carcass",
        Outwards(measures::TYRE),
        &[
            (at(measures::SHOULDER), "twin-rubber-deep", 1.0),
            (at(measures::CARCASS), "twin-rubber-black", 1.0),
        ],
    );
    // The blurred blocks and gaps. Beyond the carcass the gaps are transparent.
    defs.gradient(
        "twin-tread-band",
        Outwards(measures::TYRE),
        &[
            (at(measures::SHOULDER), "twin-rubber-deep", 1.0),
            (at(45.0), "twin-rubber", 1.0),
            (at(47.4), "twin-rubber-lit", 1.0),
            (at(measures::CARCASS - 0.3), "twin-rubber", 1.0),
            (at(measures::CARCASS), "twin-rubber", 0.75),
            (1.0, "twin-rubber", 0.45),
        ],
    );
    // The sidewall bulges: dark at the bead, light in the middle, dark at the shoulder.
    defs.gradient(
        "twin-sidewall",
        Outwards(measures::TYRE),
        &[
            (at(measures::HUB), "twin-rubber-black", 1.0),
            (at(39.0), "twin-rubber-deep", 1.0),
            (at(41.6), "twin-rubber-lit", 1.0),
            (at(43.2), "twin-rubber", 1.0),
            (at(measures::SIDEWALL), "twin-rubber-deep", 1.0),
        ],
    );
    defs.gradient(
        "twin-tyre-light",
        AlongLight(measures::TYRE),
        &[
            (0.0, "twin-light", 0.24),
            (0.30, "twin-light", 0.09),
            (0.54, "twin-light", 0.01),
            (0.55, "twin-shade", 0.0),
            (0.82, "twin-shade", 0.30),
            // The page reflects a little light from below.
            (1.0, "twin-shade", 0.08),
        ],
    );
}

fn hub(defs: &mut Markup) {
    defs.gradient(
        "twin-chamfer",
        AlongLight(measures::HUB),
        &[
            (0.0, "twin-alu-bright", 1.0),
            (0.35, "twin-alu-lit", 1.0),
            (0.65, "twin-alu-deep", 1.0),
            (1.0, "twin-alu-dark", 1.0),
        ],
    );
    defs.gradient(
        "twin-chamfer-inner",
        AgainstLight(measures::HUB),
        &[
            (0.0, "twin-alu-bright", 1.0),
            (0.3, "twin-alu", 1.0),
            (1.0, "twin-alu-dark", 1.0),
        ],
    );
    defs.gradient(
        "twin-hub-face",
        AlongLight(measures::HUB),
        &[
            (0.0, "twin-alu-lit", 1.0),
            (0.5, "twin-alu", 1.0),
            (1.0, "twin-alu-deep", 1.0),
        ],
    );
    let at = |radius: f64| radius / measures::HUB;
    let reach = measures::HOLE * 0.95;
    defs.gradient(
        "twin-hole-band",
        Outwards(measures::HUB),
        &[
            (at(measures::HOLES - reach), "twin-pit", 0.0),
            (at(measures::HOLES - reach * 0.5), "twin-pit", 0.30),
            (at(measures::HOLES), "twin-pit", 0.36),
            (at(measures::HOLES + reach * 0.5), "twin-pit", 0.30),
            (at(measures::HOLES + reach), "twin-pit", 0.0),
        ],
    );
}

fn cover(defs: &mut Markup) {
    defs.gradient(
        "twin-cover",
        Domed(measures::COVER),
        &[
            (0.0, "twin-cover-lit", 1.0),
            (0.55, "twin-cover", 1.0),
            (1.0, "twin-cover-deep", 1.0),
        ],
    );
    defs.gradient(
        "twin-cover-edge",
        AlongLight(measures::COVER),
        &[
            (0.0, "twin-cover-bright", 1.0),
            (0.45, "twin-cover", 1.0),
            (1.0, "twin-cover-black", 1.0),
        ],
    );
    defs.gradient(
        "twin-cover-step",
        AgainstLight(measures::STEP),
        &[
            (0.0, "twin-cover-bright", 1.0),
            (0.5, "twin-cover", 1.0),
            (1.0, "twin-cover-black", 1.0),
        ],
    );
    defs.gradient(
        "twin-gloss",
        Domed(measures::COVER),
        &[
            (0.0, "twin-light", 0.20),
            (0.45, "twin-light", 0.04),
            (0.7, "twin-light", 0.0),
        ],
    );
}

fn axle(defs: &mut Markup) {
    defs.gradient(
        "twin-recess",
        AgainstLight(measures::RECESS),
        &[
            (0.0, "twin-cover-lit", 1.0),
            (0.35, "twin-pit", 1.0),
            (1.0, "twin-pit", 1.0),
        ],
    );
    defs.gradient(
        "twin-steel",
        AlongLight(measures::AXLE),
        &[
            (0.0, "twin-steel-bright", 1.0),
            (0.45, "twin-steel", 1.0),
            (0.55, "twin-steel-lit", 1.0),
            (1.0, "twin-steel-deep", 1.0),
        ],
    );
    defs.gradient(
        "twin-steel-inner",
        AgainstLight(measures::AXLE),
        &[
            (0.0, "twin-steel-bright", 1.0),
            (0.5, "twin-steel-lit", 1.0),
            (1.0, "twin-steel-deep", 1.0),
        ],
    );
}
