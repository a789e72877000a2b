//! The tab `Code`: the sequence of the tab `Sequence` as a program, or the rover as a robot for ROS 2.

use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use motorlink_messages::{
    experiments::{
        generate::{Program, Robot, UnevenSides, arduino, python, ros2},
        plan::Plan,
    },
    protocol::family::Model,
};
use wasm_bindgen_futures::JsFuture;

use crate::{
    features::experiments::{
        results::save_text,
        state::{Draft, Experiments},
        texts,
    },
    model::vehicle::vehicle_of,
    ui::{
        button::PressButton,
        reactive::{dynamic, handler},
    },
};

/// The port in the program. The user replaces it.
const PORT: &str = "/dev/ttyUSB0";

/// What is generated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Code {
    Python,
    Arduino,
    Ros2,
}

impl Code {
    const ALL: [Self; 3] = [Self::Python, Self::Arduino, Self::Ros2];

    const fn name(self) -> &'static str {
        match self {
            Self::Python => "Python",
            Self::Arduino => "Arduino",
            Self::Ros2 => "ROS 2",
        }
    }

    /// What the files are.
    fn advice(self) -> &'static str {
        match self {
            Self::Python | Self::Arduino => tr!(
                "The sequence of the tab Sequence as a program. It asks before it moves anything, and stops the motors at its end, on an error and on Ctrl-C."
            ),
            Self::Ros2 => tr!(
                "A robot for ROS 2 Humble and Jazzy, without the sequence: its description, the parameters of its drive, and a launch file. Wheels, names and measures are those of Drive together."
            ),
        }
    }
}

/// The files: names and contents. Or why there are none.
type Files = Result<Vec<(&'static str, String)>, String>;

fn files(of: Experiments, code: Code) -> Files {
    // Another model has other frames, and speeds in other units. The Python package knows them.
    if code != Code::Python && of.page.model.get() != Model::Ddsm115 {
        return Err(tr!("The code is for the DDSM115. Choose it under Model.").to_owned());
    }
    match code {
        Code::Python => Ok(vec![("motorlink.py", program(of, python)?)]),
        Code::Arduino => Ok(vec![("motorlink.ino", program(of, arduino)?)]),
        Code::Ros2 => robot(of),
    }
}

/// The sequence in one language.
fn program(of: Experiments, language: fn(&Program<'_>) -> String) -> Result<String, String> {
    let refused = |error| texts::refused(&error, None);
    let sequence = of.draft.with(Draft::sequence);
    let mut sequence = sequence.map_err(refused)?;
    sequence.limits = of.limits(sequence.limits);
    let plan = of.fleet.with(|fleet| Plan::new(&sequence, fleet));
    Ok(language(&Program {
        plan: &plan.map_err(refused)?,
        sequence: &sequence,
        port: PORT,
    }))
}

/// The rover of the page.
fn robot(of: Experiments) -> Files {
    let vehicle = of.page.motors.names.with(vehicle_of);
    let vehicle = vehicle.ok_or_else(|| {
        tr!("Put the wheels into the group of Drive together and set their sides first.").to_owned()
    })?;
    let spec = of.page.model.get().spec();
    let limit_rpm = f64::from(of.page.settings.speed_limit.get());
    let files = ros2(&Robot {
        vehicle: &vehicle,
        geometry: of.geometry.get(),
        by_position: !of.page.model.get().has_separate_frames(),
        rpm_max: limit_rpm.min(spec.nominal.no_load_rpm.into()),
        rpm_per_s_max: 1e6 / f64::from(spec.acceleration_us_per_rpm),
    });
    let uneven = |UnevenSides| tr!("ROS 2 needs as many wheels on the left as on the right.");
    Ok(files.map_err(uneven)?.into())
}

/// The files below each other, each under its name if there are several.
fn text(files: &Files) -> String {
    match files {
        Err(why) => why.clone(),
        Ok(files) => match files.as_slice() {
            [(_, text)] => text.clone(),
            files => {
                let one = |(name, text): &(&str, String)| format!("==== {name} ====\n{text}");
                files.iter().map(one).collect::<Vec<_>>().join("\n")
            }
        },
    }
}

/// The tab without its frame.
#[component]
pub(crate) fn CodeTab(of: Experiments) -> impl IntoView {
    let code = RwSignal::new(0_usize);
    let chosen = move || Code::ALL.get(code.get()).copied().unwrap_or(Code::Python);
    let said = RwSignal::new(String::new());
    let now = move || files(of, chosen());
    let none = Signal::derive(move || now().err());
    let copy = move || {
        let program = untrack(|| text(&now()));
        spawn_local(async move {
            // Over plain HTTP there is no clipboard.
            let is_copied = window().is_secure_context()
                && JsFuture::from(window().navigator().clipboard().write_text(&program))
                    .await
                    .is_ok();
            let words = if is_copied {
                tr!("Copied")
            } else {
                tr!("The browser does not allow this. Select the program and copy it.")
            };
            let _ = said.try_set(words.to_owned());
        });
    };
    let save = move || {
        for (name, text) in untrack(now).into_iter().flatten() {
            save_text(&text, name);
        }
    };
    let options = Code::ALL.into_iter().enumerate();
    let options = options.map(|(place, code)| {
        view! { <option value=place.to_string()>{code.name()}</option> }
    });
    view! {
        <div class="experiment-ask">
            <label class="ask-field">
                <span class="field-name">{tr!("Language of the code")}</span>
                <select
                    aria-label=tr!("Language of the code")
                    on:change=handler(move |event| {
                        if let Ok(place) = event_target_value(&event).parse() {
                            code.set(place);
                        }
                    })
                >
                    {options.collect_view()}
                </select>
            </label>
            <p class="experiment-advice">
                {dynamic(move || chosen().advice())}
            </p>
            <div class="button-row">
                <PressButton
                    label=tr!("Copy")
                    class="button small"
                    disabled_reason=none
                    on_press=copy
                />
                <PressButton
                    label=tr!("Save")
                    class="button small"
                    disabled_reason=none
                    on_press=save
                />
            </div>
            <p role="status" class="run-said">{dynamic(move || said.get())}</p>
        </div>
        <div class="experiment-curves">
            <textarea
                class="code-text"
                readonly
                spellcheck="false"
                wrap="off"
                aria-label=tr!("Program")
                prop:value=dynamic(move || text(&now()))
            ></textarea>
        </div>
    }
}
