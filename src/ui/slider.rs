//! A slider over the whole range of a value.

use leptos::prelude::*;

use crate::ui::{
    entry::Entry,
    reactive::{dynamic, handler},
    target::Target,
};

/// A slider; its filled part begins at zero.
#[component]
pub(crate) fn Slider(
    /// Its accessible name.
    name: &'static str,
    /// The unit, for screen readers.
    unit: &'static str,
    /// The value.
    target: Target,
    /// Its range.
    entry: Entry,
    /// The labels below it: see [`marks`].
    #[prop(into)]
    marks: Signal<String>,
    /// Called with every new value that the user enters here.
    #[prop(into)]
    on_edit: Callback<()>,
) -> impl IntoView {
    let ends = move || filled(entry, target.get());
    view! {
        <div class="slider-box">
            <input
                type="range"
                class="slider"
                class:from-middle=entry.min < 0
                aria-label=name
                min=entry.min.to_string()
                max=entry.max.to_string()
                step="1"
                aria-valuetext=dynamic(move || format!("{} {unit}", (entry.show)(target.get())))
                prop:value=dynamic(move || target.get().to_string())
                style=("--from", dynamic(move || format!("{:.2}%", ends().0)))
                style=("--to", dynamic(move || format!("{:.2}%", ends().1)))
                on:input=handler(move |event| {
                    if let Ok(value) = event_target_value(&event).parse::<i32>() {
                        target.set(value.clamp(entry.min, entry.max));
                        on_edit.run(());
                    }
                })
            />
            <div class="slider-marks" aria-hidden="true" inner_html=dynamic(move || marks.get())></div>
        </div>
    }
}

/// The labels below a slider's left end, its middle and its right end, as HTML.
pub(crate) fn marks(words: [&str; 3]) -> String {
    words.map(|words| format!("<span>{words}</span>")).concat()
}

/// Both ends of the filled part in percent of the range.
fn filled(entry: Entry, value: i32) -> (f64, f64) {
    let span = f64::from(entry.max) - f64::from(entry.min);
    let place = |value: i32| (f64::from(value) - f64::from(entry.min)) / span * 100.0;
    let zero = place(0.clamp(entry.min, entry.max));
    let value = place(value);
    (zero.min(value), zero.max(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::entry::{POSITION, SPEED};

    #[test]
    fn the_filled_part_begins_at_zero() {
        assert_eq!(filled(SPEED, 330), (50.0, 100.0));
        assert_eq!(filled(SPEED, -165), (25.0, 50.0));
        assert_eq!(filled(SPEED, 0), (50.0, 50.0));
        assert_eq!(filled(POSITION, 32_767), (0.0, 100.0));
    }
}
