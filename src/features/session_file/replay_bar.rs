//! Region `Replay`: the controls of a replay, at the lower edge of the page while a recording is shown.

use leptos::{mount::mount_to, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::{
    recorder::{Kind, Row},
    sessions::{PlaySpeed, SessionInfo},
};
use wasm_bindgen::JsCast;
use web_sys::{HtmlElement, KeyboardEvent};

use crate::{
    features::session_file::{
        bookmark_form::bookmark_form, bookmarks::Bookmarks, player::Player, texts, timeline::strip,
    },
    ui::{
        button::PressButton,
        format::in_language,
        reactive::{dynamic, effect, handler, memo},
    },
};

/// How far an arrow key goes on the timeline, and how far Page Up and Page Down.
const ARROW_US: i64 = 1_000_000;
const PAGE_US: i64 = 10_000_000;

/// The title of a page that drives nothing.
const TITLE: &str = "MotorLink";

/// Mounts the controls for the life of the page. They are not in a section, which another language would remove.
pub(super) fn show_bar(owner: &Owner, player: Player) {
    let page = document().query_selector(".page").ok().flatten();
    let Some(page) = page.and_then(|page| page.dyn_into::<HtmlElement>().ok()) else {
        return;
    };
    let mounted = owner.with(|| {
        mount_to(page, move || {
            move || {
                player.page.language.track();
                let info = player.info.get();
                if info.is_some() {
                    request_animation_frame(enter);
                }
                info.map(|info| bar(player, &info))
            }
        })
    });
    mounted.forget();
    owner.with(|| {
        let mut shown = false;
        effect(move || {
            player.page.language.track();
            let info = player.info.get();
            // Before, and after it, the title is that of the live line.
            if shown || info.is_some() {
                show_name(info.as_deref());
            }
            shown = info.is_some();
        });
    });
}

/// Shows the name of the recording in the title of the page and beside the state of the connection. The style sheet
/// draws it there: the header loads first, and knows nothing of recordings.
fn show_name(info: Option<&SessionInfo>) {
    let title = info.map(|info| format!("{}: {} - {TITLE}", tr!("Replay"), info.name));
    document().set_title(title.as_deref().unwrap_or(TITLE));
    let root = document().document_element();
    let Some(root) = root.and_then(|root| root.dyn_into::<HtmlElement>().ok()) else {
        return;
    };
    let name = info.map_or_else(String::new, |info| css_string(&info.name));
    // It fails for no text.
    let _ = root.style().set_property("--replay-name", &name);
}

/// A text as a string of a style sheet.
fn css_string(text: &str) -> String {
    let mut quoted = String::from("\"");
    for sign in text.chars().filter(|sign| !sign.is_control()) {
        if matches!(sign, '"' | '\\') {
            quoted.push('\\');
        }
        quoted.push(sign);
    }
    quoted.push('"');
    quoted
}

fn bar(player: Player, info: &SessionInfo) -> impl IntoView + use<> {
    let duration_us = info.duration_us;
    let at = move || texts::elapsed(player.shown_us());
    let halted = memo(move || player.page.shown.with(|session| session.halted));
    let name = info.name.clone();
    // Live, a dialog says it.
    let what = move || {
        if halted.get() {
            tr!("STOP is active until Release").to_owned()
        } else {
            name.clone()
        }
    };
    let pressed_key = move |event: KeyboardEvent| {
        let by_us = match event.key().as_str() {
            "ArrowRight" | "ArrowUp" => ARROW_US,
            "ArrowLeft" | "ArrowDown" => -ARROW_US,
            "PageUp" => PAGE_US,
            "PageDown" => -PAGE_US,
            _ => return,
        };
        event.prevent_default();
        player.seek_by(by_us);
    };
    let of_whole = tr!(
        "{place} of {whole}",
        place = "{}",
        whole = texts::elapsed(duration_us)
    );
    view! {
        <section class="replay" aria-label=tr!("Replay")>
            <p class="replay-what">
                <strong>{tr!("Replay")}</strong>
                " "
                <span class="replay-name">{dynamic(what)}</span>
            </p>
            <div class="replay-line">
                {strip(player, info)}
                <input
                    type="range"
                    class="replay-place"
                    aria-label=tr!("Place in the recording")
                    aria-valuetext=dynamic(move || of_whole.replace("{}", &at()))
                    min="0"
                    max=duration_us.to_string()
                    step="1"
                    prop:value=dynamic(move || player.shown_us().to_string())
                    on:input=handler(move |event| {
                        if let Ok(after_us) = event_target_value(&event).parse() {
                            player.seek(after_us);
                        }
                    })
                    on:keydown=handler(pressed_key)
                />
            </div>
            {steps(player)}
            <output class="replay-at" aria-label=tr!("Place")  aria-live="off">
                <span>{dynamic(at)}</span>
                <span class="quiet">" / " {texts::elapsed(duration_us)}</span>
            </output>
            {frame(player)}
            {bookmark_form(player)}
            <PressButton
                label=tr!("End replay")
                class="button small replay-end"
                on_press=move || {
                    player.end();
                    focus_controls();
                }
            />
            <p class="replay-trouble bad" role="status" aria-label=tr!("Replay")>
                {dynamic(move || {
                    let unreadable = player.unreadable.get();
                    unreadable.then(|| tr!("The file cannot be read. Check that it is still there, then press Play."))
                })}
            </p>
        </section>
    }
}

/// The last frame before the place that is shown.
fn frame(player: Player) -> impl IntoView {
    let part = move |pick: fn(&Row) -> String| {
        let text = move || player.frame.with(|frame| frame.as_ref().map(pick));
        dynamic(move || text().unwrap_or_default())
    };
    let direction = |row: &Row| if row.kind == Kind::Tx { "TX " } else { "RX " }.to_owned();
    view! {
        <output class="replay-frame" aria-label=tr!("Frame at the cursor") aria-live="off">
            <strong>{part(direction)}</strong>
            <span class="replay-hex">{part(|row| row.hex.clone())}</span>
            " "
            <span class="quiet">{part(|row| row.meaning.clone())}</span>
        </output>
    }
}

/// A button that shows a sign.
fn sign(
    label: &'static str,
    name: &'static str,
    act: impl Fn() + Send + Sync + 'static,
) -> impl IntoView {
    view! { <PressButton label=label name=name hint=name class="button small replay-sign" on_press=act /> }
}

/// The buttons that play and step, and the speed.
fn steps(player: Player) -> impl IntoView {
    let plays = move || player.place.with(|place| place.plays);
    let speeds: String = PlaySpeed::CHOICES.map(option).concat();
    view! {
        <div class="replay-steps">
            {sign("|◂", tr!("Previous event"), move || player.seek_event(false))}
            {sign("◂", tr!("Previous frame"), move || player.step(false))}
            <PressButton
                label=Signal::derive(move || {
                    let word = if plays() { tr!("Pause replay") } else { tr!("Play") };
                    word.to_owned()
                })
                class="button small replay-play"
                on_press=move || player.play_or_pause()
            />
            {sign("▸", tr!("Next frame"), move || player.step(true))}
            {sign("▸|", tr!("Next event"), move || player.seek_event(true))}
            <select
                class="select small"
                aria-label=tr!("Speed of the replay")
                title=tr!("Speed of the replay")
                prop:value=dynamic(move || player.speed.get().per_mille().to_string())
                on:change=handler(move |event| {
                    if let Ok(per_mille) = event_target_value(&event).parse() {
                        player.set_speed(PlaySpeed::from_per_mille(per_mille));
                    }
                })
                inner_html=speeds
            ></select>
            <PressButton
                label=tr!("Add bookmark")
                class="button small replay-add"
                disabled_reason=Signal::derive(move || {
                    player.bookmarks.with(Bookmarks::are_full).then(texts::bookmarks_full)
                })
                on_press=move || player.add_bookmark()
            />
        </div>
    }
}

fn option(per_mille: u32) -> String {
    let selected = if per_mille == 1_000 { " selected" } else { "" };
    format!(
        r#"<option value="{per_mille}"{selected}>{}</option>"#,
        name(per_mille)
    )
}

/// `0.25×`, `10×`
fn name(per_mille: u32) -> String {
    let (whole, rest) = (per_mille / 1_000, per_mille % 1_000 / 10);
    if rest == 0 {
        return format!("{whole}×");
    }
    let digits = format!("{whole}.{rest:02}");
    in_language([digits.trim_end_matches('0'), "×"].concat())
}

/// The button that began the replay ends it now. If it has the focus, the focus goes to Play.
fn enter() {
    let focused = document().active_element();
    if focused.is_some_and(|focused| focused.matches(".session-head .primary") == Ok(true)) {
        focus(".replay-play");
    }
}

/// The button that had the focus is gone.
fn focus_controls() {
    focus("#control");
}

fn focus(selector: &str) {
    let found = document().query_selector(selector).ok().flatten();
    if let Some(control) = found.and_then(|found| found.dyn_into::<HtmlElement>().ok()) {
        // If it cannot be focused, the browser decides.
        let _ = control.focus();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_one_string_of_a_style_sheet() {
        assert_eq!(css_string("run 2.mcap"), r#""run 2.mcap""#);
        assert_eq!(css_string("a\"b\\c\nd"), r#""a\"b\\cd""#);
    }

    #[test]
    fn speeds_are_short() {
        let names = PlaySpeed::CHOICES.map(name).join(" ");
        assert_eq!(names, "0.1× 0.5× 1× 10× 100×");
    }
}
