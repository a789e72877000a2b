//! The rest of the first screen: virtual motors to try, the wiring, and a recording to open. As HTML, it is a tenth of the
//! size of a view.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{LineCondition, ToWorker, VirtualMotors};
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Element, Event, HtmlInputElement, MouseEvent};

use crate::{
    features::connect::actions::Connect,
    model::help_topic::HelpTopic,
    ui::reactive::{dynamic, effect, handler},
};

/// The fault of the card `Faulty cable`: it appears when the wheel turns.
const FAULT: LineCondition = LineCondition::NoiseGrowsWithSpeed;

/// The value of its button. Those of the other cards are the keys of their motors.
const FAULTY: &str = "cable";

/// The value of the button `Open recording`.
const RECORDING: &str = "recording";

const CHOOSER: &str = "recording-file";

const WHEEL: &str = r#"<circle class="tyre" cx="60" cy="40" r="32"/><circle class="tread" cx="60" cy="40" r="30"/><circle class="hub" cx="60" cy="40" r="18"/>"#;
const ROVER: &str = r#"<rect class="box" x="40" y="12" width="40" height="56" rx="8"/><path class="rover-wheels" d="M30 10V28M90 10V28M30 52V70M90 52V70"/><path class="sent" d="M54 34L60 26L66 34"/>"#;
const CABLE: &str = r#"<path class="dc" d="M2 42C18 30 22 50 36 40M44 42C52 48 54 40 62 40"/><path class="spark" d="M40 8L33 22H40L36 34"/><circle class="tyre" cx="90" cy="40" r="26"/><circle class="hub" cx="90" cy="40" r="14"/>"#;

#[component]
pub(crate) fn ToTry(
    connect: Connect,
    /// Which virtual line was chosen, by its place.
    virtual_wire: StoredValue<usize>,
    /// Takes the chosen file.
    #[prop(into)]
    on_recording: Callback<JsValue>,
) -> impl IntoView {
    let page = connect.page;
    // A line is made faulty once it is there, and a group is chosen once it has motors.
    let breaks_next = StoredValue::new(false);
    let steers_next = StoredValue::new(false);
    effect(move || {
        let (is_virtual, motors) = page.shown.with(|session| {
            let is_virtual = session.connection.virtual_line().is_some();
            (is_virtual, session.found().len())
        });
        if is_virtual && motors > 1 && steers_next.get_value() {
            steers_next.set_value(false);
            page.group.set(true);
        }
        if is_virtual && breaks_next.get_value() {
            breaks_next.set_value(false);
            let place = LineCondition::ALL.iter().position(|wire| *wire == FAULT);
            virtual_wire.set_value(place.unwrap_or_default());
            page.post(&ToWorker::VirtualWire(FAULT));
        }
    });
    let press = move |event: MouseEvent| {
        let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
        let button = target.and_then(|target| target.closest("button").ok().flatten());
        let value = button.and_then(|button| button.get_attribute("value"));
        match value.as_deref() {
            None => {}
            Some(RECORDING) => {
                // Its click passes this section, which must have handled the first one by then.
                if let Some(chooser) = chooser() {
                    request_animation_frame(move || chooser.click());
                }
            }
            Some(key) => {
                breaks_next.set_value(key == FAULTY);
                let motors = VirtualMotors::from_key(key).unwrap_or_default();
                page.prefer(|chosen| chosen.virtual_line.motors = motors);
                steers_next.set_value(motors != VirtualMotors::One);
                connect.connect_virtual();
            }
        }
    };
    let choose = move |_: Event| {
        let Some(chooser) = chooser() else { return };
        if let Some(file) = chooser.files().and_then(|files| files.get(0)) {
            on_recording.run(file.into());
        }
        // Choosing the same file again is a change too.
        chooser.set_value("");
    };
    view! {
        <section
            class="to-try"
            hidden=dynamic(move || !page.shows_first_screen())
            on:click=handler(press)
            on:change=handler(choose)
            inner_html=markup()
        ></section>
    }
}

