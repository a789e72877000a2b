//! The figures of the group, in the places of those of a motor.

use leptos::prelude::*;
use motorlink_i18n::{terms::in_language, tr};
use motorlink_messages::experiments::vehicle::{Motion, Wheel};
use web_sys::Element;

use crate::{
    features::rover::{
        painter::speeds,
        state::Rover,
        texts::{self, Figures},
        trip::Trip,
    },
    model::{
        heat::Band,
        snapshot::{Reading, Session},
    },
    ui::{
        format::{self, UNKNOWN},
        reactive::effect,
        text::write_text,
    },
};

/// The class of the last card.
const TEMPERATURE: &str = "panel read-out temperature";
/// Where the cards are, in the region `Telemetry`.
const CARDS: &str = ".telemetry > .late";
/// In whose place they are. Where they hide the figures below the drawing, style/later/46-rover.css says.
const OTHERS: [&str; 4] = [
    ".telemetry > .speed",
    ".telemetry > .current",
    ".telemetry > .position",
    ".telemetry > .temperature",
];

/// Shows the cards of the group while `Group` is chosen in Drive, and it is a vehicle.
pub(crate) fn show(rover: Rover) {
    let page = rover.page;
    effect(move || {
        page.shown.track();
        let vehicle = if page.shows_group() {
            rover.vehicle()
        } else {
            None
        };
        let Some(cards) = cards() else { return };
        hide(&cards, vehicle.is_none());
        for other in OTHERS.into_iter().filter_map(find) {
            hide(&other, vehicle.is_some());
        }
        if let Some(vehicle) = vehicle {
            rover.follow(&vehicle);
            let figures = page.shown.with(|session| {
                let wheels = vehicle.wheels();
                let speed = |wheel: &Wheel| speeds(session, wheel.id).measured;
                let rpm: Vec<_> = wheels.iter().map(speed).collect();
                let motion = Motion::of(&vehicle, rover.geometry.get_untracked(), &rpm);
                let way = |trip: &Trip| (trip.driven_mm(), trip.pose().heading_deg);
                figures(session, wheels, motion, rover.trip.with_value(way))
            });
            for (place, text) in (0..).zip(figures.texts) {
                if let Some(words) = cards.get_elements_by_tag_name("bdi").item(place) {
                    write_text(&words, &text);
                }
            }
            if let Some(temperature) = cards.last_element_child() {
                temperature.set_class_name(&[TEMPERATURE, figures.heat].concat());
            }
        }
    });
}

fn find(selector: &str) -> Option<Element> {
    document().query_selector(selector).ok().flatten()
}

fn hide(element: &Element, is_hidden: bool) {
    // It fails for invalid names only.
    let _ = element.toggle_attribute_with_force("hidden", is_hidden);
}

/// The cards, which are added first unless they are there.
fn cards() -> Option<Element> {
    if let Some(cards) = find(CARDS) {
        return Some(cards);
    }
    let cards = document().create_element("div").ok()?;
    cards.set_class_name("late");
    cards.set_inner_html(&markup());
    find(".telemetry")?.append_child(&cards).ok()?;
    Some(cards)
}

/// The cards before anything is known. The texts contain the spaces, for screen readers.
fn markup() -> String {
    let mut html = String::new();
    for (class, name, unit) in [
        (
            "panel read-out speed noted",
            tr!("Forward" as "motion"),
            " m/s",
        ),
        (
            "panel read-out current noted",
            tr!("Current" as "electric"),
            " A",
        ),
        ("panel read-out position", tr!("Heading"), "°"),
        (TEMPERATURE, tr!("Temperature"), " °C"),
    ] {
        for part in [
            "<div class=\"",
            class,
            "\"><div class=\"read-out-head\"><span class=\"read-out-name\" aria-hidden=\"true\">",
            name,
            "</span></div><output aria-live=\"off\" aria-label=\"",
            name,
            "\"><bdi class=\"figure\"></bdi><span class=\"unit\">",
            unit,
            "</span> <bdi class=\"detail\"></bdi></output></div>",
        ] {
            html.push_str(part);
        }
    }
    html
}

/// What the cards show.
#[derive(Debug)]
struct Shown {
    /// Figure and detail of each card.
    texts: [String; 8],
    /// The look of the temperature, as a class.
    heat: &'static str,
}

