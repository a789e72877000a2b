//! The figures of the group, in the places of those of a motor.

use leptos::prelude::*;
use motorlink_i18n::tr;
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
        place::Place,
        snapshot::{Reading, Session},
    },
    ui::{
        format::{self, UNKNOWN},
        reactive::effect,
    },
};

/// Where the cards are, in the region `Telemetry`.
const CARDS: &str = ".telemetry > .late";
/// In whose place they are: the cards of a motor, and the figures below the drawing.
const OTHERS: [&str; 5] = [
    ".telemetry > .speed",
    ".telemetry > .current",
    ".telemetry > .position",
    ".telemetry > .temperature",
    ".rover-figures",
];

/// Shows the cards of the group while `Group` is chosen in Drive, and it is a vehicle.
pub(crate) fn show(rover: Rover) {
    let page = rover.page;
    effect(move || {
        page.shown.track();
        let is_chosen = page.group.get() & (page.place() == Place::Drive);
        let vehicle = if is_chosen { rover.vehicle() } else { None };
        let Some(cards) = cards() else { return };
        hide(&cards, vehicle.is_none());
        for other in OTHERS.into_iter().filter_map(find) {
            hide(&other, vehicle.is_some());
        }
        if let Some(vehicle) = vehicle {
            let session = page.present();
            let wheels = vehicle.wheels();
            let speed = |wheel: &Wheel| speeds(&session, wheel.id).measured;
            let rpm: Vec<_> = wheels.iter().map(speed).collect();
            let motion = Motion::of(&vehicle, rover.geometry.get_untracked(), &rpm);
            let way = |trip: &Trip| (trip.driven_mm(), trip.pose().heading_deg);
            let figures = figures(&session, wheels, motion, rover.trip.with_value(way));
            for (place, text) in (0..).zip(figures) {
                if let Some(words) = cards.get_elements_by_tag_name("bdi").item(place) {
                    words.set_text_content(Some(&text));
                }
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
        ("speed", tr!("Forward" as "motion"), " m/s"),
        ("current", tr!("Current" as "electric"), " A"),
        ("position", tr!("Heading"), "°"),
        ("temperature", tr!("Temperature"), " °C"),
    ] {
        for part in [
            "<div class=\"panel read-out ",
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

/// Figure and detail of each card. The signs are those of the operator, and unknown is not zero: neither is a sum of
/// which one part is unknown, or whose scale is.
fn figures(
    session: &Session,
    wheels: &[Wheel],
    motion: Option<Motion>,
    (driven_mm, heading_deg): (f64, f64),
) -> [String; 8] {
    let (mut amps, mut is_known) = (0.0, session.is_current_certain());
    let mut hottest = None;
    for wheel in wheels {
        match session.current(wheel.id).filter(Reading::is_fresh) {
            Some(reading) => amps += reading.value.amps(),
            None => is_known = false,
        }
        if let Some(reading) = session.temperature(wheel.id)
            && hottest.is_none_or(|(highest, _)| reading.value > highest)
        {
            hottest = Some((reading.value, wheel));
        }
    }
    let unknown = || UNKNOWN.to_owned();
    let current = if is_known {
        format::signed_decimal(amps, 2)
    } else {
        unknown()
    };
    let (temperature, whose) = match hottest {
        Some((value, wheel)) => (
            value.degrees().to_string(),
            [&wheel.id.to_string(), " ", &wheel.name].concat(),
        ),
        None => (unknown(), String::new()),
    };
    let said = Figures::new(motion, driven_mm, heading_deg);
    [
        texts::forward(motion),
        [tr!("Driven"), " ", &said.driven].concat(),
        current,
        tr!("sum of {count}", count = wheels.len()),
        texts::heading(heading_deg),
        [tr!("Turn"), " ", &said.turn].concat(),
        temperature,
        whose,
    ]
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

    fn said(session: &Session, names: &NamesAndSides, motion: Option<Motion>) -> [String; 8] {
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
            said(&session, &names, Some(motion)),
            [
                "+0.53",
                "Driven 3.42 m",
                "+0.05",
                "sum of 2",
                "71",
                "Turn 0 °/s",
                "80",
                "0x02 ",
            ]
        );
    }

    #[test]
    fn a_sum_without_one_of_its_parts_is_unknown() {
        let (mut session, names) = pair();
        session.motors[1].current = None;
        session.motors[1].temperature = None;
        assert_eq!(
            said(&session, &names, None),
            [
                "–",
                "Driven 3.42 m",
                "–",
                "sum of 2",
                "71",
                "Turn – °/s",
                "33",
                "0x01 ",
            ]
        );
    }
}
