//! Panel `Virtual motors`: how many virtual motors there are, and of which model.
//!
//! What is chosen here is what the button `Virtual motor` connects from then on.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{VirtualLine, VirtualMotors, protocol::family::Model};
use wasm_bindgen::JsCast;
use web_sys::Element;

use crate::{
    features::connect::{actions::Connect, view::virtual_blocked_by},
    model::place::Panel,
    ui::{
        button::PressButton,
        panel::panel,
        reactive::{dynamic, effect, handler},
    },
};

/// The combobox of the model. Any other control of the panel chooses the motors.
const MODEL: &str = "virtual-model";

/// Panel `Virtual motors`.
#[component]
pub(crate) fn VirtualMotorsPanel(connect: Connect) -> impl IntoView {
    let page = connect.page;
    let line = move || page.preferences.with(|chosen| chosen.virtual_line);
    let blocked_by = Signal::derive(move || virtual_blocked_by(page, Some(line())));
    let choose = move |event: web_sys::Event| {
        let control = event.target().and_then(|at| at.dyn_into::<Element>().ok());
        let is_model = control.is_some_and(|control| control.id() == MODEL);
        let value = event_target_value(&event);
        page.prefer(|chosen| {
            let line = &mut chosen.virtual_line;
            if is_model {
                line.model = value.parse().unwrap_or(line.model);
            } else {
                line.motors = VirtualMotors::from_key(&value).unwrap_or(line.motors);
            }
        });
    };
    // The buttons, in the header and on the first screen, are there before this panel is loaded, and every byte of
    // them counts.
    effect(move || {
        let is_open = page.panel() == Some(Panel::VirtualMotors);
        for around in [".connect-buttons", ".first-buttons"] {
            let button = document().query_selector(&format!("{around} .virtual-choice"));
            if let Ok(Some(button)) = button {
                // It fails only for invalid names.
                let _ =
                    button.set_attribute("aria-expanded", if is_open { "true" } else { "false" });
            }
        }
    });
    panel(
        "panel opened",
        tr!("Virtual motors"),
        move || page.panel() == Some(Panel::VirtualMotors),
        Some(page.closer()),
        view! {
            <div class="virtual-panel">
                <div
                    on:change=handler(choose)
                    inner_html=choices(page.preferences.with_untracked(|chosen| chosen.virtual_line))
                ></div>
                <PressButton
                    label=tr!("Connect virtual motors")
                    class="button primary"
                    disabled_reason=blocked_by
                    on_press=move || {
                        page.show_panel(None);
                        connect.connect_virtual();
                    }
                />
                <p class="quiet">{dynamic(move || blocked_by.get())}</p>
            </div>
        },
    )
}

/// Radiogroup `Motors` and combobox `Model of the virtual motors`, with the present choice.
fn choices(chosen: VirtualLine) -> String {
    let motors = VirtualMotors::ALL.map(|motors| {
        let (key, name) = (motors.key(), name(motors));
        let mark = if motors == chosen.motors { " checked" } else { "" };
        format!(
            r#"<label class="check"><input type="radio" name="virtual-motors" value="{key}"{mark}>{name}</label>"#
        )
    });
    let models = Model::ALL.map(|model| {
        let spec = model.spec();
        let mark = if model == chosen.model {
            " selected"
        } else {
            ""
        };
        let (key, name, maker_name) = (spec.key, spec.name, spec.maker_name);
        format!(r#"<option value="{key}"{mark}>{name} · {maker_name}</option>"#)
    });
    format!(
        r#"<div role="radiogroup" aria-label="{}">{}</div><p class="quiet">{}</p><label class="labelled"><span class="label" aria-hidden="true">{}</span><select class="select" id="{MODEL}" aria-label="{}">{}</select></label>"#,
        tr!("Motors"),
        motors.concat(),
        tr!("One of each fault: each motor reports its fault all the time, and does not turn."),
        tr!("Model"),
        tr!("Model of the virtual motors"),
        models.concat(),
    )
}

fn name(motors: VirtualMotors) -> &'static str {
    match motors {
        VirtualMotors::One => tr!("One motor"),
        VirtualMotors::Two => tr!("Two wheels: left, right"),
        VirtualMotors::Four => tr!("Four-wheel rover"),
        VirtualMotors::Eight => tr!("Eight motors"),
        VirtualMotors::Faults => tr!("One of each fault"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_present_choice_is_marked() {
        let html = choices(VirtualLine {
            motors: VirtualMotors::Four,
            model: Model::Ddsm400,
        });
        assert_eq!(html.matches(" checked").count(), 1);
        assert_eq!(html.matches(" selected").count(), 1);
        assert!(html.contains(r#"value="4" checked>Four-wheel rover"#));
        assert!(html.contains(r#"value="ddsm400" selected>DDSM400 · M0603A"#));
    }
}
