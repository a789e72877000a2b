//! Tab `Current`.

use leptos::prelude::*;
use motorlink_i18n::{terms::in_language, tr};
use motorlink_messages::{
    bus::HIGH_CURRENT_RAW,
    protocol::{CurrentTarget, Mode, family::Model},
};

use crate::{
    features::drive::{
        actions::Drive,
        limit::{LimitLink, Quantity, current_limit},
        loop_panel::{loop_blocked_by, loop_panel, loop_start_blocked_by},
        stop_and_start::stop_and_start,
    },
    model::page::Page,
    ui::{
        button::PressButton,
        entry, format,
        number_field::NumberField,
        reactive::dynamic,
        slider::{Slider, marks},
    },
};

const MODE: Mode = Mode::Current;

/// Full scale of the page's raw numbers in mA.
const FULL_SCALE_MA: i32 = 8_000;

/// The raw number of the page for a current in mA.
const fn raw_of(milliamps: i32) -> i32 {
    milliamps * CurrentTarget::MAX / FULL_SCALE_MA
}

/// Amps of the preset buttons, what they read and what they are called.
const PRESETS: [(f32, &str, &str); 7] = [
    (-2.0, "−2 A", "-2 A"),
    (-1.0, "−1 A", "-1 A"),
    (-0.5, "−0.5 A", "-0.5 A"),
    (0.0, "0 A", "0 A"),
    (0.5, "+0.5 A", "+0.5 A"),
    (1.0, "+1 A", "+1 A"),
    (2.0, "+2 A", "+2 A"),
];

#[component]
pub(crate) fn CurrentTab(drive: Drive) -> impl IntoView {
    let page = drive.page;
    let current = drive.targets.current;
    let disabled_reason = loop_blocked_by(page, MODE);
    let start_blocked_by = loop_start_blocked_by(page, MODE, [current]);
    let raw_max = Box::leak(Box::new(move || raw_of(page.current_max_ma())));
    // Of the others no figure is known.
    let torque = move || {
        let target = CurrentTarget::new(current.get()).unwrap_or_default();
        (page.model.get() == Model::Ddsm115).then(|| format::torque_of(target))
    };
    let hint = Signal::derive(move || {
        let (limit, amps) = current_limit(page);
        if current.get().unsigned_abs() > HIGH_CURRENT_RAW.into() {
            tr!("Above 6.1 A: confirm on Start").to_owned()
        } else if current.get().abs() > limit && limit < raw_of(page.current_max_ma()) {
            tr!(
                "Above your limit: a motor that draws more than {amps} A is stopped",
                amps
            )
        } else {
            String::new()
        }
    });
    let limit = Box::leak(Box::new(move || current_limit(page).0));
    let ends = Signal::derive(move || {
        let (_, amps) = current_limit(page);
        marks([&format!("−{amps} A"), "0", &format!("+{amps} A")])
    });
    let preset = move |(amps, label, name): (f32, &'static str, &'static str)| {
        view! {
            <PressButton
                label=in_language(label.to_owned())
                name=name
                class="button preset"
                disabled_reason=disabled_reason
                on_press=move || {
                    current.set(CurrentTarget::from_amps(amps).into());
                    drive.start(MODE);
                }
            />
        }
    };
    let body = view! {
        <div class="amps-and-raw">
            <NumberField
                id="target-current"
                name=tr!("Target current")
                unit="A"
                hint=hint
                target=current
                entry=entry::AMPS
                limit=raw_max
                on_edit=move || drive.adjust(MODE)
            />
            <NumberField
                id="raw-current"
                name=tr!("Raw current")
                unit=tr!("raw")
                hint=raw_range(page)
                target=current
                entry=entry::CURRENT
                limit=raw_max
                on_edit=move || drive.adjust(MODE)
            />
        </div>
        <Slider
            name=tr!("Target current")
            unit="A"
            target=current
            entry=entry::AMPS
            limit=limit
            marks=ends
            on_edit=move || drive.adjust(MODE)
        />
        <LimitLink page quantity=Quantity::Current />
        <p class="equals" hidden=dynamic(move || torque().is_none())>
            "≈ "
            <output aria-label=tr!("Target torque") aria-live="off">
                {dynamic(torque)}
            </output>
        </p>
        <div class="button-row amps">{PRESETS.map(preset).collect_view()}</div>
        <div class="button-row two">
            {stop_and_start(drive, MODE, tr!("In the current loop: 0 A, the wheel coasts"), start_blocked_by)}
        </div>
    };
    let hint = tr!("In the current loop, Stop sets 0 A: the wheel coasts. STOP brakes it.");
    loop_panel(drive, MODE, start_blocked_by, hint.to_owned().into(), body)
}

/// What the raw numbers mean.
fn raw_range(page: Page) -> Signal<String> {
    let mirrored = page.of_motor(|session, id| session.mirror(id).is_mirrored());
    Signal::derive(move || {
        let max_ma = page.current_max_ma();
        if max_ma < FULL_SCALE_MA {
            tr!(
                "±{raw} = ±{amps} A; the motor's own raw numbers differ",
                raw = raw_of(max_ma),
                amps = max_ma / 1_000
            )
        } else if mirrored.get() {
            tr!("±32\u{202F}767 = ±8 A; mirrored").to_owned()
        } else {
            tr!("±32\u{202F}767 = ±8 A").to_owned()
        }
    })
}