/// The signs are those of the operator. Unknown is not zero: neither is the whole of which one part is unknown, or a
/// current whose scale is. The current is what all motors draw: those of a turn on the spot do not cancel out.
fn figures(
    session: &Session,
    wheels: &[Wheel],
    motion: Option<Motion>,
    (driven_mm, heading_deg): (f64, f64),
) -> Shown {
    let amps = |wheel: &Wheel| {
        let reading = session.current(wheel.id).filter(Reading::is_fresh)?;
        Some(reading.value.amps().abs())
    };
    let amps: Option<f32> = wheels.iter().map(amps).sum();
    let amps = amps.filter(|_| session.is_current_certain());
    let heat = |wheel: &Wheel| session.temperature(wheel.id);
    let heats: Option<Vec<_>> = wheels.iter().map(heat).collect();
    let heats = heats.unwrap_or_default();
    // Of several, the first.
    let hottest = heats.iter().zip(wheels).rev();
    let hottest = hottest.max_by_key(|(reading, _)| reading.value);
    let (temperature, whose, band) = match hottest {
        Some((reading, wheel)) => (
            reading.value.degrees().to_string(),
            [&wheel.id.to_string(), " ", &wheel.name].concat(),
            Band::of(reading.value),
        ),
        None => (UNKNOWN.to_owned(), String::new(), Band::Normal),
    };
    let heat = match band {
        _ if !heats.iter().all(Reading::is_fresh) => " stale",
        Band::Normal => "",
        Band::Warm => " warm",
        Band::Hot => " bad",
    };
    let said = Figures::new(motion, driven_mm, heading_deg);
    let texts = [
        texts::forward(motion),
        [tr!("Driven"), " ", &said.driven].concat(),
        amps.map_or_else(
            || UNKNOWN.to_owned(),
            |amps| in_language(format::fixed(amps, 2)),
        ),
        tr!("sum of {count} motors", count = wheels.len()),
        texts::heading(heading_deg),
        [tr!("Turn"), " ", &said.turn].concat(),
        temperature,
        whose,
    ];
    Shown { texts, heat }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        experiments::vehicle::Motion,
        protocol::{Celsius, Current, Mode, MotorId},
    };

    use super::*;
    use crate::model::{
        names_and_sides::NamesAndSides,
        snapshot::tests::{session, status},
        vehicle::{tests::names, vehicle_of},
    };

    /// Motor 1 on the left and motor 2 on the right, which is the hotter one.
    fn pair() -> (Session, NamesAndSides) {
        let names = names(2);
        let left = status(1_000, Mode::Velocity, 100);
        let mut right = status(1_000, Mode::Velocity, -100);
        right.id = MotorId::new(2).unwrap();
        right.current = right
            .current
            .map(|(at, current)| (at, Current::from_raw(-current.raw())));
        right.temperature = right.temperature.map(|(at, _)| (at, Celsius::new(80)));
        let mut session = session(1_016, left);
        session.motors.push(right);
        (session.with_mirroring(&names), names)
    }

    fn said(session: &Session, names: &NamesAndSides, motion: Option<Motion>) -> Shown {
        let vehicle = vehicle_of(names).unwrap();
        figures(session, vehicle.wheels(), motion, (3_421.0, 71.2))
    }

    #[test]
    fn a_group_has_one_sign_a_sum_and_its_hottest_motor() {
        let (session, names) = pair();
        let motion = Motion {
            forward_mm_per_s: 533.8,
            turn_deg_per_s: 0.0,
        };
        assert_eq!(
            said(&session, &names, Some(motion)).texts,
            [
                "+0.53",
                "Driven 3.42 m",
                "0.05",
                "sum of 2 motors",
                "71",
                "Turn 0 °/s",
                "80",
                "0x02 ",
            ]
        );
    }

    #[test]
    fn a_whole_without_one_of_its_parts_is_unknown() {
        let (mut session, names) = pair();
        session.motors[1].current = None;
        session.motors[1].temperature = None;
        assert_eq!(
            said(&session, &names, None).texts,
            [
                "–",
                "Driven 3.42 m",
                "–",
                "sum of 2 motors",
                "71",
                "Turn – °/s",
                "–",
                "",
            ]
        );
    }

    #[test]
    fn the_currents_of_a_turn_on_the_spot_do_not_cancel_out_and_heat_is_seen() {
        let (mut session, names) = pair();
        let forward = said(&session, &names, None);
        assert_eq!(forward.heat, " bad");
        session.motors[1].current = session.motors[0].current;
        let turning = said(&session.with_mirroring(&names), &names, None);
        assert_eq!(turning.texts[2], forward.texts[2]);
    }
}
