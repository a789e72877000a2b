//! Panel `Raw Hex`.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Refusal, is_hazardous, unassignable_id},
    protocol::Layout,
};

use crate::{
    features::raw::{
        actions::Raw,
        cells,
        editor::{Entered, Outcome},
        texts,
    },
    model::{
        guards::{send_blocked_by, stop_blocked_by},
        place::Place,
        snapshot::Reading,
        terms, tool_entry,
    },
    ui::{
        button::PressButton,
        number_field::NumberField,
        panel::panel,
        reactive::{dynamic, handler, memo},
    },
};

#[component]
pub(crate) fn RawHexPanel(raw: Raw) -> impl IntoView {
    let entered = memo(move || {
        let entered = raw.text.with(|text| Entered::read(text));
        entered.for_model(raw.page.model.get())
    });
    let page = raw.page;
    panel(
        "panel place second raw-hex",
        tr!("Raw Hex"),
        move || page.place() == Place::Diagnose,
        None,
        view! {
            <Bytes raw entered />
            <div class="repeat">
                <label class="check">
                    <input
                        type="checkbox"
                        prop:checked=dynamic(move || raw.repeats.get())
                        on:change=handler(move |event| raw.repeats.set(event_target_checked(&event)))
                    />
                    {tr!("Repeat")}
                </label>
                <NumberField
                    id="count"
                    name=tr!("Count")
                    hint=tr!("0 = until stopped")
                    target=raw.count
                    entry=tool_entry::COUNT
                    on_edit=|| ()
                />
                <NumberField
                    id="interval"
                    name=tr!("Interval")
                    unit="ms"
                    hint=tr!("2 to 60\u{202F}000 ms")
                    target=raw.interval
                    entry=tool_entry::INTERVAL
                    on_edit=|| ()
                />
            </div>
            <div class="send-and-answer">
                <Sending raw entered />
                <Answer raw entered />
            </div>
        },
    )
}

/// The textbox, the bytes in it with their meaning, and the meaning of the frame.
#[component]
fn Bytes(raw: Raw, entered: Memo<Entered>) -> impl IntoView {
    let page = raw.page;
    let text = raw.text;
    let wrong = memo(move || matches!(entered.get().outcome(), Outcome::Wrong(_)));
    let chosen = page.of_motor(|session, id| {
        let mode = session.mode(id).filter(Reading::is_fresh)?;
        Some((id, mode.value))
    });
    let words = move || entered.with(|entered| texts::meaning(entered, chosen.get()));
    view! {
        <div class="raw-head">
            <label class="field-name" for="frame-bytes" aria-hidden="true">
                {tr!("Frame bytes")}
            </label>
            <PressButton
                label=tr!("Feedback query")
                class="button small"
                hint=tr!("Inserts a feedback query for the selected motor")
                on_press=move || raw.write_example(Layout::Query)
            />
            <PressButton
                label=tr!("ID query")
                class="button small"
                hint=tr!("Inserts the ID query to all motors")
                on_press=move || raw.write_example(Layout::Drive)
            />
        </div>
        <textarea
            id="frame-bytes"
            class="frame-bytes"
            rows="2"
            spellcheck="false"
            autocomplete="off"
            autocapitalize="off"
            placeholder="01 74 00 00 00 00 00 00 00"
            aria-label=tr!("Frame bytes")
            aria-describedby="frame-words"
            aria-invalid=dynamic(move || if wrong.get() { "true" } else { "false" })
            prop:value=dynamic(move || text.get())
            on:input=handler(move |event| {
                text.set(event_target_value(&event));
                // It was about other bytes.
                raw.refused.set(None);
            })
        ></textarea>
        <output
            class="cells"
            aria-label=tr!("Frame with CRC")
            aria-live="off"
            inner_html=dynamic(move || entered.with(cells::cells))
        ></output>
        // Screen readers do not announce missing bytes while the user types.
        <p
            id="frame-words"
            class="frame-words"
            // Long texts scroll within two lines, by keyboard too.
            tabindex="0"
            class:bad=wrong
            aria-live=dynamic(move || if wrong.get() { "polite" } else { "off" })
        >
            {dynamic(words)}
        </p>
    }
}

