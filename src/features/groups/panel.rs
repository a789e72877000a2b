//! Panel `Drive together`: several motors with one setpoint.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Activity, MotorStatus},
    protocol::MotorId,
};
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, HtmlElement, HtmlInputElement, HtmlSelectElement};

use crate::{
    features::groups::{
        actions::Groups,
        pad_view,
        rows::{listed, rows_html},
    },
    model::{
        guards::{group_drive_blocked_by, side_change_blocked_by, stop_blocked_by},
        names_and_sides::{GroupMembers, NamesAndSides, Side},
        page::Page,
        snapshot::Session,
        tool_entry,
    },
    ui::{
        button::PressButton,
        entry, format,
        list::replace_keeping_focus,
        listener::on_window,
        number_field::NumberField,
        panel::panel,
        reactive::{dynamic, effect, memo},
    },
};

const ROWS: &str = "group-motors";

/// A list with one row per motor.
fn rows_markup() -> String {
    let name = tr!("Motors in the group");
    format!(r#"<ul class="group-motors" id="group-motors" role="list" aria-label="{name}"></ul>"#)
}

/// Panel `Drive together`.
#[component]
pub(crate) fn TogetherPanel<M: IntoView + 'static>(
    groups: Groups,
    /// The measures of the vehicle, which another feature uses.
    measures: M,
) -> impl IntoView {
    let page = groups.page;
    let blocked = memo(move || {
        let members = page.motors.names.with(NamesAndSides::group_members);
        page.shown
            .with(|session| group_drive_blocked_by(session, &members))
    });
    let start_blocked_by = Signal::derive(move || blocked.get().or_else(|| groups.speed.trouble()));
    let stage = memo(move || {
        let members = page.motors.names.with(NamesAndSides::group_members);
        page.shown.with(|session| stage_of_start(session, &members))
    });
    let halt_blocked_by = page.of_motor(|session, _| stop_blocked_by(session));
    update_rows(groups);
    pad_view::attach_handlers(groups);
    panel(
        "place together",
        tr!("Drive together"),
        move || page.shows_group(),
        None,
        view! {
            <div class="together-panel">
                <NumberField
                    id="group-speed"
                    name=tr!("Group speed")
                    unit=format::rpm()
                    hint=tr!("Right wheels are mirrored. Maximum for the drive pad.")
                    target=groups.speed
                    entry=entry::SPEED
                    limit=Box::leak(Box::new(move || page.speed_limit()))
                    on_edit=move || groups.adjust_together()
                />
                <div class="button-row two">
                    <PressButton
                        label=tr!("Stop group")
                        class="button halt"
                        hint=tr!("Brakes the group to a standstill: the last frames are brakes")
                        disabled_reason=halt_blocked_by
                        on_press=move || groups.stop_together()
                    />
                    <PressButton
                        label=tr!("Start group")
                        class="button primary"
                        disabled_reason=start_blocked_by
                        on_press=move || groups.start_together()
                    />
                </div>
                <p class="quiet field-words" role="status">{dynamic(move || stage.get())}</p>
                <div inner_html=pad_view::markup()></div>
                <div inner_html=rows_markup()></div>
                <NumberField
                    id="ramp"
                    name=tr!("Ramp")
                    unit=tr!("rpm/s")
                    hint=tr!("0 = off. Never applied to stops.")
                    target=page.settings.ramp
                    entry=tool_entry::RAMP
                    on_edit=move || page.set_ramp()
                />
                {measures}
            </div>
        },
    )
}

/// What the start of these motors waits for; nothing if it does not wait.
fn stage_of_start(session: &Session, members: &GroupMembers) -> Option<String> {
    let mut motors = members.iter().filter_map(|(id, _)| session.motor(*id));
    let is_waiting =
        !members.is_empty() && motors.all(|motor| motor.waiting.is_some() && is_stopping(motor));
    is_waiting.then(|| tr!("Stopping the wheels, then the group starts.").to_owned())
}

fn is_stopping(motor: &MotorStatus) -> bool {
    matches!(motor.activity, Activity::Stopping { .. })
}

/// Updates the rows and handles changes in them.
fn update_rows(groups: Groups) {
    let page = groups.page;
    let names = page.motors.names;
    let ids = memo(move || {
        let found = page.shown.with(Session::found);
        names.with(|names| listed(&found, names))
    });
    // The side of a driven motor cannot change.
    let held = memo::<Vec<MotorId>>(move || {
        let held = |session: &Session| session.active_motors().map(|motor| motor.id).collect();
        page.shown.with(held)
    });
    let mut made = None;
    effect(move || {
        held.track();
        let wanted = (ids.get(), page.motors.replaced.get());
        let list = document().get_element_by_id(ROWS);
        if let Some(list) = list.and_then(|list| list.dyn_into::<HtmlElement>().ok()) {
            // A row updates its own content: the user may be typing there.
            if made.as_ref() != Some(&wanted) {
                let html = names.with_untracked(|names| rows_html(&wanted.0, names));
                replace_keeping_focus(&list, &html, "id");
            }
            hold_sides(page, &wanted.0);
            made = Some(wanted);
        }
    });
    on_window("input", move |event: Event| {
        let control = event.target().and_then(|at| at.dyn_into::<Element>().ok());
        let ours = control.filter(|control| matches!(control.closest(".group-row"), Ok(Some(_))));
        if let Some(control) = ours {
            take_in(groups, &control);
        }
    });
}

/// Enables or disables each list of sides, with the reason.
fn hold_sides(page: Page, ids: &[MotorId]) {
    for id in ids {
        let list = document().get_element_by_id(&format!("side-{}", id.get()));
        let Some(list) = list.and_then(|list| list.dyn_into::<HtmlSelectElement>().ok()) else {
            continue;
        };
        let shown = |session: &Session| side_change_blocked_by(session, *id);
        let reason = page.shown.with_untracked(shown).unwrap_or_default();
        list.set_disabled(!reason.is_empty());
        list.set_title(&reason);
    }
}

/// Handles a change of a row's control: `drive-1`, `name-1` or `side-1`.
fn take_in(groups: Groups, control: &Element) {
    let page = groups.page;
    let name = control.id();
    let Some((what, id)) = name.split_once('-') else {
        return;
    };
    let Ok(id) = id.parse::<MotorId>() else {
        return;
    };
    if let Some(list) = control.dyn_ref::<HtmlSelectElement>() {
        page.set_side(id, Side::from_key(&list.value()).unwrap_or_default());
        let side = page.motors.names.with_untracked(|names| names.side(id));
        list.set_value(side.key());
    } else if let Some(input) = control.dyn_ref::<HtmlInputElement>() {
        page.change_member(id, |member| {
            if what == "drive" {
                member.drives = input.checked();
            } else {
                member.set_name(&input.value());
            }
        });
    }
}
