//! Arm, run, pause and abort. Arming shows what will move, how far and for how long; only `Run` starts motion.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::experiments::{
    plan::PlanMotor,
    runner::{Phase, SilentSteps},
    sequence::Quantity,
};

use crate::{
    features::experiments::{
        state::{Armed, Experiments, Shown},
        texts,
    },
    model::{names_and_sides::NamesAndSides, page::Page, terms},
    ui::{
        button::PressButton,
        format,
        reactive::{dynamic, effect, handler},
    },
};

/// The setpoints a second that a run can have.
const RATES: [u32; 4] = [50, 100, 200, 500];

/// Rate, and whether a lost focus ends the run.
#[component]
pub(super) fn RunSettings(of: Experiments) -> impl IntoView {
    let option = move |rate: u32| {
        let selected = move || of.rate.get() == rate;
        view! {
            <option value=rate.to_string() selected=dynamic(selected)>
                {format!("{rate} Hz")}
            </option>
        }
    };
    let choose = move |event| {
        if let Ok(rate) = event_target_value(&event).parse::<u32>() {
            of.rate.set(rate);
        }
    };
    let check = move |event| of.stop_on_lost_focus.set(event_target_checked(&event));
    view! {
        <div class="run-settings">
            <label class="ask-field">
                <span class="field-name">{tr!("Setpoints a second")}</span>
                <select on:change=handler(choose)>{RATES.map(option).collect_view()}</select>
            </label>
            <label class="check">
                <input
                    type="checkbox"
                    prop:checked=dynamic(move || of.stop_on_lost_focus.get())
                    on:change=handler(check)
                />
                {tr!("Stop when the page loses the focus")}
            </label>
        </div>
    }
}

/// The buttons, and what the run does.
#[component]
pub(super) fn RunBar(of: Experiments) -> impl IntoView {
    // The result of a run is not said as one of another study.
    effect(move || {
        let kind = of.kind();
        if kind.is_some() && untrack(|| has_ended(of) && is_of_another(of)) {
            of.said.set(String::new());
        }
    });
    let phase = move || of.shown.get().phase();
    let is_driving = move || of.shown.get().is_driving();
    let is_armed = move || of.armed_for().is_some_and(|seconds| seconds > 0);
    let arm_blocked_by = move || of.blocked_by().map(|(reason, _)| reason);
    let run_blocked_by = move || {
        (!is_armed()).then(|| {
            if is_driving() {
                tr!("It is running.").to_owned()
            } else {
                tr!("Press Arm first, and read what will move.").to_owned()
            }
        })
    };
    let pause_blocked_by = move || (!is_driving()).then(|| tr!("No run is running.").to_owned());
    let pause_label = move || {
        if phase() == Some(Phase::Paused) {
            tr!("Resume").to_owned()
        } else {
            tr!("Pause").to_owned()
        }
    };
    let abort_blocked_by = move || {
        (!is_driving() && of.armed_for().is_none())
            .then(|| tr!("No run is armed or running.").to_owned())
    };
    let hint = move || match of.blocked_by() {
        Some((reason, _)) if !is_driving() => reason,
        _ => String::new(),
    };
    let helps = move || of.blocked_by().and_then(|(_, switch)| switch);
    let switch = move || {
        helps().map(|(id, mode)| {
            let label = tr!(
                "Switch motor {id} to the {mode}",
                id,
                mode = terms::mode(mode)
            );
            view! {
                <PressButton
                    label
                    class="button small"
                    on_press=move || of.switch(id, mode)
                />
            }
        })
    };
    view! {
        <div class="run-bar">
            <div class="run-armed" hidden=dynamic(move || !is_armed())>
                {move || of.armed.get().map(|armed| summary(of.page, &armed))}
                <p>{dynamic(move || countdown(of))}</p>
            </div>
            <p class="run-state" role="status" aria-label=tr!("Run" as "experiment")>
                {dynamic(move || state_words(of))}
            </p>
            <p class="run-hint">{dynamic(hint)}</p>
            {switch}
            <p class="run-said" role="status" aria-label=tr!("Result of the run")>
                {dynamic(move || of.said.get())}
            </p>
            <div class="run-buttons">
                <PressButton
                    label=tr!("Arm")
                    hint=tr!("Shows what will move. Nothing moves yet.")
                    disabled_reason=Signal::derive(arm_blocked_by)
                    on_press=move || of.arm()
                />
                <PressButton
                    label=tr!("Run" as "start")
                    class="button primary"
                    hint=tr!("Starts motion.")
                    disabled_reason=Signal::derive(run_blocked_by)
                    on_press=move || of.start()
                />
                <PressButton
                    label=Signal::derive(pause_label)
                    hint=tr!("Speeds and currents become zero, angles are held.")
                    disabled_reason=Signal::derive(pause_blocked_by)
                    on_press=move || of.pause_or_resume()
                />
                <PressButton
                    label=tr!("Abort")
                    hint=tr!("Ends the run and stops its motors, or disarms it.")
                    disabled_reason=Signal::derive(abort_blocked_by)
                    on_press=move || of.abort()
                />
            </div>
        </div>
    }
}

