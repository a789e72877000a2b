//! The motor and the parameters of a study.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    experiments::study::{Study, StudyKind},
    protocol::{Acceleration, MotorId},
};
use web_sys::KeyboardEvent;

use crate::{
    features::experiments::{state::Experiments, texts},
    ui::{
        button::PressButton,
        reactive::{dynamic, effect, handler, memo},
    },
};

/// The parameter of a step that the page offers a value for.
const HOLD: &str = "hold_s";

/// The fields of the study that the tab shows.
#[component]
pub(super) fn StudyFields(of: Experiments) -> impl IntoView {
    let kind = memo(move || {
        of.kind()
            .filter(|kind| *kind != StudyKind::Sequence)
            .map(place_of)
    });
    view! {
        {move || {
            let kind = *StudyKind::ALL.get(kind.get()?)?;
            let names = of.studies.with_untracked(|studies| {
                let study = studies.iter().find(|study| study.kind() == kind);
                study.map(|study| parameters(study).into_iter().map(|(name, ..)| name).collect::<Vec<_>>())
            })?;
            let fields = names.into_iter().map(|name| view! { <ParameterField of kind name /> });
            let accelerations = (kind == StudyKind::Step)
                .then(|| view! { <Accelerations of /> <Hold of /> });
            Some(view! {
                <p class="experiment-advice">{texts::advice(kind)}</p>
                <MotorField of kind />
                <div class="ask-pairs">{fields.collect_view()}</div>
                {accelerations}
            })
        }}
    }
}

fn place_of(kind: StudyKind) -> usize {
    let place = StudyKind::ALL.iter().position(|other| *other == kind);
    place.unwrap_or_default()
}

/// The name, the value, the range and the wholeness of each parameter.
fn parameters(study: &Study) -> Vec<(&'static str, f64, (f64, f64), bool)> {
    let mut study = study.clone();
    let all = study.parameters();
    all.iter()
        .map(|one| (one.name, one.value(), one.range, one.is_whole()))
        .collect()
}

fn parameter(of: Experiments, kind: StudyKind, name: &str) -> Option<(f64, (f64, f64), bool)> {
    of.studies.with(|studies| {
        let study = studies.iter().find(|study| study.kind() == kind)?;
        let mut all = parameters(study).into_iter();
        let (_, value, range, is_whole) = all.find(|(other, ..)| *other == name)?;
        Some((value, range, is_whole))
    })
}

/// Whether the text of a field is no number. While the field is shown and wrong, nothing can be armed: the value before
/// would run.
fn wrong_text(of: Experiments, label: &'static str) -> RwSignal<bool> {
    let wrong = RwSignal::new(false);
    let remove = move || {
        of.wrong_fields
            .update(|fields| fields.retain(|it| *it != label));
    };
    effect(move || {
        remove();
        if wrong.get() {
            of.wrong_fields.update(|fields| fields.push(label));
        }
    });
    on_cleanup(remove);
    wrong
}

#[component]
fn ParameterField(of: Experiments, kind: StudyKind, name: &'static str) -> impl IntoView {
    let (label, unit) = texts::parameter(name);
    let wrong_text = wrong_text(of, label);
    let now = memo(move || {
        parameter(of, kind, name)
            .map(|(value, ..)| value)
            .unwrap_or_default()
    });
    let range = move || parameter(of, kind, name).map_or((0.0, 0.0), |(_, range, _)| range);
    let set = move |to: f64| {
        of.change(|study| {
            if let Some(one) = study.parameters().iter_mut().find(|one| one.name == name) {
                one.set(to);
            }
        });
    };
    let typed = move |event| {
        let text = event_target_value(&event).replace(['\u{2212}', '–'], "-");
        let number = text.trim().replace(',', ".").parse::<f64>().ok();
        let number = number.filter(|number| number.is_finite());
        wrong_text.set(number.is_none());
        if let Some(number) = number {
            set(number);
        }
    };
    let step = move |event: KeyboardEvent| {
        let is_whole = parameter(of, kind, name).is_some_and(|(_, _, is_whole)| is_whole);
        let (least, greatest) = range();
        let by = if is_whole || greatest - least < 20.0 {
            1.0
        } else {
            10.0
        };
        let by = match event.key().as_str() {
            "ArrowUp" => by,
            "ArrowDown" => -by,
            _ => return,
        };
        event.prevent_default();
        wrong_text.set(false);
        set((now.get_untracked() + by).clamp(least, greatest));
    };
    let objection = move || {
        if wrong_text.get() {
            return tr!("Enter a number.").to_owned();
        }
        of.checked.with(|checked| match checked {
            Some(Err(error)) if error.place == name => texts::problem(&error.problem),
            _ => String::new(),
        })
    };
    let is_wrong = memo(move || !objection().is_empty());
    view! {
        <label class="ask-field" class:wrong=dynamic(move || is_wrong.get())>
            <span class="field-name" aria-hidden="true">{label}</span>
            <span class="number">
                <input
                    type="text"
                    role="spinbutton"
                    inputmode="text"
                    autocomplete="off"
                    spellcheck="false"
                    aria-label=label
                    aria-valuemin=dynamic(move || range().0.to_string())
                    aria-valuemax=dynamic(move || range().1.to_string())
                    aria-valuenow=dynamic(move || now.get().to_string())
                    aria-invalid=dynamic(move || if is_wrong.get() { "true" } else { "false" })
                    prop:value=dynamic(move || texts::number(now.get()))
                    on:input=handler(typed)
                    on:keydown=handler(step)
                />
                <span class="number-unit" aria-hidden="true">{unit}</span>
            </span>
            <span class="ask-words" aria-live="polite">{dynamic(objection)}</span>
        </label>
    }
}

