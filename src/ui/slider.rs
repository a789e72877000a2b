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
    /// Where it ends on both sides of zero, if not at the ends of the range.
    #[prop(optional)]
    limit: Option<&'static (dyn Fn() -> i32 + Sync)>,
    /// By how much an arrow key changes the value.
    #[prop(default = "1")]
    step: &'static str,
    /// The labels below it: see [`marks`].
    #[prop(into)]
    marks: Signal<String>,
    /// Called with every new value that the user enters here.
    #[prop(into)]
    on_edit: Callback<()>,
) -> impl IntoView {
    let range = move || {
        let limit = limit.map_or(i32::MAX, |limit| limit());
        (entry.min.max(-limit), entry.max.min(limit))
    };
    let ends = move || filled(range(), target.get());
    view! {
        <div class="slider-box">
            <input
                type="range"
                class="slider"
                class:from-middle=entry.min < 0
                aria-label=name
                min=dynamic(move || range().0.to_string())
                max=dynamic(move || range().1.to_string())
                step=step
                aria-valuetext=dynamic(move || format!("{} {unit}", (entry.show)(target.get())))
                prop:value=dynamic(move || {
                    // A browser keeps the value in the range that the element had.
                    range();
                    target.get().to_string()
                })
                style=("--from", dynamic(move || format!("{:.2}%", ends().0)))
                style=("--to", dynamic(move || format!("{:.2}%", ends().1)))
                on:input=handler(move |event| {
                    if let Ok(value) = event_target_value(&event).parse::<i32>() {
                        let (min, max) = untrack(range);
                        target.set(value.clamp(min, max));
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
fn filled((min, max): (i32, i32), value: i32) -> (f64, f64) {
    let span = f64::from(max) - f64::from(min);
    let place = |value: i32| (f64::from(value.clamp(min, max)) - f64::from(min)) / span * 100.0;
    let zero = place(0);
    let value = place(value);
    (zero.min(value), zero.max(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::entry::{POSITION, SPEED};

    #[test]
    fn the_filled_part_begins_at_zero() {
        let speed = (SPEED.min, SPEED.max);
        assert_eq!(filled(speed, 380), (50.0, 100.0));
        assert_eq!(filled(speed, -190), (25.0, 50.0));
        assert_eq!(filled(speed, 0), (50.0, 50.0));
        assert_eq!(filled((POSITION.min, POSITION.max), 32_767), (0.0, 100.0));
        assert_eq!(filled((-60, 60), -330), (0.0, 50.0), "ends at the limit");
    }
}