fn chooser() -> Option<HtmlInputElement> {
    let chooser = document().get_element_by_id(CHOOSER)?;
    chooser.dyn_into().ok()
}

fn markup() -> String {
    let cards = [
        (
            VirtualMotors::One.key(),
            WHEEL,
            tr!("One wheel"),
            tr!("Turn it, stop it, measure it."),
        ),
        (
            VirtualMotors::Four.key(),
            ROVER,
            tr!("Rover"),
            tr!("Steer four wheels with a pad."),
        ),
        (
            FAULTY,
            CABLE,
            tr!("Faulty cable"),
            tr!("Turn the wheel, and find out what is wrong."),
        ),
    ];
    let cards = cards.map(|(value, drawing, name, words)| {
        format!(
            r#"<li><svg viewBox="0 0 120 80" aria-hidden="true">{drawing}</svg><button type="button" value="{value}" aria-describedby="try-{value}">{name}</button><p id="try-{value}">{words}</p></li>"#
        )
    });
    [
        format!(
            r#"<h2>{}</h2><p class="quiet">{}</p><ul class="cards wiring-drawing">{}</ul>"#,
            tr!("Try a virtual motor"),
            tr!("No hardware, works offline."),
            cards.concat()
        ),
        wiring(),
        format!(
            r#"<h2>{}</h2><p class="quiet">{}</p><button type="button" class="button" value="{RECORDING}">{}</button><input type="file" accept=".mcap,.csv,.txt" id="{CHOOSER}" hidden>"#,
            tr!("Recording"),
            tr!("Replay a file on the instruments, without a motor."),
            tr!("Open recording")
        ),
    ]
    .concat()
}

/// From the computer to the supply, with the colours of the wires.
fn wiring() -> String {
    let names = [
        (34, tr!("Computer")),
        (137, tr!("Adapter")),
        (292, tr!("Motor")),
        (370, tr!("Supply")),
    ]
    .map(|(x, name)| format!(r#"<text x="{x}" y="88">{name}</text>"#));
    let wires = [("white", 24), ("orange", 38), ("black", 52), ("brown", 60)].map(|(colour, y)| {
        format!(r#"<path class="case" d="M170 {y}H250"/><path class="{colour}" d="M170 {y}H250"/>"#)
    });
    let topic = HelpTopic::Wiring;
    format!(
        r#"<h2>{title}</h2><p class="quiet">DDSM115, M0601 <button type="button" class="help-link" data-help="{id}">{link}</button></p><div class="wiring-drawing first-wiring"><svg viewBox="0 0 400 96" aria-hidden="true"><rect class="box" x="6" y="20" width="56" height="38" rx="4"/><path class="dc" d="M2 64H66M62 40H104"/><rect class="box" x="104" y="12" width="66" height="58" rx="6"/><text class="small end" x="164" y="28">A</text><text class="small end" x="164" y="42">B</text><text class="small end" x="164" y="60">GND</text>{wires}<path class="case" d="M322 34H344M322 50H344"/><path class="red" d="M322 34H344"/><path class="black" d="M322 50H344"/><rect class="plug" x="250" y="14" width="12" height="56" rx="3"/><circle class="tyre" cx="292" cy="42" r="30"/><circle class="hub" cx="292" cy="42" r="17"/><rect class="box" x="344" y="16" width="52" height="52" rx="6"/><text x="370" y="46">18 V</text>{names}</svg></div><p>{signal}<br>{power}</p><p class="quiet">{switch}</p>"#,
        title = tr!("Wiring"),
        id = topic.id(),
        link = topic.link(),
        wires = wires.concat(),
        names = names.concat(),
        signal = tr!("Signal plug: white to A, orange to B, black and brown to GND."),
        power = tr!("Power plug: red to 18 V, black to GND."),
        switch = tr!(
            "If the cable or the computer fails, the wheel may keep turning. Only the power switch \
             stops it then."
        ),
    )
}
