//! The list of faults with their times, until the user marks them as seen.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::MotorId;

use crate::{
    features::telemetry::{
        fault_history::{End, FaultHistory, Occurrence},
        readings::Readings,
    },
    ui::{
        button::PressButton,
        clock::local_time,
        reactive::{dynamic, memo},
    },
};

/// Number of faults that fit.
const LINES_MAX: usize = 3;

/// The faults, and the button that marks them as seen.
#[component]
pub(crate) fn FaultRecord(readings: Readings) -> impl IntoView {
    let page = readings.page;
    let lines = memo(move || {
        let id = page.selected.get();
        readings
            .faults
            .with(|history| lines(history, id, local_time).join("\n"))
    });
    let unseen = memo(move || {
        let id = page.selected.get();
        readings.faults.with(|history| history.has_unseen(id))
    });
    let disabled_reason = move || (!unseen.get()).then(|| tr!("No unseen faults").to_owned());
    let mark_seen = move || {
        let id = page.selected.get_untracked();
        readings
            .faults
            .maybe_update(|history| history.mark_seen(id));
    };
    view! {
        <div class="fault-record" class:unseen=dynamic(move || unseen.get())>
            <output aria-label=tr!("Fault record") aria-live="off">
                {dynamic(move || lines.get())}
            </output>
            <PressButton
                label=tr!("Acknowledge")
                class="button small"
                disabled_reason=Signal::derive(disabled_reason)
                on_press=mark_seen
            />
        </div>
    }
}

/// One line per fault, and the number of those that do not fit.
fn lines(history: &FaultHistory, id: MotorId, time: impl Fn(f64) -> String) -> Vec<String> {
    let occurrences = history.of(id);
    let all = occurrences.len() + history.dropped(id);
    if all == 0 {
        return vec![tr!("No faults recorded").to_owned()];
    }
    let told = if all > LINES_MAX { LINES_MAX - 1 } else { all };
    let mut lines: Vec<String> = occurrences
        .iter()
        .take(told)
        .map(|occurrence| line(occurrence, &time))
        .collect();
    if let Some(first) = lines.first_mut() {
        *first = tr!("Last: {fault}", fault = first);
    }
    if all > told {
        lines.push(tr!("and {count} more", count = all - told));
    }
    lines
}

/// `stall, 13:02:11 – 13:02:16`
fn line(occurrence: &Occurrence, time: impl Fn(f64) -> String) -> String {
    let (name, came) = (occurrence.name(), time(occurrence.came_ms));
    match occurrence.end {
        End::Active => tr!("{fault}, since {came}", fault = name, came),
        End::Gone(ms) => format!("{name}, {came} – {}", time(ms)),
        End::Unknown => tr!("{fault}, {came} – unknown", fault = name, came),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::Faults;

    use super::*;

    const ID: MotorId = MotorId::FIRST;
    const STALL: Faults = Faults::from_byte(0x08);
    const HOT: Faults = Faults::from_byte(0x10);

    fn told(history: &FaultHistory) -> Vec<String> {
        lines(history, ID, |ms| format!("13:02:{ms}"))
    }

    #[test]
    fn a_fault_is_told_with_when_it_came_and_went() {
        let mut history = FaultHistory::default();
        assert_eq!(told(&history), ["No faults recorded"]);
        history.on_report(ID, STALL, 11.0);
        assert_eq!(told(&history), ["Last: stall, since 13:02:11"]);
        history.on_report(ID, Faults::NONE, 16.0);
        assert_eq!(told(&history), ["Last: stall, 13:02:11 – 13:02:16"]);
        history.on_report(ID, HOT, 20.0);
        history.end_unknown(None);
        assert_eq!(
            told(&history),
            [
                "Last: over-temperature, 13:02:20 – unknown",
                "stall, 13:02:11 – 13:02:16"
            ]
        );
    }

    #[test]
    fn three_are_told_and_of_more_how_many() {
        let mut history = FaultHistory::default();
        for place in 1..=3_u8 {
            let at_ms = f64::from(place) * 2.0;
            history.on_report(ID, STALL, at_ms);
            history.on_report(ID, Faults::NONE, at_ms + 1.0);
        }
        assert_eq!(told(&history).len(), 3);
        assert_eq!(told(&history)[2], "stall, 13:02:2 – 13:02:3");
        for at_ms in [10.0, 12.0, 14.0] {
            history.on_report(ID, STALL, at_ms);
            history.on_report(ID, Faults::NONE, at_ms + 1.0);
        }
        assert_eq!(told(&history).len(), 3);
        assert_eq!(told(&history)[0], "Last: stall, 13:02:14 – 13:02:15");
        assert_eq!(told(&history)[2], "and 4 more");
        for place in 0..30_u8 {
            history.on_report(ID, HOT, 20.0 + f64::from(place));
            history.on_report(ID, Faults::NONE, 20.5 + f64::from(place));
        }
        assert_eq!(told(&history)[2], "and 34 more");
    }
}