/// How long the ramp of the motor takes, and a hold in which the step settles.
#[component]
fn Hold(of: Experiments) -> impl IntoView {
    let step = memo(move || {
        of.studies.with(|studies| {
            studies.iter().find_map(|study| match study {
                Study::Step(study) => Some(study.clone()),
                _ => None,
            })
        })
    });
    let offered_s = move || {
        step.get()
            .map(|step| step.hold_offered_s(of.page.model.get()))
    };
    let longest_s =
        move || parameter(of, StudyKind::Step, HOLD).map_or(0.0, |(_, (_, max), _)| max);
    let words = move || {
        let Some((step, offered_s)) = step.get().zip(offered_s()) else {
            return String::new();
        };
        let ramp = texts::duration(step.ramp_s(of.page.model.get()));
        let (longest_s, offered) = (longest_s(), texts::duration(offered_s));
        if offered_s > longest_s {
            let longest = texts::duration(longest_s);
            return tr!(
                "The ramp of the motor takes {ramp}. No hold up to {longest} is enough: choose a lower acceleration.",
                ramp,
                longest
            );
        }
        tr!(
            "The ramp of the motor takes {ramp}. Hold the step for {offered} or longer.",
            ramp,
            offered
        )
    };
    let button = move || {
        let offered_s = offered_s()?;
        let hold_s = step.get()?.hold_s;
        (hold_s < offered_s && offered_s <= longest_s()).then(|| {
            let label = tr!("Hold for {time}", time = texts::duration(offered_s));
            let set = move || {
                of.change(|study| {
                    if let Study::Step(step) = study {
                        step.hold_s = offered_s;
                    }
                });
            };
            view! { <PressButton label class="button small" on_press=set /> }
        })
    };
    view! {
        <p class="experiment-advice">{dynamic(words)}</p>
        {button}
    }
}

/// The motor that is studied.
#[component]
fn MotorField(of: Experiments, kind: StudyKind) -> impl IntoView {
    let chosen = memo(move || {
        of.studies.with(|studies| {
            let study = studies.iter().find(|study| study.kind() == kind);
            study.and_then(Study::motor)
        })
    });
    let options = move || {
        let mut motors = of.fleet.with(|fleet| fleet.motors.clone());
        let chosen = chosen.get();
        if let Some(id) = chosen.filter(|id| !motors.contains(id)) {
            motors.push(id);
        }
        let option = |id: MotorId| {
            let words = of.page.motors.names.with(|names| names.named(id));
            let value = id.get().to_string();
            view! { <option value=value selected=chosen == Some(id)>{words}</option> }
        };
        motors.into_iter().map(option).collect_view()
    };
    let choose = move |event| {
        let id = event_target_value(&event).parse::<u8>().ok();
        if let Some(id) = id.and_then(|id| MotorId::new(id).ok()) {
            of.change(|study| set_motor(study, id));
        }
    };
    view! {
        <label class="ask-field">
            <span class="field-name">{tr!("Motor of the study")}</span>
            <select on:change=handler(choose)>{options}</select>
        </label>
    }
}

fn set_motor(study: &mut Study, id: MotorId) {
    match study {
        Study::Sequence(_) => {}
        Study::Step(study) => study.motor = id,
        Study::Frequency(study) => study.motor = id,
        Study::Friction(study) => study.motor = id,
        Study::CoastDown(study) => study.motor = id,
        Study::Heating(study) => study.motor = id,
        Study::TorqueSpeed(study) => study.motor = id,
        Study::Silence(study) => study.motor = id,
    }
}

/// The accelerations that a step response compares, such as `1, 2, 5`.
#[component]
fn Accelerations(of: Experiments) -> impl IntoView {
    let wrong = wrong_text(of, tr!("Accelerations"));
    let text = move || {
        of.studies.with_untracked(|studies| {
            let all = studies.iter().find_map(|study| match study {
                Study::Step(study) => Some(&study.accelerations),
                _ => None,
            });
            let texts: Vec<String> = all
                .into_iter()
                .flatten()
                .map(|one| one.byte().to_string())
                .collect();
            texts.join(", ")
        })
    };
    let typed = move |event| {
        let text = event_target_value(&event);
        let parts = text.split([',', ' ', ';']).filter(|part| !part.is_empty());
        let bytes: Result<Vec<u8>, _> = parts.map(str::parse).collect();
        let bytes = bytes.ok().filter(|bytes| !bytes.is_empty());
        wrong.set(bytes.is_none());
        if let Some(bytes) = bytes {
            of.change(|study| {
                if let Study::Step(study) = study {
                    study.accelerations = bytes.into_iter().map(Acceleration::new).collect();
                }
            });
        }
    };
    let objection = move || {
        if wrong.get() {
            return tr!("Enter numbers from 0 to 255, with commas between.").to_owned();
        }
        of.checked.with(|checked| match checked {
            Some(Err(error)) if error.place == "accelerations" => texts::problem(&error.problem),
            _ => String::new(),
        })
    };
    view! {
        <label class="ask-field" class:wrong=dynamic(move || !objection().is_empty())>
            <span class="field-name">{tr!("Accelerations")}</span>
            <input type="text" autocomplete="off" value=text() on:input=handler(typed) />
            <span class="ask-words" aria-live="polite">{dynamic(objection)}</span>
        </label>
    }
}