/// Buttons `Send` and `Stop`.
#[component]
fn Sending(raw: Raw, entered: Memo<Entered>) -> impl IntoView {
    let page = raw.page;
    let frame = memo(move || entered.with(Entered::frame));
    let blocked = page.of_motor(|session, _| send_blocked_by(session, false));
    let blocked_hazard = page.of_motor(|session, _| send_blocked_by(session, true));
    let stop_blocked_by = page.of_motor(|session, _| stop_blocked_by(session));
    let disabled_reason = Signal::derive(move || {
        let Some(frame) = frame.get() else {
            let missing = || Some(tr!("Enter 9 or 10 bytes.").to_owned());
            return blocked.get().or_else(missing);
        };
        let blocked = if is_hazardous(&frame) {
            blocked_hazard
        } else {
            blocked
        };
        if let Some(id) = unassignable_id(&frame) {
            return Some(terms::refusal(Refusal::NotAssignable(id)));
        }
        let trouble = || raw.count.trouble().or_else(|| raw.interval.trouble());
        let repeats = move || raw.repeats.get();
        blocked.get().or_else(|| trouble().filter(|_| repeats()))
    });
    let runs = page.of_motor(|session, _| session.left_by_raw_frame().next().is_some());
    let stop = Signal::derive(move || {
        let stop = if runs.get() {
            tr!("Stop it")
        } else {
            tr!("Stop")
        };
        stop.to_owned()
    });
    view! {
        <div class="send">
            <PressButton
                label=tr!("Send")
                class="button primary"
                disabled_reason=disabled_reason
                on_press=move || {
                    if let Some(frame) = frame.get_untracked() {
                        raw.send_raw(frame);
                    }
                }
            />
            <PressButton
                label=stop
                class="button halt"
                hint=tr!("Stops sending, and stops any motor the frame may have moved")
                disabled_reason=stop_blocked_by
                on_press=move || raw.stop_raw()
            />
        </div>
    }
}

/// The result of the last frame, while it is the entered one or repeats.
#[component]
fn Answer(raw: Raw, entered: Memo<Entered>) -> impl IntoView {
    let page = raw.page;
    let refused = raw.refused;
    let unconnected = page.of_motor(|session, _| send_blocked_by(session, false));
    let last = page.of_motor(|session, _| session.raw);
    let shown = memo(move || {
        let frame = entered.with(Entered::frame);
        last.get()
            .filter(|last| last.running || frame == Some(last.frame))
    });
    let sent = memo(move || shown.get().map(|last| texts::sent(&last)));
    let answer = memo(move || {
        shown
            .get()
            .map(|last| texts::answer(&last, page.model.get()))
    });
    let not_sent = move || refused.with(Option::is_some);
    let title = move || {
        if not_sent() {
            return tr!("The frame was not sent").to_owned();
        }
        let otherwise = || tr!("The reply appears here").to_owned();
        sent.get()
            .or_else(|| unconnected.get())
            .unwrap_or_else(otherwise)
    };
    let runs = page.of_motor(|session, _| session.left_by_raw_frame().next().is_some());
    let words = move || {
        let mut words = refused.get().or_else(|| answer.get()).unwrap_or_default();
        if runs.get() {
            words.push('\n');
            words.push_str(tr!(
                "The motor may keep this frame: it runs until it is stopped."
            ));
        }
        words
    };
    view! {
        <output class="answer" class:bad=dynamic(not_sent) aria-label=tr!("Reply") aria-live="off">
            <span class="answer-title">{dynamic(title)}</span>
            <span class="answer-words">{dynamic(words)}</span>
        </output>
    }
}