/// Whether a run has driven, and has ended.
fn has_ended(of: Experiments) -> bool {
    match of.shown.get() {
        Shown::Reported(state) => state.began.is_some() && matches!(state.phase, Phase::Ended(_)),
        Shown::Idle | Shown::Asked => false,
    }
}

/// Whether the last armed run is of another study than the open tab.
fn is_of_another(of: Experiments) -> bool {
    let kind = of.kind();
    of.armed.with(|armed| {
        armed
            .as_ref()
            .is_some_and(|armed| Some(armed.study.kind()) != kind)
    })
}

fn countdown(of: Experiments) -> String {
    let seconds = of.armed_for().unwrap_or_default();
    tr!("Run starts motion. Armed for {seconds} s.", seconds)
}

/// `Running: 12 s of at most 38 s`
fn state_words(of: Experiments) -> String {
    let Shown::Reported(state) = of.shown.get() else {
        return String::new();
    };
    if has_ended(of) && is_of_another(of) {
        return String::new();
    }
    let armed = of.armed.get();
    let longest = armed.as_ref().map_or(0.0, |armed| armed.plan.longest_s());
    let passed = format::in_language(format!("{:.1} s", state.passed.as_secs_f64()));
    let longest = texts::duration(longest);
    match state.phase {
        Phase::Armed { .. } if of.armed_for() == Some(0) => {
            tr!("Armed over a minute ago. Press Arm again.").to_owned()
        }
        Phase::Armed { .. } => tr!("Armed. Read what will move, then press Run.").to_owned(),
        Phase::Running => tr!("Running: {passed} of at most {longest}", passed, longest),
        Phase::Paused => tr!("Paused at {passed} of at most {longest}", passed, longest),
        Phase::Ended(_) => tr!("Ended after {passed}", passed),
    }
}

/// What will move, how far, for how long, and what ends it.
fn summary(page: Page, armed: &Armed) -> impl IntoView + use<> {
    let plan = &armed.plan;
    let motors = plan.motors().iter();
    let lines: Vec<String> = motors.map(|motor| motor_line(page, motor)).collect();
    let time = texts::duration(plan.longest_s());
    let time = if plan.has_conditions() {
        tr!("It takes at most {time}.", time)
    } else {
        tr!("It takes {time}.", time)
    };
    let rate = rate(armed);
    let limits = tr!("Limits: {limits}.", limits = texts::limits(armed.limits));
    let mut ends = tr!("STOP, Space, Esc, a fault, lost replies or a limit ends it.").to_owned();
    if armed.options.stop_on_lost_focus {
        ends = format!("{ends} {}", tr!("Leaving this page ends it too."));
    }
    let silence = (armed.options.silent_steps != SilentSteps::NONE).then(|| {
        let words = tr!(
            "Frames cease for 0.6 s, twice. The wheel may keep turning meanwhile; STOP works at once."
        );
        view! { <p>{words}</p> }
    });
    let lines = lines.into_iter().map(|line| view! { <li>{line}</li> });
    view! {
        <h3>{tr!("Armed. This will move:")}</h3>
        <ul class="run-motors">{lines.collect_view()}</ul>
        <p>{time} " " {rate}</p>
        {silence}
        <p>{limits}</p>
        <p>{ends}</p>
    }
}

/// What was asked for, and what the line carries of it.
fn rate(armed: &Armed) -> String {
    let asked = 1_000_000 / armed.options.period.as_micros().max(1);
    match armed.carried {
        Some(carried) if carried.hertz < f64::from(u32::try_from(asked).unwrap_or(u32::MAX)) => {
            tr!(
                "{asked} setpoints a second for each motor are asked for. The line carries {rate}.",
                asked,
                rate = texts::rate(carried)
            )
        }
        _ => tr!("{asked} setpoints a second for each motor.", asked),
    }
}

/// `Motor 0x01 · front left: −100 to +100 rpm, velocity loop`. A position run also moves from the present angle to the
/// first one.
fn motor_line(page: Page, motor: &PlanMotor) -> String {
    let named = |names: &NamesAndSides| names.named(motor.id);
    let named = page.motors.names.with_untracked(named);
    let mode = terms::mode(motor.mode());
    let unit = texts::unit(motor.quantity);
    let (least, greatest) = (texts::signed(motor.least), texts::signed(motor.greatest));
    if motor.quantity == Quantity::Degrees {
        return tr!(
            "Motor {named}: from its present angle to between {least} and {greatest} {unit}, {mode}",
            named,
            least,
            greatest,
            unit,
            mode
        );
    }
    tr!(
        "Motor {named}: {least} to {greatest} {unit}, {mode}",
        named,
        least,
        greatest,
        unit,
        mode
    )
}
